"""Forged certificates: false in one thing, and consistent in all that a reader would compare.

Each takes a copy of a true certificate, which it may change, and gives the forged one, or None if
what it made would be true.
"""

from __future__ import annotations

import copy
import hashlib
import json
import random
from collections.abc import Callable, Mapping
from typing import Any

from meso_robust.bounds import Verdict
from meso_robust.campaigns.mutation.forged_tasks import FORGED_TASKS, Forged
from meso_robust.campaigns.mutation.forging import (
    chained,
    ends_of,
    keep_boxes,
    put_post,
    reclaimed,
    restated,
)
from meso_robust.campaigns.mutation.original import Original
from meso_robust.campaigns.mutation.places import Document
from meso_robust.primitives.setup import setup_of
from meso_robust.task import ROUND_TIPS

Forge = Callable[[Document, Original, random.Random], Document | None]


def _move_left_out(document: Document, original: Original, rng: random.Random) -> Document:
    steps, policy = document["steps"], document["policy"]
    move = rng.randrange(len(steps))
    gone = steps.pop(move)
    del policy[move]
    if move == len(steps) and steps:  # the move before now ends where the last one did
        put_post(document, move - 1, ends_of(gone["post_exact"]))
    elif move > 0:
        chained(document, move)
    elif steps:
        steps[0]["pre"], steps[0]["pre_exact"] = gone["pre"], gone["pre_exact"]
    return document


def _moves_swapped(document: Document, original: Original, rng: random.Random) -> Document | None:
    steps, policy = document["steps"], document["policy"]
    if len(steps) < 2:
        return None
    move = rng.randrange(len(steps) - 1)
    boxes = [dict(step) for step in steps]
    for listed in (steps, policy):
        listed[move], listed[move + 1] = listed[move + 1], listed[move]
    keep_boxes(document, boxes)
    return document


def _box_of_another_move(
    document: Document, original: Original, rng: random.Random
) -> Document | None:
    steps = document["steps"]
    if len(steps) < 2:
        return None
    move, other = rng.sample(range(len(steps)), 2)
    put_post(document, move, ends_of(steps[other]["post_exact"]))
    return document


def _box_narrowed(document: Document, original: Original, rng: random.Random) -> Document:
    """One end of the box after a move, by a share of its width."""
    move = rng.randrange(len(document["steps"]))
    ends = ends_of(document["steps"][move]["post_exact"])
    low, high = side = ends[rng.randrange(3)]
    upper, share = rng.randrange(2), 10.0 ** rng.uniform(-6, 0)
    side[upper] = high - share * (high - low) if upper else low + share * (high - low)
    put_post(document, move, ends)
    return document


def _boxes_shrunk(document: Document, original: Original, rng: random.Random) -> Document:
    """All boxes after moves, about their middles."""
    factor = rng.uniform(0.1, 0.98)
    for move, step in enumerate(document["steps"]):
        ends = [_about_middle(side, factor) for side in ends_of(step["post_exact"])]
        put_post(document, move, ends)
    return document


def _about_middle(side: list[float], factor: float) -> list[float]:
    middle, half = 0.5 * (side[0] + side[1]), 0.5 * factor * (side[1] - side[0])
    return [middle - half, middle + half]


def _inequality_left_out(document: Document, original: Original, rng: random.Random) -> Document:
    listed = rng.choice(document["steps"])["obligations"]
    del listed[rng.randrange(len(listed))]
    return document


def _inequality_of_another_move(
    document: Document, original: Original, rng: random.Random
) -> Document | None:
    """Its box and bound, where the same is claimed of two moves."""
    every = [one for step in document["steps"] for one in step["obligations"]]
    target = rng.choice(every)
    alike = [
        one for one in every if one is not target and one["inequality"] == target["inequality"]
    ]
    if not alike:
        return None
    source = rng.choice(alike)
    target["over"], target["lower_bound"] = source["over"], source["lower_bound"]
    return document


def _inequality_about_less(document: Document, original: Original, rng: random.Random) -> Document:
    """A box shrunk about its middle, and a bound that is larger for it."""
    one = rng.choice(rng.choice(document["steps"])["obligations"])
    factor = rng.uniform(0.1, 0.98)
    for name, ends in one["over"].items():
        side = _about_middle([float.fromhex(end) for end in ends], factor)
        one["over"][name] = [end.hex() for end in side]
    one["lower_bound"] = (float.fromhex(one["lower_bound"]) * (2.0 - factor)).hex()
    return document


def _bounds_raised(document: Document, original: Original, rng: random.Random) -> Document:
    factor = 1.0 + 10.0 ** rng.uniform(-6, 1)
    for step in document["steps"]:
        for one in step["obligations"]:
            one["lower_bound"] = (float.fromhex(one["lower_bound"]) * factor).hex()
    return document


def _margin_raised(document: Document, original: Original, rng: random.Random) -> Document:
    factor, margin = 1.0 + 10.0 ** rng.uniform(-3, 0.3), document["margin"]
    margin["factor"] *= factor
    margin["each_alone"] = {name: factor * one for name, one in margin["each_alone"].items()}
    if margin["refused_at"] is not None:
        margin["refused_at"] *= factor
    return document


def _easier_task(document: Document, original: Original, rng: random.Random) -> Document | None:
    """What was proved for smaller uncertainties, said of the task's."""
    only = rng.choice((None, *original.setup.uncertainty.stated))
    easier = setup_of(original.task, rng.uniform(0.3, 0.97), only)
    chain = original.certified(document["policy"], easier)
    return restated(document, chain) if chain.verdict is Verdict.PROVED else None


def _false_policy(document: Document, original: Original, rng: random.Random) -> Document | None:
    """A policy that is not proved, with invented proofs of all that is open."""
    rule = rng.choice(document["policy"])
    aims = [key for key in sorted(rule) if isinstance(rule[key], dict)]
    rule[rng.choice(aims)]["offset_um"] += rng.choice((-1, 1)) * 10.0 ** rng.uniform(0.5, 2.5)
    chain = original.certified(document["policy"])
    return None if chain.verdict is Verdict.PROVED else restated(document, chain)


def _claim_of_less(document: Document, original: Original, rng: random.Random) -> Document | None:
    """The same, and the claim says so of one uncertainty."""
    only = rng.choice(sorted(original.setup.uncertainty.stated))
    easier = setup_of(original.task, rng.uniform(0.3, 0.97), only)
    side = easier.uncertainty.stated[only]
    if side == original.setup.uncertainty.stated[only]:
        return None
    document["claim"]["uncertainties"][only] = [side.lo.hex(), side.hi.hex()]
    chain = original.certified(document["policy"], easier)
    return restated(document, chain) if chain.verdict is Verdict.PROVED else None


def _another_task(document: Document, original: Original, rng: random.Random) -> Document:
    """About a task of the same name of which one value is another."""
    task = original.task.to_dict()
    section = rng.choice(("probe", "part", "uncertainty"))
    key = rng.choice([key for key, value in sorted(task[section].items()) if value])
    value = task[section][key]
    if isinstance(value, bool):
        task[section][key] = not value
    elif isinstance(value, list):
        task[section][key] = [value[0], _more(value[1], rng)]
    else:
        task[section][key] = _more(value, rng)
    text = json.dumps(task, sort_keys=True)
    document["task_hash"] = hashlib.sha256(text.encode()).hexdigest()
    return document


def _more(value: Any, rng: random.Random) -> Any:
    """A larger number; of anything else another one."""
    return value * rng.uniform(1.01, 3.0) if isinstance(value, int | float) else [value]


def _invented_witness(document: Document, original: Original, rng: random.Random) -> Document:
    """REFUTED, by a run that does not fail, and stated as such a certificate would state it.

    In half of the cases the run leaves the bounds besides.
    """
    setup, moves = original.setup, len(document["policy"])
    wide = setup.uncertainty.scaled(1.0 if rng.random() < 0.5 else 1.5)

    def drawn(low: float, high: float) -> float:
        return low + rng.random() * (high - low)

    def pairs() -> list[list[str]]:
        side = wide.probe_position
        return [[drawn(side.lo, side.hi).hex() for _ in range(2)] for _ in range(moves)]

    start = [side.mid for side in (setup.start.x, setup.start.y, setup.start.theta)]
    document["verdict"] = "REFUTED"
    document["witness"] = {
        "outcome": "misses_goal",
        "move": None,
        "start": [end.hex() for end in start],
        "friction": drawn(wide.friction.lo, wide.friction.hi).hex(),
        "film_ratio_m2": drawn(wide.film_ratio.lo, wide.film_ratio.hi).hex(),
        "misalignment_rad": drawn(wide.misalignment.lo, wide.misalignment.hi).hex(),
        "sensing": [[(0.0).hex()] * 3 for _ in range(moves)],
        "dual_probe": pairs(),
        "single_probe": pairs(),
    }
    last, margin = document["steps"][-1], document["margin"]
    last.update(verdict="UNKNOWN", post=None, post_exact=None)
    margin.update(factor=0.0, refused_at=1.0, binds_first=None)
    margin["each_alone"] = dict.fromkeys(margin["each_alone"], 0.0)
    first, of = last["obligations"][0], {key: last[key] for key in ("step", "action")}
    reason = {key: first[key] for key in ("id", "about")}
    margin["limit"] = {**reason, **of}
    document["undecided"] = {
        **{key: first[key] for key in ("inequality", "over")},
        **of,
        "reason": reason,
        "move": moves,
        "fails": False,
        "settled_by": {"id": "change_move", "about": {}},
    }
    return document


def _labels(document: Document, original: Original, rng: random.Random) -> Document:
    """A move called by another primitive's name, in policy and step."""
    names = sorted({"y_translation", "x_translation", "rotation"})
    move = rng.randrange(len(document["policy"]))
    own = document["policy"][move]["primitive"]
    other = rng.choice([name for name in names if name != own])
    for listed in ("policy", "steps"):
        document[listed][move]["primitive"] = other
    return document


FORGERIES: Mapping[str, Forge] = {
    "a move left out": _move_left_out,
    "two moves swapped": _moves_swapped,
    "the box of another move": _box_of_another_move,
    "a box narrowed": _box_narrowed,
    "all boxes shrunk": _boxes_shrunk,
    "an inequality left out": _inequality_left_out,
    "an inequality of another move": _inequality_of_another_move,
    "an inequality about less": _inequality_about_less,
    "all bounds raised": _bounds_raised,
    "the margin raised": _margin_raised,
    "proofs of an easier task": _easier_task,
    "an unproved policy called PROVED": _false_policy,
    "a claim of less": _claim_of_less,
    "about another task": _another_task,
    "an invented witness": _invented_witness,
    "a move called by another name": _labels,
}


OF_TASKS = 0.75
"""Share of the forgeries of a real part and tips in which the task is another one or its proof is."""


def forge(original: Original, rng: random.Random) -> Forged:
    """A forged certificate; its digest does not fit yet."""
    found = None
    while found is None or (found.document == original.document and found.task == original.task):
        if original.task.schema_ == ROUND_TIPS and rng.random() < OF_TASKS:
            found = FORGED_TASKS[rng.choice(sorted(FORGED_TASKS))](original, rng)
            continue
        name = rng.choice(sorted(FORGERIES))
        document = FORGERIES[name](copy.deepcopy(original.document), original, rng)
        found = None if document is None else Forged(name, document, original.task)
    reclaimed(found.document)
    return found
