"""Why a tampered certificate that is accepted still claims only what is true.

Judged without the checker: by the planner, by points of the stated boxes, by runs of the simulator.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property

from meso_robust.bounds import Interval, Verdict
from meso_robust.campaigns.mutation.along_runs import ALONG, Travelled, largest_force
from meso_robust.campaigns.mutation.by_planner import proves_too
from meso_robust.campaigns.mutation.forging import AXES, plain
from meso_robust.campaigns.mutation.original import RUNS, Original
from meso_robust.campaigns.mutation.places import Difference, Document, Place, at, differences
from meso_robust.campaigns.mutation.sampled import POINTS, least, of_formula
from meso_robust.planning.document import box_document
from meso_robust.primitives.names import Inequality
from meso_robust.primitives.setup import PoseBox, setup_of

UNCHECKED = {"simulation", "made_with", "reading"}
EVIDENCE = {"boxes", "refused_at", "limit", "each_alone", "binds_first"}
"""Keys that the checker names as not checked."""
NAMES = {"step", "primitive"}
"""What a move is called; nothing follows from it."""
CLOSE = 1e-14
"""m and rad: boxes that differ by no more tell the same."""
ROUNDING = 1e-12
"""Relative; of a formula in doubles."""


@dataclass(frozen=True, eq=False)
class Accepted:
    """A tampered certificate that the checker accepts."""

    original: Original
    document: Document

    @cached_property
    def changes(self) -> tuple[Difference, ...]:
        """All that differs from the original, but for the digest."""
        found = differences(self.original.document, self.document)
        return tuple(one for one in found if one.where != ("digest",))

    @cached_property
    def policy_proved(self) -> bool:
        """Whether the planner proves the policy as well."""
        chain = self.original.certified(self.document["policy"])
        return chain.verdict is Verdict.PROVED

    @cached_property
    def moves(self) -> tuple[Travelled, ...]:
        """Simulated runs of the policy, move by move; none if one cannot be carried out."""
        runs, draws = self.original.paths(self.document["policy"])
        if not runs.completed.all():
            return ()
        return tuple(Travelled(move, draws, self.original.setup) for move in runs.moves)


def excuse(original: Original, document: Document) -> str | None:
    """Why ``document``, which was accepted, is true; None if there is no excuse."""
    accepted = Accepted(original, document)
    if document["verdict"] == "REFUTED":
        return _refuted(accepted)
    reasons = {_excused(accepted, about, group) for about, group in _grouped(accepted.changes)}
    found = sorted(reason for reason in reasons if reason)
    return "; ".join(found or ["nothing changed"]) if None not in reasons else None


def _grouped(changes: Iterable[Difference]) -> Iterable[tuple[Place, list[Difference]]]:
    """Changes of the same inequality together, all others alone."""
    groups: dict[Place, list[Difference]] = {}
    for one in changes:
        inequality = len(one.where) > 4 and one.where[2] == "obligations"
        groups.setdefault(one.where[:4] if inequality else one.where, []).append(one)
    return groups.items()


def _excused(accepted: Accepted, about: Place, group: Sequence[Difference]) -> str | None:
    if all(UNCHECKED & {one.where[0]} or EVIDENCE & set(one.where) for one in group):
        return "named as not checked"
    if len(about) == 4 and about[2] == "obligations":
        return _inequality(accepted, about, group)
    (one,) = group
    for applies, judge in _JUDGES:
        if applies(one.where):
            return judge(accepted, one)
    return None


# ------------------------------------------------------------------------------- inequalities


def _inequality(accepted: Accepted, about: Place, group: Sequence[Difference]) -> str | None:
    old, new = at(accepted.original.document, about), at(accepted.document, about)
    if set(new["over"]) != set(old["over"]):
        # a variable that is left out has the task's range
        proved = proves_too(accepted.original, accepted.document, about)
        return "an inequality over the task's range of a variable" if proved else None
    judged = [one for one in group if one.where[-1] != "boxes"]
    if not all(_is_number(one) for one in judged):
        return None
    if all(_claims_less(one) for one in judged):
        kinds = {one.where[4] for one in judged}
        return (
            "a weaker bound"
            if kinds == {"lower_bound"}
            else "the same inequality over a narrower box"
        )
    return _holds(accepted, about)


def _is_number(one: Difference) -> bool:
    return one.where[4] in {"lower_bound", "over"} and isinstance(one.new, str)


def _claims_less(one: Difference) -> bool:
    old, new = float.fromhex(one.old), float.fromhex(one.new)
    lower = one.where[-1] == 0
    if one.where[4] == "lower_bound":
        return new <= old
    return new >= old if lower else new <= old


def _holds(accepted: Accepted, about: Place) -> str | None:
    """The stated bound, at points of the stated box, or along runs where no box says which states."""
    stated = at(accepted.document, about)
    bound, along = float.fromhex(stated["lower_bound"]), ALONG.get(stated["inequality"])
    if along is not None:
        held = bool(accepted.moves) and along(accepted.moves[int(about[1])]) >= bound
        return f"true along {RUNS} runs" if held else None
    if stated["inequality"] == Inequality.FORCE:
        held = _below_cap(accepted, about, bound)
        return f"a force that {RUNS} runs do not exceed, as far below the cap" if held else None
    if not of_formula(stated):  # its box is of the move's own variables
        proved = proves_too(accepted.original, accepted.document, about)
        return "an inequality that the planner proves too" if proved else None
    found = least(stated)
    if found is None:
        return None
    held = found >= bound - ROUNDING * abs(bound) - 1e-18
    return f"true at {POINTS} points" if held else None


def _below_cap(accepted: Accepted, about: Place, bound: float) -> bool:
    """Whether the stated range holds the forces of all runs, and is that far below the cap."""
    stated = float.fromhex(at(accepted.document, about)["over"]["force"][1])
    cap = accepted.original.setup.largest_force
    if cap is None or not accepted.moves:
        return False
    most = largest_force(accepted.moves[int(about[1])])
    return most <= stated and cap.lo - stated >= bound


# ------------------------------------------------------------------------- policy, margin, boxes


def _policy(accepted: Accepted, one: Difference) -> str | None:
    return "another policy, which the planner certifies too" if accepted.policy_proved else None


def _name(accepted: Accepted, one: Difference) -> str | None:
    """What the move is called in the policy and in its step."""
    _, move, key = one.where
    both = {accepted.document[listed][move][key] for listed in ("policy", "steps")}
    return "a move's name, the same in policy and step" if len(both) == 1 else None


def _margin(accepted: Accepted, one: Difference) -> str | None:
    """A smaller margin says less; a larger one must be proved by the planner, or be kept by runs.

    The checker's bounds are closer than the planner's: it verifies factors that the planner cannot prove.
    """
    if 1.0 <= one.new <= accepted.original.document["margin"]["factor"]:
        return "a smaller margin"
    wider = setup_of(accepted.original.task, one.new)
    chain = accepted.original.certified(accepted.document["policy"], wider)
    if chain.verdict is Verdict.PROVED:
        return "a factor that the planner proves too"
    kept = accepted.original.keeps(accepted.document["policy"], wider)
    return f"a factor at which {RUNS} runs keep every claim" if kept else None


def _box(accepted: Accepted, one: Difference) -> str | None:
    """A box that tells the same to 14 digits, or one that holds all simulated poses."""
    old, new = float.fromhex(one.old), float.fromhex(one.new)
    if abs(new - old) <= CLOSE:
        return "the same to 14 digits"
    if one.where[0] != "steps" or not accepted.policy_proved:
        return None
    _, number, which, axis, end = one.where
    runs = accepted.original.ends(accepted.document["policy"])
    if not runs.completed.all():
        return None
    move = runs.moves[int(number)]
    poses = (move.before if which == "pre_exact" else move.after)[:, AXES.index(str(axis))]
    inside = new <= poses.min() if end == 0 else new >= poses.max()
    return f"a box that holds {RUNS} runs" if inside else None


def _range(accepted: Accepted, one: Difference) -> str | None:
    """An end of what the claim holds for all of, stated differently by no more than its rounding."""
    pair = accepted.original.document["claim"]["uncertainties"][one.where[2]]
    reach = max(abs(float.fromhex(end)) for end in pair)
    apart = abs(float.fromhex(one.new) - float.fromhex(one.old))
    return "the same to 14 digits" if apart <= 2.0 * CLOSE * reach else None


def _reading(accepted: Accepted, one: Difference) -> str | None:
    """The numbers of a step's box for reading: those that its exact ends give."""
    _, move, which, *_ = one.where
    step = accepted.document["steps"][move]
    x, y, theta = (
        Interval(*(float.fromhex(end) for end in step[f"{which}_exact"][axis])) for axis in AXES
    )
    same = step[which] == plain(box_document(PoseBox(x=x, y=y, theta=theta)))
    return "a box as its exact ends read" if same else None


_JUDGES: Sequence[tuple[Callable[[Place], bool], Callable[[Accepted, Difference], str | None]]] = (
    (lambda at: at[0] == "policy" and at[-1] == "offset_um", _policy),
    (lambda at: at[0] in {"policy", "steps"} and len(at) == 3 and at[2] in NAMES, _name),
    (lambda at: at == ("margin", "factor"), _margin),
    (lambda at: at[:2] == ("claim", "uncertainties") and len(at) == 4, _range),
    (lambda at: len(at) > 2 and any(str(key).endswith("_exact") for key in at), _box),
    (lambda at: at[0] == "steps" and len(at) == 5 and at[2] in {"pre", "post"}, _reading),
)
"""Which rule judges a change of which place."""


# ------------------------------------------------------------------------------------ REFUTED


def _refuted(accepted: Accepted) -> str | None:
    """A witness must be a run that can be, and it must fail when both engines make it again."""
    setup, witness = accepted.original.setup, accepted.document["witness"]
    u, start = setup.uncertainty, setup.start
    probes = [
        end for key in ("dual_probe", "single_probe") for pair in witness[key] for end in pair
    ]
    bounds: Sequence[tuple[Interval, list[str]]] = (
        (start.x, [witness["start"][0]]),
        (start.y, [witness["start"][1]]),
        (start.theta, [witness["start"][2]]),
        (u.friction, [witness["friction"]]),
        (u.film_ratio, [witness["film_ratio_m2"]]),
        (u.misalignment, [witness["misalignment_rad"]]),
        (u.probe_position, probes),
        (u.sensed_position, [end for x, y, _ in witness["sensing"] for end in (x, y)]),
        (u.sensed_orientation, [theta for *_, theta in witness["sensing"]]),
    )
    inside = all(
        side.lo - CLOSE <= float.fromhex(end) <= side.hi + CLOSE
        for side, ends in bounds
        for end in ends
    )
    fails = inside and accepted.original.fails(accepted.document["policy"], witness)
    return "REFUTED: a run within the bounds that fails by both engines" if fails else None
