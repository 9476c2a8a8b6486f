"""``policy.json``: a certified policy with the boxes it was proved on, and back again.

Numbers that the claim rests on are doubles in hexadecimal (``float.hex``), SI units; those in um
and deg beside them are for reading.
"""

from __future__ import annotations

import itertools
import math
from pathlib import Path

import numpy as np

from meso_robust import units
from meso_robust.bounds import Interval
from meso_robust.certificates.document import exact_box
from meso_robust.certificates.premise import premises
from meso_robust.certificates.words import PREMISES
from meso_robust.errors import InputError
from meso_robust.planning.document import box_document, plan_document
from meso_robust.planning.plan_file import ExactBox, HexPair, PlanDocument, RuleDocument
from meso_robust.planning.reading import wrong_headings, wrong_rules
from meso_robust.planning.rules import rules_of
from meso_robust.policy.cells import Cell, Policy, resting
from meso_robust.policy.policy_file import (
    CellDocument,
    PolicyClaim,
    PolicyDocument,
    RegionDocument,
    read_document,
)
from meso_robust.policy.proof import NotProvedError, recertified
from meso_robust.policy.region import Region, region_of
from meso_robust.primitives.move import MoveRule
from meso_robust.primitives.setup import PoseBox, setup_of
from meso_robust.task import Task
from meso_robust.wording import counted


def policy_document(policy: Policy) -> PolicyDocument:
    """Write out a policy.

    Parameters
    ----------
    policy
        Certified cells.

    Returns
    -------
    PolicyDocument
        Boxes exactly and for reading; each rule once, named by cells.
    """
    task, rest = policy.task, policy.rest
    rules = list(dict.fromkeys(cell.rule for cell in policy.cells))
    number = {rule: k for k, rule in enumerate(rules)}
    return PolicyDocument(
        task=task.name,
        task_hash=task.hash,
        claim=PolicyClaim(
            words=claim(policy), assumptions=tuple(PREMISES[one] for one in premises(task))
        ),
        most_moves=policy.moves,
        region=tuple(_region(region) for region in region_of(policy)),
        rest=None if rest is None else box_document(rest),
        rest_exact=None if rest is None else exact_box(rest),
        rules=_rules(task, rules),
        cells=tuple(
            CellDocument(
                moves=cell.moves,
                rule=number[cell.rule],
                sensed=box_document(cell.sensed),
                sensed_exact=exact_box(cell.sensed),
                post=box_document(cell.post),
                post_exact=exact_box(cell.post),
                ends=cell.ends,
            )
            for cell in policy.cells
        ),
    )


def claim(policy: Policy) -> str:
    """The claim in words."""
    task = policy.task
    goal, u = task.goal, task.uncertainty
    real = ", ".join(("", *task.schema_2_values))
    return (
        f"From every pose that is sensed in one of the {counted(len(policy.cells), 'cell')}, whatever the "
        f"sensing errors (within {u.sensed_position_um} um and {u.sensed_orientation_deg} deg, "
        f"before each move), the probe errors (within {u.probe_position_um} um), mu in "
        f"{list(u.friction)}, film ratio within {u.film_ratio_percent} % of {u.film_ratio_um2} um^2 "
        f"and tip misalignment in {list(u.tip_misalignment_deg)} deg{real}: the move of the first cell "
        f"that holds the sensed pose can be carried out, every motion of the quasi-static model "
        f"leads to poses that are sensed in a cell with fewer moves to go or that lie in the goal, "
        f"and so after at most {counted(policy.moves, 'move')} the part lies within "
        f"{goal.position_tolerance_um} um and {goal.orientation_tolerance_deg} deg of "
        f"({goal.x_um} um, {goal.y_um} um, {goal.theta_deg} deg)."
    )


def read_policy(path: Path, task: Task) -> Policy:
    """Read a policy for ``task`` and prove every cell of it again.

    Raises
    ------
    InputError
        The file cannot be read, breaks a rule, was made for another task, or a cell is not proved.
    """
    document = read_document(path, task)
    try:
        return recertified(_policy(document, task))
    except (ValueError, IndexError) as error:
        kind = "is not proved" if isinstance(error, NotProvedError) else "cannot be used"
        raise InputError(f"{path}: the policy {kind}: {error}; regenerate it") from error


def _policy(document: PolicyDocument, task: Task) -> Policy:
    faults = (wrong_rules(document.rules, "rules"), wrong_headings(document.rules, task, "rules"))
    wrong = next(itertools.chain(*faults), None)
    if wrong is not None:
        raise ValueError(wrong)
    rules = [_rule_of(task, rule) for rule in document.rules]
    cells = tuple(
        Cell(
            sensed=_box(cell.sensed_exact),
            rule=rules[cell.rule],
            moves=cell.moves,
            post=_box(cell.post_exact),
            ends=cell.ends,
        )
        for cell in document.cells
    )
    return Policy(task=task, cells=cells, rest=resting(setup_of(task)))


def _box(exact: ExactBox) -> PoseBox:
    return PoseBox(x=_side(exact.x_m), y=_side(exact.y_m), theta=_side(exact.theta_rad))


def _side(ends: HexPair) -> Interval:
    low, high = (float.fromhex(end) for end in ends)
    if not math.isfinite(low) or not math.isfinite(high):
        raise ValueError(f"ends {list(ends)} of a box must be finite")
    return Interval(low, high)


def _region(region: Region) -> RegionDocument:
    return RegionDocument(
        near_deg=round(units.to_deg(region.near), 6),
        cells=len(region.cells),
        moves=region.moves,
        extent=box_document(region.extent),
        certified_percent=math.floor(1000.0 * region.share) / 10.0,
    )


def _rules(task: Task, rules: list[MoveRule]) -> tuple[RuleDocument, ...]:
    """The rules as a plan states them."""
    nowhere = [np.zeros(3)] * len(rules)
    return plan_document(task, rules, nowhere, [None] * len(rules)).policy


def _rule_of(task: Task, rule: RuleDocument) -> MoveRule:
    plan = PlanDocument(task=task.name, task_hash=task.hash, policy=(rule,), moves=())
    return rules_of(plan)[0]
