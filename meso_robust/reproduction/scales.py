"""Smaller scales (the paper's outlook): where the certificate stops, and what adhesion does."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from meso_robust.campaigns.intervals import share_interval
from meso_robust.laboratory.simulation import in_goal
from meso_robust.primitives.move import MoveRule
from meso_robust.primitives.setup import setup_of
from meso_robust.reproduction.certified import CertifiedPlan, certified_plan, trials
from meso_robust.reproduction.item import Found, Item, Row, Setting
from meso_robust.reproduction.scales_figures import AtSize, figure
from meso_robust.reproduction.shrunk import (
    WITHDRAWAL,
    Certified,
    Errors,
    adhering,
    certified_at,
    planned_at,
    shrunk,
    shrunk_rules,
)
from meso_robust.units import UM
from meso_robust.wording import down

FULL_UM = 1616.0  # length of the paper's part
SIZES_UM = (1616.0, 1400.0, 1200.0, 1000.0, 800.0, 600.0, 400.0, 200.0, 100.0)
QUICK_UM = (1616.0, 600.0, 100.0)
"""Lengths of the part, the largest first: what the planner fails at is not asked of smaller ones."""
RUNS, QUICK_RUNS = 200, 20
"""With adhesion; they take the longest."""
ALL_ERRORS: tuple[Errors, ...] = ("scaled", "camera stays", "camera and probe stay")

TIP_RADIUS = 12.5e-6
"""m; half the 25 um side of the probe, Section V."""
SURFACE_TENSION = 0.03
"""N/m, of mineral oil in air, wetting the tip (contact angle 0)."""
VISCOSITY, FILM = 0.1, 10e-6
"""Pa s and m, of the oil and its film; the drag is then about 1 uN at 75 um/s (Section V)."""
AREA = 1616e-6 * 837e-6  # m², of the paper's part


@dataclass(frozen=True, slots=True, kw_only=True)
class Pull:
    """A law of how the adhesion of a tip changes with the part's size."""

    name: str
    share: float
    """Of a whole meniscus 4 pi R gamma."""
    tip_shrinks: bool
    """Whether the tip's radius is proportional to the part, or the paper's."""

    def newtons(self, size: float) -> float:
        """Force of one tip."""
        radius = TIP_RADIUS * (size if self.tip_shrinks else 1.0)
        return self.share * 4.0 * math.pi * radius * SURFACE_TENSION

    def um_s(self, size: float) -> float:
        """The force over the drag of the part's film, which shrinks with the area; um/s."""
        return self.newtons(size) * FILM / (VISCOSITY * AREA * size**2) / UM


PULLS = (
    Pull(name="a tenth of a meniscus, tip shrinks", share=0.1, tip_shrinks=True),
    Pull(name="a whole meniscus, tip shrinks", share=1.0, tip_shrinks=True),
    Pull(name="a whole meniscus, the paper's tip", share=1.0, tip_shrinks=False),
)


def study(plan: CertifiedPlan, setting: Setting) -> tuple[AtSize, ...]:
    """All sizes, the largest first."""
    found: list[AtSize] = []
    sizes = QUICK_UM if setting.quick else SIZES_UM
    lost: set[Errors] = set()
    for k, length in enumerate(sizes):
        setting.told(f"a part of {length:g} um", k, len(sizes))
        size = length / FULL_UM
        if setting.quick:
            lost |= set(ALL_ERRORS)
        plans = {errors: _plans(plan, size, errors, lost) for errors in ALL_ERRORS}
        found.append(_at(plan, length, plans, setting))
    return tuple(found)


def _plans(
    plan: CertifiedPlan, size: float, errors: Errors, lost: set[Errors]
) -> list[Sequence[MoveRule]]:
    """The paper's plan shrunk, and a new one as long as the planner finds any.

    What is robust at one size would be so, enlarged, at every larger one, where the errors are
    smaller beside the part: once the planner fails it need not be asked again.
    """
    plans: list[Sequence[MoveRule]] = [shrunk_rules(plan.rules, size)]
    if errors == "scaled" or size == 1.0 or errors in lost:
        return plans
    new = planned_at(plan.task, size, errors)
    if new is None:
        lost.add(errors)
        return plans
    return [*plans, new]


def _at(
    plan: CertifiedPlan,
    length: float,
    plans: Mapping[Errors, Sequence[Sequence[MoveRule]]],
    setting: Setting,
) -> AtSize:
    size, task = length / FULL_UM, plan.task
    runs, sticky = (40, QUICK_RUNS) if setting.quick else (1000, RUNS)
    certified = {errors: certified_at(task, size, errors, plans[errors]) for errors in ALL_ERRORS}
    free = {}
    for errors, one in certified.items():
        setup = setup_of(shrunk(task, size, errors))
        free[errors] = float(in_goal(trials(one.rules, setup, runs, setting.seed), setup).mean())
    setup, rules = setup_of(shrunk(task, size, "scaled")), certified["scaled"].rules
    held = {
        pull.name: float(adhering(rules, setup, size, pull.um_s(size), sticky, setting.seed).mean())
        for pull in PULLS
    }
    return AtSize(length_um=length, certified=certified, free=free, held=held)


def _rows(sizes: Sequence[AtSize], runs: int) -> tuple[Row, ...]:
    found = [_stop_row(sizes, errors) for errors in ALL_ERRORS]
    found.append(_needed_row(min(sizes, key=lambda at: at.length_um)))
    found += [_release_row(pull) for pull in PULLS]
    for at in sizes:
        found += [_margin_row(at), _share_row(at, runs)]
    return tuple(found)


def _stop_row(sizes: Sequence[AtSize], errors: Errors) -> Row:
    """Between which sizes the certificate is lost."""
    proved = [at.length_um for at in sizes if at.certified[errors].proved]
    lost = [at for at in sizes if not at.certified[errors].proved]
    if not lost:
        return Row(
            quantity=f"smallest part with a certificate, errors: {errors}",
            unit="um",
            ours=min(proved),
            why="The model has no length of its own: shrunk with everything else, the same plan is "
            "proved with the same margin. No end was found.",
        )
    first = max(lost, key=lambda at: at.length_um)
    above = min((um for um in proved if um > first.length_um), default=first.length_um)
    return Row(
        quantity=f"part below which no certificate was found, errors: {errors}",
        unit="um",
        ours=(first.length_um, above),
        why=f"Open at {first.length_um:g} um: {first.certified[errors].reason}. UNKNOWN, not refuted: "
        "the planner is a search; tip spacing was shrunk, not optimised again.",
    )


def _needed_row(at: AtSize) -> Row:
    one = at.certified["scaled"]
    stated = certified_plan().task.uncertainty
    return Row(
        quantity=f"error of camera and probe with which a {at.length_um:g} um part is proved",
        unit="um",
        printed=stated.sensed_position_um,
        ours=one.margin * at.length_um / FULL_UM * stated.sensed_position_um,
        why="Printed: the paper's camera and probe. A microscope and a manipulator that are better by "
        "as much restore the certificate, if there is no adhesion.",
    )


def release_um(pull: Pull) -> float:
    """Length of the part at which two tips together pull as fast as they withdraw, um.

    A smaller part follows its tips as far as they go.
    """
    ratio = 2.0 * pull.um_s(1.0) * UM / WITHDRAWAL
    return FULL_UM * (ratio if pull.tip_shrinks else math.sqrt(ratio))


def _release_row(pull: Pull) -> Row:
    return Row(
        quantity=f"part that no longer comes off two tips at 1.7 mm/s: {pull.name}",
        unit="um",
        printed="100s of um and below",
        ours=release_um(pull),
        why=f"{1e6 * pull.newtons(1.0):.2g} uN a tip at full size against the film's drag, "
        "2 F = e_x v; in-plane withdrawal, as the certificate assumes. The drag is an estimate.",
    )


def _margin_row(at: AtSize) -> Row:
    parts = [f"{errors}: {_worded(one)}" for errors, one in at.certified.items()]
    open_ = {one.reason for one in at.certified.values() if one.reason}
    return Row(
        quantity=f"{at.length_um:g} um: verdict and factor on all uncertainties that is proved",
        ours="; ".join(parts),
        why=f"Open: {'; '.join(sorted(open_))}." if open_ else "",
    )


def _worded(one: Certified) -> str:
    return f"{'PROVED' if one.proved else 'UNKNOWN'} x {down(one.margin, 2)}"


def _share_row(at: AtSize, runs: int) -> Row:
    free = [f"no adhesion, {errors}: {100 * share:g}" for errors, share in at.free.items()]
    held = [f"{name}: {100 * share:.0f}" for name, share in at.held.items()]
    low, _ = share_interval(runs, runs)
    return Row(
        quantity=f"{at.length_um:g} um: simulated runs in the goal",
        unit="%",
        ours="; ".join([*free, *held]),
        why=f"With adhesion {runs} runs each, all errors shrunk with the part; 100 % of them leave "
        f"{100 * low:.1f} to 100 %.",
    )


def _answer(sizes: Sequence[AtSize]) -> str:
    scaled = all(at.certified["scaled"].proved for at in sizes)
    least = min(at.length_um for at in sizes)
    shrunk_well = f"{'is' if scaled else 'is not'} proved at every size down to {least:g} um"
    worst = _stop_row(sizes, "camera and probe stay").ours
    stop = (
        f"is lost between {worst[0]:g} and {worst[1]:g} um"
        if isinstance(worst, tuple)
        else "is not lost"
    )
    sticky = 100.0 * max(sizes, key=lambda at: at.length_um).held[PULLS[1].name]
    return (
        f"With all errors shrunk with the part, the plan {shrunk_well}; with the paper's camera and "
        f"probe the certificate {stop}. Adhesion is in no certificate: all of them are about the model "
        f"without it. In simulation {sticky:.0f} % of the runs bear a whole meniscus at full size, and "
        f"a part of less than {release_um(PULLS[1]):.0f} um follows tips that shrink with it "
        f"({release_um(PULLS[2]):.0f} um: the paper's tips) when they withdraw."
    )


MISSING = (
    "Drag of the film: the printed e_x cannot be in SI. Taken: oil of 0.1 Pa s, film of 10 um at every "
    "size, so that drag falls with the area; a film that is half as thick halves every pull.",
    "Adhesion: none is printed. Taken: a meniscus of oil, F = 4 pi R gamma (R. S. Fearing 1995, "
    "doi:10.1109/IROS.1995.526162), R = 12.5 um, gamma = 0.03 N/m: 4.7 uN; a whole one and a tenth of "
    "it. Tips wet by the same oil as the support may have none. Adhesion of the support is not in.",
    "How the probes withdraw: in the plane, the way they came, at the manipulator's fastest.",
    "Errors at another size: a pixel stays 5 um, and an angle is seen over the part's length.",
    "Tip spacing: shrunk from 580 um.",
)


def _data(sizes: Sequence[AtSize]) -> dict[str, object]:
    return {
        "length_um": [at.length_um for at in sizes],
        "margin": {e: [at.certified[e].margin for at in sizes] for e in ALL_ERRORS},
        "proved": {e: [at.certified[e].proved for at in sizes] for e in ALL_ERRORS},
        "open": {e: [at.certified[e].reason for at in sizes] for e in ALL_ERRORS},
        "in_goal": {e: [at.free[e] for at in sizes] for e in ALL_ERRORS},
        "in_goal_adhering": {p.name: [at.held[p.name] for at in sizes] for p in PULLS},
        "pull_um_s": {p.name: [p.um_s(at.length_um / FULL_UM) for at in sizes] for p in PULLS},
        "release_um": {p.name: release_um(p) for p in PULLS},
    }


def reproduce(setting: Setting) -> Found:
    """Shrink the task step by step; see `Item`."""
    sizes = study(certified_plan(), setting)
    return Found(
        answer=_answer(sizes),
        rows=_rows(sizes, QUICK_RUNS if setting.quick else RUNS),
        missing=MISSING,
        figures=(figure(sizes),),
        data=_data(sizes),
    )


ITEM = Item(
    title="Smaller parts, with and without adhesion",
    where="Sections XI and XII (outlook)",
    run=reproduce,
)
