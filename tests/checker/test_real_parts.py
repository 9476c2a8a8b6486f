"""A certificate of a real part and real tips: verified, and rejected where it is about less than the task."""

from __future__ import annotations

import copy
import json
import math
import random
from collections.abc import Callable, Mapping
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from flint import ctx

from meso_robust.campaigns.mutation.answer import answered as answer_to
from meso_robust.campaigns.mutation.forged_tasks import true_of
from meso_robust.campaigns.mutation.memory import Remembered
from meso_robust.campaigns.mutation.original import Original
from meso_robust.campaigns.mutation.places import sealed
from meso_robust.checker.inputs import given, uncertainties
from meso_robust.checker.reading import digest, parse_certificate
from meso_robust.checker.verdict import BITS, Answer, check
from meso_robust.task import Task, load_task
from tests.nightly import at_night, by_day

Document = dict[str, Any]
HERE = Path(__file__).parent / "real_parts"
PROVER = Remembered().prover
WIDER: Mapping[str, tuple[str, str, Any, tuple[str, ...]]] = {
    "tip_radius": ("probe", "tip_radius_um", [2.25, 60.0], ("radius_upper", "radius_lower")),
    "tip_spacing": ("probe", "tip_spacing_tolerance_um", 60.0, ("spacing",)),
    "size": ("part", "size_tolerance_um", 60.0, ("depth",)),
    "squareness": ("part", "squareness_deg", 3.0, ("kappa",)),
    "travel_direction": ("uncertainty", "travel_direction_deg", [-4.0, 0.025], ("direction",)),
    "travel_scale": ("uncertainty", "travel_scale_percent", 30.0, ("scale",)),
    "drag_centre": ("uncertainty", "drag_centre_um", 80.0, ("drag_a", "drag_n")),
    "drag_anisotropy": (
        "uncertainty", "drag_anisotropy_percent", 60.0,
        ("stretch", "shear", "stretch_now", "shear_now"),
    ),
    "probe_wander": (
        "uncertainty", "probe_wander_um", 20.0,
        ("wander_x", "wander_y", "wander_x_now", "wander_y_now", "bend", "bend_now"),
    ),
    "friction": ("uncertainty", "friction", [0.1, 0.345], ("mu_upper_now", "mu_lower_now")),
}  # fmt: skip
"""Of each uncertainty a key that widens it beyond what the plan bears, and the variables of a move."""


@cache
def task() -> Task:
    return load_task(HERE / "hexagon.toml")


@pytest.fixture
def document() -> Document:
    found: Document = json.loads((HERE / "hexagon.json").read_text(encoding="utf-8"))
    return found


def answered(document: Document, of: Task) -> Answer:
    """The answer to a certificate whose digest and task are made to fit."""
    document["task_hash"] = of.hash
    document["digest"] = digest(document)
    return check(*parse_certificate(json.dumps(document), "test", of), of, prover=PROVER)


def wider_task(name: str) -> Task:
    section, key, value, _ = WIDER[name]
    values = task().to_dict()
    values[section][key] = value
    return Task.from_dict(values)


def claimed(document: Document, of: Task) -> None:
    """Let the claim state the ranges of a task."""
    with ctx.workprec(BITS):
        for name, side in uncertainties(given(of)).items():
            low, high = float(side[0].lower()), float(side[1].upper())
            ends = (math.nextafter(low, -math.inf), math.nextafter(high, math.inf))
            document["claim"]["uncertainties"][name] = [end.hex() for end in ends]


def every(document: Document) -> list[Document]:
    return [one for step in document["steps"] for one in step["obligations"]]


def test_it_is_verified(document: Document) -> None:
    found = answered(document, task())
    assert found.verdict == "VERIFIED", found.refused
    assert "probe.tip_radius_um = [2.25, 2.75]" in found.claims


EACH_WAY = [(name, (k + turn) % 2 > 0) for turn in range(2) for k, name in enumerate(WIDER)]
"""Every quantity in the claim only, and in the boxes too; the first of each differ."""


@pytest.mark.parametrize(("name", "boxes"), by_day(len(WIDER), EACH_WAY))
def test_what_was_proved_of_less_is_rejected(document: Document, name: str, boxes: bool) -> None:
    """About a task that is wider in one quantity: in the claim alone, or in every stated box as well."""
    of = wider_task(name)
    claimed(document, of)
    if boxes:
        variables = WIDER[name][3]
        with ctx.workprec(BITS):
            old, new = (uncertainties(given(one))[name] for one in (task(), of))
        low, high = (float(new[k]) - float(old[k]) for k in (0, 1))
        for one in every(document):
            for variable in set(variables) & set(one["over"]):
                scale = 1e4 if variable.startswith("bend") else 1.0
                ends = [float.fromhex(end) for end in one["over"][variable]]
                stretched = (ends[0] + low * scale, ends[1] + high * scale)
                one["over"][variable] = [end.hex() for end in stretched]
    found = answered(document, of)
    assert found.verdict == "REJECTED"
    assert found.refused is not None
    assert found.refused.name.at not in {"claim.premises", "claim.uncertainties"}


def narrowed(one: Document, rng: random.Random) -> None:
    name = rng.choice(sorted(set(one["over"]) - {"share"}))
    low, high = (float.fromhex(end) for end in one["over"][name])
    one["over"][name] = [(low + (high - low) * 1e-6).hex(), high.hex()]


def raised(one: Document, rng: random.Random) -> None:
    """By more than what a certificate leaves to spare."""
    one["lower_bound"] = (float.fromhex(one["lower_bound"]) * 1.3 + 1e-12).hex()


def unknown(one: Document, rng: random.Random) -> None:
    one["over"]["d2"] = next(iter(one["over"].values()))


def other_inequality(one: Document, rng: random.Random) -> None:
    one["inequality"] = "travel" if one["inequality"] != "travel" else "faces_back"


@pytest.mark.parametrize("change", [narrowed, raised, unknown, other_inequality])
def test_a_false_statement_is_rejected(
    document: Document, change: Callable[[Document, random.Random], None]
) -> None:
    rng = random.Random(0)
    count = len(every(document))
    for k in rng.sample(range(count), 12):
        changed = copy.deepcopy(document)
        one = every(changed)[k]
        change(one, rng)
        listed = {each["inequality"]: None for each in every(changed)}
        known = changed["claim"]["inequalities"]
        changed["claim"]["inequalities"] = {id_: known.get(id_) for id_ in listed}
        found = answered(changed, task())
        assert found.verdict == "REJECTED", (one["id"], one["about"])


def test_what_is_stated_of_fewer_variables_holds_for_all_of_the_rest(document: Document) -> None:
    """A variable that is left out has the task's range, so leaving one out claims no less."""
    for one in every(document):
        one["over"].pop("radius_lower", None)
    assert answered(document, task()).verdict == "VERIFIED"


@at_night
def test_a_rotation_of_a_real_part_is_verified_as_it_is_proved() -> None:
    """With everything uncertain at once; proved again, as a certificate that is kept may be old."""
    folder = Path(__file__).resolve().parents[2] / "reports" / "campaigns" / "real_parts"
    kept = json.loads((folder / "latch.json").read_text(encoding="utf-8"))
    plate = Original(load_task(folder / "latch.toml"), kept)
    proved = true_of(plate, plate.task)
    assert proved is not None
    assert [step["action"] for step in proved.document["steps"]].count("rotate") == 1
    reply = answer_to(sealed(proved.document), plate.task, PROVER)
    assert (reply.word, reply.why) == ("VERIFIED", "")
