"""Rates of answers whose confusion is known, worked out by hand."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from math import comb
from typing import Any

import pytest

from meso_robust.campaigns.blind.judging import Judged, judged
from meso_robust.campaigns.blind.scoring import Share, calibration, scores

Values = Mapping[str, Any]


def case(
    kind: str, *names: str, size: float = 8.0, stage: str = "", parameters: Values | None = None
) -> Values:
    """A label."""
    truth = {
        "stages": [stage] * len(names),
        "multiples": [size] * len(names),
        "parameters": [parameters or {}] * len(names),
    }
    return {"kind": kind, "names": names, "truth": truth}


def answer(verdict: str, *names: str, **more: Any) -> dict[str, Any]:
    """A line of the results whose document names these effects."""
    effects = [{"name": name, "probability": 0.9, "parameters": {}} for name in names]
    held = {
        "recordings": ["a.csv"],
        "baseline_sigma": 5.0,
        "extended_sigma": 1.5,
        "noise_floor_sigma": 1.0,
    }
    document = {
        "verdict": verdict,
        "effects": effects,
        "ambiguous_with": [],
        "not_identifiable": [],
        "mismatch": {"where": []},
        "held_out": held,
        **more,
    }
    return {"index": 0, "seconds": 10.0, "document": document}


def one(label: Values, result: Values) -> Judged:
    return judged(0, label, result)


def scored(pairs: Sequence[tuple[Values, Values]]) -> dict[str, Any]:
    cases = [judged(k, label, result) for k, (label, result) in enumerate(pairs)]
    return scores(cases, Counter(label["kind"] for label, _ in pairs))


WALL = {"mismatch": {"where": [{"channel": "environment"}, {"channel": "contact"}]}}

KNOWN: list[tuple[Values, Values]] = [
    *[(case("null"), answer("consistent"))] * 8,
    (case("null"), answer("named", "backlash")),
    (case("null"), answer("unknown", **WALL)),
    # backlash, plain: 2 right, 1 ambiguous with the truth in second place, 1 wrong, 1 not answered
    *[(case("effect", "backlash"), answer("named", "backlash"))] * 2,
    (
        case("effect", "backlash"),
        answer("ambiguous", "camera_latency", ambiguous_with=[["backlash"]]),
    ),
    (case("effect", "backlash"), answer("named", "camera_latency")),
    (case("effect", "backlash"), {"index": 0, "seconds": 10.0, "error": "it died"}),
    # too small to be plain: missed
    (case("effect", "backlash", size=1.0), answer("consistent")),
    # no motion splits these two
    (case("effect", "film_flow", size=4.0), answer("named", "body_force")),
    # the drag's growth alone cannot be seen
    (case("effect", "drag_drift"), answer("consistent", not_identifiable=["drag_drift"])),
    (case("pair", "backlash", "tip_radius"), answer("named", "tip_radius", "backlash")),
    (case("pair", "backlash", "tip_radius"), answer("named", "backlash")),
    (case("pair", "backlash", "tip_radius"), answer("named", "backlash", "probe_drift")),
    (case("outside", "vortex", stage="environment"), answer("unknown", **WALL)),
    (case("outside", "vortex", stage="environment"), answer("named", "body_force")),
    (case("outside", "wobble", stage="observation"), answer("consistent")),
    (
        case("unidentifiable", "backlash"),
        answer("ambiguous", "camera_latency", ambiguous_with=[["backlash"]]),
    ),
    (case("unidentifiable", "backlash"), answer("named", "backlash")),
    (case("unidentifiable", "backlash"), answer("consistent", not_identifiable=["drag_drift"])),
]


@pytest.fixture(scope="module")
def known() -> dict[str, Any]:
    return scored(KNOWN)


def test_shares_are_those_counted_by_hand(known: dict[str, Any]) -> None:
    counted = {
        "alarms": (known["nulls"]["alarms"], 2, 10),
        "named nulls": (known["nulls"]["named"], 1, 10),
        "plain detected": (known["naming"]["plain"]["detected"], 5, 6),
        "plain right": (known["naming"]["plain"]["right"], 3, 6),
        "plain in set": (known["naming"]["plain"]["in_set"], 4, 6),
        "in set if answered": (known["naming"]["plain"]["in_set_if_answered"], 4, 5),
        "plain wrong": (known["naming"]["plain"]["wrong"], 1, 6),
        "wrong and confident": (known["wrong_and_confident"]["all"], 4, 27),
        "pairs, both": (known["pairs"]["both"], 1, 3),
        "pairs, one": (known["pairs"]["one"], 1, 3),
        "pairs, wrong": (known["pairs"]["wrong"], 1, 3),
        "outside unknown": (known["outside"]["unknown"], 1, 3),
        "outside unknown if detected": (known["outside"]["unknown_if_detected"], 1, 2),
        "outside wrong": (known["outside"]["wrong"], 1, 3),
        "says so": (known["unidentifiable"]["says_so"], 2, 4),
        "stage, plain": (known["stage"]["plain"], 3, 5),
        "stage, outside": (known["stage"]["outside"], 2, 2),
        "unanswered": (known["cases"]["unanswered"], 1, 27),
    }
    found = {key: (told["hits"], told["count"]) for key, (told, _, _) in counted.items()}
    assert found == {key: (hits, count) for key, (_, hits, count) in counted.items()}
    assert known["naming"]["plain"]["mean_sets"] == pytest.approx(6 / 5)


def test_sizes_and_rows_are_kept_apart(known: dict[str, Any]) -> None:
    by_size = {row["multiple"]: row["right"] for row in known["naming"]["by_multiple"]}
    assert {size: (s["hits"], s["count"]) for size, s in by_size.items()} == {
        1.0: (0, 1),
        4.0: (1, 1),
        8.0: (2, 5),
    }
    assert known["power"]["backlash"] == [
        {"multiple": 1.0, "count": 1, "detected": 0, "right": 0},
        {"multiple": 8.0, "count": 5, "detected": 4, "right": 2},
    ]
    assert known["confusion"]["backlash"] == {
        "backlash": 2,
        "ambiguous": 1,
        "camera_latency": 1,
        "no answer": 1,
        "consistent": 1,
    }
    assert known["confusion"]["drag_drift"] == {"not identifiable": 1}
    assert known["confusion"]["film_flow"] == {"body_force": 1}


def test_two_names_of_one_thing_are_one_answer() -> None:
    both = answer("ambiguous", "body_force", ambiguous_with=[["film_flow"]])
    assert one(case("effect", "film_flow"), both).right
    assert one(case("effect", "camera_drift"), both).confident_and_wrong
    more = answer("ambiguous", "body_force", ambiguous_with=[["film_flow"], ["camera_drift"]])
    assert one(case("effect", "film_flow"), more).in_set
    assert not one(case("effect", "film_flow"), more).right


def test_a_size_counts_as_what_it_came_to() -> None:
    sizes = (0.3, 1.0, 7.9, 4.0 - 1e-9, 100.0)
    found = [one(case("effect", "backlash", size=s), answer("unknown")).multiple for s in sizes]
    assert found == [0.0, 1.0, 4.0, 4.0, 16.0]


def test_held_out_error_is_over_the_noise_floor(known: dict[str, Any]) -> None:
    held = known["held_out"]
    assert held["named"]["over_floor"] == {"count": 10, "median": 1.5, "q90": 1.5, "largest": 1.5}
    assert held["named"]["near_floor"]["hits"] == 0
    assert held["right"]["removed"]["median"] == pytest.approx(3.5 / 4.0)


def test_the_interval_of_a_share_is_exact() -> None:
    """At either end just 2.5 % of the binomial distribution lie beyond what was seen."""
    seen = Share(3, 20)

    def tail(p: float, counts: range) -> float:
        return sum(comb(20, k) * p**k * (1 - p) ** (20 - k) for k in counts)

    assert tail(seen.low, range(3, 21)) == pytest.approx(0.025, rel=1e-6)
    assert tail(seen.high, range(4)) == pytest.approx(0.025, rel=1e-6)
    assert (1 - Share(0, 100).high) ** 100 == pytest.approx(0.025, rel=1e-6)
    assert Share(5, 5).high == 1.0
    assert Share(0, 0).rate is None


def test_calibration_by_hand() -> None:
    told = calibration([(0.9, True), (0.9, True), (0.9, False), (0.2, False)])
    assert told["brier"] == pytest.approx((0.01 + 0.01 + 0.81 + 0.04) / 4)
    assert told["ece"] == pytest.approx((3 * (0.9 - 2 / 3) + 0.2) / 4)
    assert [b["count"] for b in told["bins"]] == [1, 3]
    assert calibration([])["ece"] is None


def told_parameters(name: str, **ends: tuple[float, float]) -> dict[str, Any]:
    """A named effect whose intervals have these ends."""
    values = {
        key: {"value": 0.5 * (low + high), "low": low, "high": high}
        for key, (low, high) in ends.items()
    }
    return answer("named", effects=[{"name": name, "probability": 1.0, "parameters": values}])


def covered(name: str, truth: Mapping[str, float], **ends: tuple[float, float]) -> dict[str, bool]:
    label = case("effect", name, parameters=truth)
    return dict(one(label, told_parameters(name, **ends)).covered)


def test_intervals_hold_the_truth_or_not() -> None:
    truth = {"x_um": 3.0, "y_um": -2.0, "range_um": 9.0}
    found = covered("drag_centre_offset", truth, x_um=(2.5, 3.5), y_um=(-1.0, 0.0))
    assert found == {"drag_centre_offset.x_um": True, "drag_centre_offset.y_um": False}
    two = case("pair", "backlash", "tip_radius", parameters={"width_um": 3.0})
    assert one(two, told_parameters("backlash", width_um=(2.0, 4.0))).covered == ()


def test_a_direction_comes_around() -> None:
    """More drag along 100 deg is the same as along -80 deg, and as less drag along 10 deg."""
    truth = {"fraction": 0.2, "direction_deg": 100.0}
    same = covered("anisotropic_drag", truth, fraction=(0.1, 0.3), direction_deg=(-85.0, -75.0))
    turned = covered("anisotropic_drag", truth, fraction=(-0.3, -0.1), direction_deg=(5.0, 15.0))
    other = covered("anisotropic_drag", truth, fraction=(0.1, 0.3), direction_deg=(5.0, 15.0))
    assert list(same.values()) == list(turned.values()) == [True, True]
    assert other == {"anisotropic_drag.fraction": True, "anisotropic_drag.direction_deg": False}


def test_an_unknown_mismatch_is_put_where_its_largest_span_is() -> None:
    label = case("effect", "wall_capillarity")
    assert one(label, answer("unknown", **WALL)).stage_right
    assert not one(label, answer("unknown")).stage_right
    assert not one(label, answer("consistent", **WALL)).stage
