"""What a certificate claims of every run, and whether a batch of runs keeps it.

Nothing of the proof is used but what it claims: boxes, tubes and which contacts stick. Contacts are
judged from tips and poses alone, by plain geometry, so that both engines are judged alike.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from numba import njit

from meso_robust.bounds import Verdict
from meso_robust.certificates.chain import Chain
from meso_robust.laboratory.claim_ids import CARRIED_OUT, REACHES_GOAL, Claim, ClaimId
from meso_robust.laboratory.geometry import gaps_to, in_part
from meso_robust.laboratory.meetings import CORNER, Meetings, crosses, meets
from meso_robust.laboratory.running import STARTS_INSIDE, MoveRun, PlanRun
from meso_robust.motion.one_tip import CREEP_MOST
from meso_robust.primitives.move import MoveRule
from meso_robust.primitives.names import ObligationId
from meso_robust.primitives.obligation import Step
from meso_robust.primitives.setup import Setup
from meso_robust.simulator import Outcome
from meso_robust.types import Flags, Floats

UPPER, LOWER, PASSIVE = 0, 1, 2  # tips of a move
PHASES = {"regrasp": 1, "tilt": 2, "straighten": 3}  # free, one tip sticks, both stick
ALIGNED = 0.05  # rad: an edge on both tips leans less than this, as they and their radii differ
CONTACT = 1e-9  # m: a gap that counts as contact; both engines keep it to less
HARDER = 1.0 + 1e-6  # times the cap: a force that a step does not tell from it


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Claims:
    """Everything that is claimed of a plan's runs; M moves."""

    rules: tuple[MoveRule, ...]
    setup: Setup
    posts: tuple[Floats | None, ...]
    """Per move (2, 3) lower and upper ends of the certified box after it (m, m, rad)."""
    tubes: tuple[Floats | None, ...]
    """Per move (K, 2, 3) slices; during the move every pose lies in one of them."""
    creeps: tuple[float, ...]
    """Per move, m: how far its first contact may slip, over the cube of the sine of the lean; 0: it sticks."""

    @property
    def cap(self) -> float | None:
        """Largest force of a tip over the mean drag and the speed of travel; None if none is claimed."""
        of = self.setup
        if of.largest_force is None or of.drag is None or of.speed is None:
            return None
        return of.largest_force.hi / (of.drag.lo * of.speed.lo)


def claims_of(chain: Chain, rules: tuple[MoveRule, ...]) -> Claims:
    """What a certified chain claims of a plan's runs.

    Parameters
    ----------
    chain
        The certified steps.
    rules
        All moves of the plan.

    Returns
    -------
    Claims
        Boxes and tubes of the steps up to the last PROVED one; of the contacts everything.
    """
    posts: list[Floats | None] = []
    tubes: list[Floats | None] = []
    for step in chain.steps:
        if step.verdict is not Verdict.PROVED or step.post is None:
            break
        posts.append(step.post.ends)
        tubes.append(np.array([knot.box.ends for knot in step.tube]))
    rest: list[Floats | None] = [None] * (len(rules) - len(posts))
    return Claims(
        rules=rules,
        setup=chain.setup,
        posts=(*posts, *rest),
        tubes=(*tubes, *rest),
        creeps=(*(_creep(step) for step in chain.steps[: len(posts)]), *(0.0 for _ in rest)),
    )


def _creep(step: Step) -> float:
    """The largest that a step states."""
    stated = [
        one.proof.box[CREEP_MOST].hi
        for one in step.obligations
        if one.name.id is ObligationId.SLIP_BOUNDED
    ]
    return max(stated, default=0.0)


def only_motions(rules: tuple[MoveRule, ...], setup: Setup) -> Claims:
    """What a plan needs in order to work, without any certificate.

    Parameters
    ----------
    rules, setup
        The plan and the task.

    Returns
    -------
    Claims
        Of the contacts and the goal only, without boxes.
    """
    none = (None,) * len(rules)
    return Claims(rules=rules, setup=setup, posts=none, tubes=none, creeps=(0.0,) * len(rules))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Accuracy:
    """What an engine's result cannot tell from keeping a claim."""

    slip: float
    """Slip on the edge that still counts as sticking, m."""
    pose: tuple[Floats, ...]
    """Per move (N or 1, 3): how far outside a box a pose may lie (m, m, rad)."""


def broken(runs: PlanRun, claims: Claims, accuracy: Accuracy) -> dict[Claim, Flags]:
    """Whether a run breaks a claim, for every claim that can be judged.

    Parameters
    ----------
    runs
        N runs of the plan.
    claims
        What is claimed.
    accuracy
        Of the engine that made the runs.

    Returns
    -------
    dict
        (N,) flags by claim. A run that its engine could not finish breaks nothing from the move on
        in which that happened.
    """
    found = {CARRIED_OUT: np.isin(runs.outcomes, (STARTS_INSIDE, Outcome.JAM))}
    for k, (rule, move) in enumerate(zip(claims.rules, runs.moves, strict=True)):
        begun, done = runs.failed_in >= k, runs.failed_in > k
        for id_, flags in _of_a_move(rule, move, claims, k, accuracy).items():
            which = begun if id_ is ClaimId.STARTS_FREE else done
            found[Claim(id_, k + 1)] = which & flags
    missed = outside(runs.final, claims.setup.goal.ends[None], accuracy.pose[-1])
    return {**found, REACHES_GOAL: runs.completed & missed}


def outside(poses: Floats, boxes: Floats, slack: Floats) -> Flags:
    """(N,) whether a run's pose (N, 3), or any of several (N, J, 3), lies in none of the boxes.

    The boxes (K, 2, 3) are widened by the slack (N or 1, 3) of the run.
    """
    found = np.zeros(len(poses), dtype=np.bool_)
    wide = np.stack([boxes[:, 0] - slack[:, None], boxes[:, 1] + slack[:, None]], axis=2)
    _find_outside(poses.reshape(len(poses), -1, 3), wide, found)
    return found


@njit(cache=True, nogil=True)
def _find_outside(poses: Floats, boxes: Floats, found: Flags) -> None:
    """Write what `outside` finds of boxes (1|N, K, 2, 3).

    Compiled, as most poses lie in the box of the one before.
    """
    count = boxes.shape[1]
    for i in range(poses.shape[0]):
        own, k = i if boxes.shape[0] > 1 else 0, 0
        for j in range(poses.shape[1]):
            missed = 0
            while missed < count:
                inside = True
                for axis in range(3):
                    inside &= poses[i, j, axis] >= boxes[own, k, 0, axis]
                    inside &= poses[i, j, axis] <= boxes[own, k, 1, axis]
                if inside:
                    break
                missed += 1
                k = k + 1 if k + 1 < count else 0
            found[i] |= missed == count


def _of_a_move(
    rule: MoveRule, move: MoveRun, claims: Claims, k: int, accuracy: Accuracy
) -> dict[ClaimId, Flags]:
    """(N,) whether a run breaks each claim of one move, if it has got as far as that."""
    post, tube = claims.posts[k], claims.tubes[k]
    slack = accuracy.pose[k]
    at_start = gaps_to(move.tips, move.before, move.outlines, move.radii)
    at_end = gaps_to(move.ends, move.after, move.outlines, move.radii)
    found = {
        ClaimId.STARTS_FREE: np.asarray((at_start <= 0.0).any(axis=1)),
        ClaimId.CONTACTS: ~_contacts(rule, move, at_end, accuracy.slip, claims.creeps[k]),
        ClaimId.RETRACTS: _hits_on_withdrawal(move, at_end),
    }
    if post is not None:
        found[ClaimId.ENDS_IN_BOX] = outside(move.after, post[None], slack)
    if tube is not None and move.path.shape[1] > 1:
        found[ClaimId.STAYS_IN_TUBE] = outside(move.path, tube, slack)
    if post is not None and move.forces is not None and claims.cap is not None:
        most = np.hypot(*np.moveaxis(move.forces, -1, 0)).max(axis=(1, 2))
        found[ClaimId.FORCES_BELOW_CAP] = most > HARDER * claims.cap
    return found


def _contacts(rule: MoveRule, move: MoveRun, gaps: Floats, slip: float, creep: float) -> Flags:
    """(N,) whether the tips, with such gaps (N, P), touch, stick and stay clear as is claimed."""
    touching = np.abs(gaps) <= CONTACT
    if rule.action == "regrasp":
        return (move.after == move.before).all(axis=1) & (gaps > 0.0).all(axis=1)
    if rule.action == "guide":
        return np.asarray(touching.any(axis=1))  # what walls do to a tip's slip is not claimed
    if rule.action == "rotate":
        pusher = LOWER if rule.side > 0 else UPPER
        idle = UPPER if rule.side > 0 else LOWER
        return touching[:, pusher] & touching[:, PASSIVE] & (gaps[:, idle] > 0.0)
    if rule.action == "tilt":
        pusher = LOWER if rule.side > 0 else UPPER
        alone = gaps[:, UPPER if rule.side > 0 else LOWER] > 0.0
        held = touching[:, pusher] & alone & (first_tip(move) == pusher)
    else:
        held = touching[:, UPPER] & touching[:, LOWER]
    if creep > 0.0:
        lean = np.abs(move.after[:, 2] - move.before[:, 2]) + ALIGNED
        return np.asarray(held & (slips(move) <= slip + creep * np.sin(lean) ** 3))
    few = move.phases <= PHASES[rule.action]  # of the stepper, which counts none, always
    return np.asarray(held & few & (slips(move) <= slip))


def first_tip(move: MoveRun) -> npt.NDArray[np.int64]:
    """Which tip of the active probe meets the part first, by plain geometry.

    Parameters
    ----------
    move
        One move of N runs.

    Returns
    -------
    npt.NDArray
        (N,) ``UPPER`` or ``LOWER``, in the axes of the move.
    """
    return first_meeting(move)[0]


def first_meeting(move: MoveRun) -> tuple[npt.NDArray[np.int64], Meetings]:
    """Which tip of the active probe meets the part first, and where.

    Parameters
    ----------
    move
        One move of N runs.

    Returns
    -------
    tuple
        (N,) ``UPPER`` or ``LOWER`` as `first_tip` has it, and the meetings of these tips, (N,) each.
    """
    active = [UPPER, LOWER]
    both = meets(move.ways[:, :, active], move.radii[:, active], move.before, move.outlines)
    below = both.share[:, 1] < both.share[:, 0]
    found = (np.where(below, one[:, 1], one[:, 0]) for one in both)
    return np.where(below, LOWER, UPPER), Meetings(*found)


def slips(move: MoveRun) -> Floats:
    """How far the first contact of a move has slipped.

    Parameters
    ----------
    move
        One move of N runs.

    Returns
    -------
    Floats
        (N,) distance, on the part, of the first tip to touch after the move from where it would be
        had it rolled on its edge without slip since it met the part, m; infinite if it met a corner.

    Notes
    -----
    A disc that does not turn rolls back along its edge by its radius times the turn of the part. With
    no more phases than claimed every contact keeps one mode in a phase; the first contact has slipped
    in a phase then exactly if this is not zero.
    """
    first, met = first_meeting(move)
    rows = np.arange(len(first))
    after = np.roll(move.outlines, -1, axis=1)
    corner = move.outlines[rows, met.edge]
    side = after[rows, met.edge] - corner
    side /= np.linalg.norm(side, axis=1, keepdims=True)
    off = in_part(move.ends[rows, first], move.after) - corner
    radius, turn = move.radii[rows, first], move.after[:, 2] - move.before[:, 2]
    along = np.sum(side * off, axis=1) - met.along + radius * turn
    beside = side[:, 1] * off[:, 0] - side[:, 0] * off[:, 1] - radius
    return np.where(met.edge == CORNER, np.inf, np.hypot(along, beside))


def _hits_on_withdrawal(move: MoveRun, gaps: Floats) -> Flags:
    """(N,) whether a probe meets the part on its way back from gaps (N, P).

    The active probe goes back to its start, the passive one as far along the direction of the push.
    """
    back = np.ones((move.tips.shape[1], 1))
    back[:PASSIVE] = -1.0
    way = back * (move.ends - move.tips)[:, LOWER, None]
    inside = (gaps < -CONTACT).any(axis=1)
    return inside | crosses(move.ends, way, move.radii, move.after, move.outlines, CONTACT)
