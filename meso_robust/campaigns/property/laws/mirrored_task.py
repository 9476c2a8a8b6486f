"""The mirrored task has the mirrored plan, with the mirrored certificate."""

from __future__ import annotations

from meso_robust.bounds import Interval
from meso_robust.campaigns.property.law import Breach, Cost, Property, Silence, Verdict
from meso_robust.campaigns.property.laws.variants import (
    Rules,
    Variant,
    mirrored_rules,
    paper_rules,
    variants,
)
from meso_robust.certificates.chain import Chain, certify
from meso_robust.errors import NotApplicableError
from meso_robust.planning.compose import robust_at
from meso_robust.primitives.setup import PoseBox, setup_of
from meso_robust.task import Task


def mirrored_box(box: PoseBox) -> PoseBox:
    """Seen in a mirror along the x axis; exact."""
    return PoseBox(x=box.x, y=-box.y, theta=-box.theta)


def _certificate(variant: Variant) -> Verdict:
    rules = paper_rules()
    one = certify(rules, setup_of(variant.task()))
    other = certify(mirrored_rules(rules), setup_of(variant.task(mirrored=True)))
    return _differ(one, other)


def _differ(one: Chain, other: Chain) -> Verdict:
    """The first thing in which a certificate is not the mirrored other."""
    if (one.verdict, len(one.steps)) != (other.verdict, len(other.steps)):
        return _breach("verdict", f"{one.verdict.name} and {other.verdict.name}")
    for k, (step, seen) in enumerate(zip(one.steps, other.steps, strict=True)):
        boxes = [(f"step {k + 1} ends in", step.post, seen.post)]
        tubes = zip(step.tube, seen.tube, strict=False)
        boxes += [(f"step {k + 1} goes through", a.box, b.box) for a, b in tubes]
        if step.verdict != seen.verdict or len(step.tube) != len(seen.tube):
            return _breach("verdict", f"step {k + 1}: {step.verdict.name}, {seen.verdict.name}")
        for where, box, image in boxes:
            wanted = None if box is None else mirrored_box(box)
            if wanted != image:
                return _breach("boxes", f"{where} {_told(wanted)}, and {_told(image)}")
    return None


def _told(box: PoseBox | None) -> str:
    if box is None:
        return "no box"

    def side(range_: Interval) -> str:
        return f"[{range_.lo!r}, {range_.hi!r}]"

    return f"x {side(box.x)}, y {side(box.y)}, theta {side(box.theta)}"


def _breach(what: str, detail: str) -> Breach:
    return Breach(what=f"mirrored task: {what}", detail=detail)


def _plan(variant: Variant) -> Verdict:
    one, other = _planned(variant.task()), _planned(variant.task(mirrored=True))
    if one is None and other is None:
        return Silence("no robust plan is found, mirrored or not")
    wanted = None if one is None else mirrored_rules(one)
    if wanted == other:
        return None
    return _breach("plan", f"mirrored plan: {wanted}; plan of the mirrored task: {other}")


def _planned(task: Task) -> Rules | None:
    try:
        return robust_at(task, 1.0)
    except NotApplicableError:
        return None


CERTIFICATE = Property(
    name="mirrored-certificate",
    statement=(
        "The paper's plan and variants of its task, seen in a mirror along the x axis: the certificate "
        "has the same verdicts, and mirrored boxes and tubes."
    ),
    agreement="exact: a mirror changes signs, and outward rounding treats both signs alike",
    examples=variants(1.5),
    check=_certificate,
    cost=Cost.MODERATE,
)
PLAN = Property(
    name="mirrored-plan",
    statement=(
        "Other parts, tips, starts, goals and uncertainties, each planned separately: the mirrored task has the "
        "mirrored plan."
    ),
    agreement="exact: the same commands, in mirrored axes",
    examples=variants(1.0, shapes=True),
    check=_plan,
    cost=Cost.COSTLY,
)
