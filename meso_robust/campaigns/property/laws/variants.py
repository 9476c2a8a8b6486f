"""Random variants of the paper's task, in the decimals in which a user would write them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache
from typing import Any

from hypothesis import strategies as st

from meso_robust.laboratory.draws import nominal
from meso_robust.laboratory.running import run
from meso_robust.planning.compose import compose
from meso_robust.planning.document import PlanDocument, plan_document
from meso_robust.primitives.frame import HEADINGS, Frame
from meso_robust.primitives.move import MoveRule
from meso_robust.primitives.setup import setup_of
from meso_robust.task import Task, load_task, parse_task
from meso_robust.tasks import PAPER

Rules = tuple[MoveRule, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Variant:
    """What differs from the paper's task; units in the names."""

    sensed_position_um: float
    sensed_orientation_deg: float
    probe_position_um: float
    friction: tuple[float, float]
    film_ratio_percent: float
    tip_misalignment_deg: tuple[float, float]
    start_x_um: float
    start_y_um: float
    start_theta_deg: float
    goal_um: float
    """Tolerance."""
    goal_deg: float
    """Tolerance."""
    length_um: float = 1616.0
    width_um: float = 837.0
    spacing_um: float = 580.0

    def task(self, *, mirrored: bool = False) -> Task:
        """The variant, or what is seen of it in a mirror along the x axis.

        Raises
        ------
        InputError
            A value breaks a rule of tasks.
        """
        sign = -1.0 if mirrored else 1.0
        values: dict[str, Any] = paper_task().model_dump(mode="json", by_alias=True)
        values["name"] = "variant"
        values["part"] = {"length_um": self.length_um, "width_um": self.width_um}
        values["probe"]["tip_spacing_um"] = self.spacing_um
        values["start"] = {
            "x_um": self.start_x_um,
            "y_um": sign * self.start_y_um + 0.0,
            "theta_deg": sign * self.start_theta_deg,
        }
        values["goal"] |= {
            "theta_deg": sign * 180.0,
            "position_tolerance_um": self.goal_um,
            "orientation_tolerance_deg": self.goal_deg,
        }
        low, high = self.tip_misalignment_deg
        values["uncertainty"] |= {
            "sensed_position_um": self.sensed_position_um,
            "sensed_orientation_deg": self.sensed_orientation_deg,
            "probe_position_um": self.probe_position_um,
            "friction": list(self.friction),
            "film_ratio_percent": self.film_ratio_percent,
            "tip_misalignment_deg": [-high + 0.0, -low + 0.0] if mirrored else [low, high],
        }
        return parse_task(values, "variant")


@cache
def paper_task() -> Task:
    """The task that ships with the package."""
    return load_task(PAPER)


@cache
def paper_rules() -> Rules:
    """The plan for it."""
    return compose(paper_task()).rules


def plan_of(task: Task, rules: Rules) -> PlanDocument:
    """Rules as a plan for a task, without certified boxes."""
    setup = setup_of(task)
    sensed = [move.sensed[0] for move in run(rules, setup, nominal(setup, len(rules))).moves]
    return plan_document(task, rules, sensed, (None,) * len(rules))


def mirrored_rules(rules: Rules) -> Rules:
    """The same moves seen in a mirror along the x axis: their own axes are mirrored, no number is."""
    return tuple(replace(rule, frame=_mirrored(rule.frame)) for rule in rules)


def _mirrored(frame: Frame) -> Frame:
    return Frame(heading=HEADINGS[-frame.quarters % 4], mirrored=not frame.mirrored)


def _decimals(low: float, high: float, places: int) -> st.SearchStrategy[float]:
    """Decimal numbers of so many places."""
    steps = 10**places
    return st.integers(round(low * steps), round(high * steps)).map(lambda k: k / steps)


def _ranges(low: float, high: float, places: int) -> st.SearchStrategy[tuple[float, float]]:
    ends = _decimals(low, high, places)
    return st.tuples(ends, ends).map(lambda pair: (min(pair), max(pair)))


def variants(hardest: float, *, shapes: bool = False) -> st.SearchStrategy[Variant]:
    """Variants of the paper's task.

    Parameters
    ----------
    hardest
        Largest uncertainties over those of the paper.
    shapes
        Whether part, tips and start differ as well; the paper's plan does not fit them.
    """
    more: dict[str, st.SearchStrategy[float]] = {}
    if shapes:
        more = {
            "length_um": _decimals(1400.0, 1900.0, 0),
            "width_um": _decimals(700.0, 950.0, 0),
            "spacing_um": _decimals(500.0, 640.0, 0),
        }
    far = 300.0 if shapes else 20.0
    return st.builds(
        Variant,
        sensed_position_um=_decimals(0.0, 5.0 * hardest, 1),
        sensed_orientation_deg=_decimals(0.0, 0.3 * hardest, 2),
        probe_position_um=_decimals(0.0, 5.0 * hardest, 1),
        friction=_ranges(max(0.0, 0.33 - 0.05 * hardest), 0.33 + 0.05 * hardest, 2),
        film_ratio_percent=_decimals(0.0, 5.0 * hardest, 1),
        tip_misalignment_deg=_ranges(-0.25 * hardest, 0.25 * hardest, 2),
        start_x_um=_decimals(2060.0 - far, 2060.0 + far, 1),
        start_y_um=_decimals(-9.0 - far / 10.0, -9.0 + far / 10.0, 1),
        start_theta_deg=_decimals(89.0, 91.0, 1),
        goal_um=_decimals(40.0, 100.0, 0),
        goal_deg=_decimals(1.0, 6.0, 1),
        **more,
    )
