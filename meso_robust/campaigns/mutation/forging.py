"""What a careful forger sees to: all that must fit together if one thing is changed."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

from meso_robust.bounds import Interval
from meso_robust.campaigns.mutation.places import Document
from meso_robust.certificates.chain import Chain
from meso_robust.certificates.document import exact_box, step_document
from meso_robust.planning.document import box_document
from meso_robust.primitives.names import Inequality
from meso_robust.primitives.setup import PoseBox

INVENTED = (1e-12).hex()
"""A bound for what was never proved."""
AXES = ("x_m", "y_m", "theta_rad")


def plain(model: Any) -> Any:
    """A part of a certificate as plain values."""
    return json.loads(model.model_dump_json(by_alias=True))


def reclaimed(document: Document) -> None:
    """Make the claim fit the number of moves and the steps."""
    told = document["claim"]
    told["moves"] = len(document["policy"])
    listed = (one["inequality"] for step in document["steps"] for one in step["obligations"])
    told["inequalities"] = {one: Inequality(one).derivation for one in listed}


def ends_of(exact: Document) -> list[list[float]]:
    """Lower and upper ends of a box: x, y (m), orientation (rad)."""
    return [[float.fromhex(end) for end in exact[axis]] for axis in AXES]


def put_post(document: Document, move: int, ends: Sequence[Sequence[float]]) -> None:
    """Make a box the one after a move, for reading as well, and the one before the next."""
    x, y, theta = (Interval(low, high) for low, high in ends)
    box = PoseBox(x=x, y=y, theta=theta)
    step = document["steps"][move]
    step["post"], step["post_exact"] = plain(box_document(box)), plain(exact_box(box))
    if move + 1 < len(document["steps"]):
        chained(document, move + 1)


def chained(document: Document, move: int) -> None:
    """Make the box before a move the one after the move before."""
    before, step = document["steps"][move - 1], document["steps"][move]
    step["pre"], step["pre_exact"] = before["post"], before["post_exact"]


def keep_boxes(document: Document, boxes: Sequence[Document]) -> None:
    """Let the moves start and end where other moves did."""
    for step, box in zip(document["steps"], boxes, strict=True):
        step.update({key: box[key] for key in ("pre", "pre_exact", "post", "post_exact")})


def restated(document: Document, chain: Chain) -> Document:
    """The steps as a chain has them, for all moves, each PROVED from the task's start to its goal."""
    old = document["steps"]
    document["steps"] = new = [_invented(plain(step_document(step))) for step in chain.steps]
    new += old[len(new) :]
    new[0]["pre"], new[0]["pre_exact"] = old[0]["pre"], old[0]["pre_exact"]
    for move, (step, before) in enumerate(zip(new, old, strict=True)):
        missing = step["post_exact"] is None or (move + 1 == len(new) and not chain.reaches_goal)
        put_post(document, move, ends_of((before if missing else step)["post_exact"]))
    return document


def _invented(step: Document) -> Document:
    step["verdict"] = "PROVED"
    for one in step["obligations"]:
        if one["verdict"] != "PROVED" or one["lower_bound"] is None:
            one["verdict"], one["lower_bound"] = "PROVED", INVENTED
    return step
