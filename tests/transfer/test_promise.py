"""The promise made again: what the verdict rests on."""

from __future__ import annotations

from contextlib import nullcontext
from dataclasses import replace
from functools import cache
from typing import Any

import pytest

from meso_robust.bounds import Verdict
from meso_robust.certificates.chain import certify
from meso_robust.certificates.document import NamedDocument
from meso_robust.certificates.premise import Premise
from meso_robust.certificates.words import PREMISES
from meso_robust.identification.document import ModelDocument, parse_model
from meso_robust.pipeline import SimulatorContradictsProofError
from meso_robust.planning.compose import Found
from meso_robust.planning.remedy import Remedy
from meso_robust.primitives.names import ObligationId as Id, Reason
from meso_robust.primitives.setup import setup_of
from meso_robust.transfer import promise as module
from meso_robust.transfer.answer import document, summary, why, worst_words
from meso_robust.transfer.assumption_check import standings
from meso_robust.transfer.document import EvidenceMade
from meso_robust.transfer.envelope import needed
from meso_robust.transfer.lines import LINES
from meso_robust.transfer.promise import Promise, model_hash, promise
from meso_robust.transfer.running import Evidence
from tests.conftest import paper_task
from tests.strategies import paper_chain
from tests.transfer.models import budget, model, values
from tests.transfer.plans import SAMPLES, share

SURE = {"rho_um2": (374_000.0, 379_000.0), "mu": (0.325, 0.335)}


@pytest.fixture(autouse=True)
def _once(monkeypatch: pytest.MonkeyPatch) -> None:
    share(monkeypatch)


def made(document: ModelDocument) -> Promise:
    return promise(paper_task(), document, SAMPLES, 0, lambda _: nullcontext())


def searched(document: ModelDocument) -> Any:
    return module.recertified(paper_task(), document)


@cache
def _larger() -> Any:
    """A plan for a part whose edges stand out by 2 to 4 um."""
    sizes = {"part_geometry.x_um": (2.0, 4.0), "part_geometry.y_um": (2.0, 4.0)}
    return searched(model(sizes, base=SURE))


@pytest.fixture(scope="module")
def sticky() -> ModelDocument:
    return model({"tip_adhesion.pull_um_s": (20.0, 30.0)})


def test_a_broken_premise_is_unknown_although_the_plain_model_s_plan_is_certified(
    sticky: ModelDocument,
) -> None:
    found = made(sticky)
    certificate, told = found.planned.certificate, document(found)

    assert found.planned.chain.verdict is Verdict.PROVED
    assert certificate.verdict == told.verdict == "UNKNOWN"
    assert certificate.undecided is not None
    assert certificate.undecided.reason == NamedDocument(
        id=Reason.PREMISE_KEPT,
        about={"premise": Premise.COULOMB_FRICTION, "effect": "tip_adhesion"},
    )
    assert certificate.undecided.settled_by.id == Remedy.WITHOUT_EFFECT
    assert certificate.reading.undecided is not None
    assert PREMISES[Premise.COULOMB_FRICTION] in certificate.reading.undecided.claim
    assert "derivations/one_point_sticking.py" in certificate.reading.undecided.inequality
    assert certificate.margin.factor == 0.0
    assert certificate.margin.limit is not None
    assert (
        certificate.reading.limit == certificate.reading.undecided.claim
    )  # never "None" on the page
    assert certificate.made_with["model"] == model_hash(sticky) == told.model.sha256
    assert certificate.task_hash == told.task_hash != told.task_hash_before == paper_task().hash
    assert told.evidence is not None
    assert told.evidence.runs == 10
    assert "eq-5-normal-force" in why(found)
    assert "evidence, not proof" in summary(found)


def test_what_is_not_kept_is_said_line_by_line(
    sticky: ModelDocument, monkeypatch: pytest.MonkeyPatch
) -> None:
    found = made(sticky)
    given = budget(radius_um=1.0, seconds=1.0)
    open_ = replace(found, standings=standings(model(open_=("mu",)), given))
    monkeypatch.delitem(LINES, "tip_adhesion")
    no_line = replace(found, standings=standings(sticky, given))

    assert "premise not kept: Coulomb friction at point contacts" in summary(found)
    assert "[eq-5-normal-force, derivations/one_point_sticking.py]" in summary(found)
    assert "no bounds of mu: the recordings give mu no lower and upper bound" in summary(open_)
    assert "premise not kept" not in summary(open_)
    assert "no premise is known to survive [tip_adhesion has no line of its own]" in summary(
        no_line
    )
    assert "tip_adhesion has no line of its own" in why(no_line)


def test_runs_that_contradict_an_absorbed_effect_are_no_answer(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    failed = Evidence(
        runs=10,
        completed=10,
        in_goal=9,
        worst_um=3.0,
        worst_deg=0.0,
        endings=(),
        broken=True,
        seed=0,
    )
    monkeypatch.setattr(module, "evidence", lambda *_: failed)

    with pytest.raises(SimulatorContradictsProofError, match="9 of 10 in the goal"):
        made(model({"drag_drift.rate_percent_s": (1.0, 2.0)}))


def test_every_size_of_the_part_is_what_is_certified() -> None:
    """Sides of 1620 to 1624 um: the task says so, and its plan is proved for all of them."""
    found = _larger()

    assert found.changed.task.part.size_tolerance_um == 2.0
    assert found.wide.verdict is Verdict.PROVED
    assert found.proved


def test_round_tips_are_proved_as_what_they_are() -> None:
    """The recordings' radius is the task's; the lines say so."""
    found = made(model(probe={"tip_radius_um": 12.5}, base=SURE))

    assert found.planned.task.probe.tip_radius_um == (12.5, 12.5)
    assert found.planned.certificate.verdict == "PROVED"
    assert "(round tips, radius 12.5 µm)" in summary(found)
    assert Premise.TIPS_ARE_DISCS in found.planned.certificate.claim.premises
    assert Premise.POINT_TIPS not in found.planned.certificate.claim.premises
    assert found.conditions == ()


def test_a_drifting_probe_is_not_promised_where_a_tip_must_rest(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    drift = model({"probe_drift.x_um_s": (0.09, 0.1)}, base=SURE)
    rules = tuple(step.rule for step in paper_chain().steps)
    monkeypatch.setattr(module, "compose", lambda _: Found(rules=rules, scale=1.0))
    found = module.recertified(paper_task(), drift)
    (standing,) = [one for one in found.standings if one.name == "probe_drift"]

    assert any(rule.single is not None for rule in found.plan.rules)
    assert not found.proved
    assert (standing.word, standing.premise) == ("breaks a premise", Premise.TRAVEL_WITHIN_BOUNDS)


def test_a_model_that_states_no_radius_is_proved_on_the_condition_of_points() -> None:
    found = made(model(base=SURE))

    assert found.planned.certificate.verdict == "PROVED"
    assert found.conditions == ("the tips are points: the model states no radius",)
    assert "only if the tips are points" in summary(found)


def test_a_worst_run_is_told_only_if_there_is_one() -> None:
    ran = EvidenceMade(
        runs=1, seed=0, completed=0, in_goal=0, worst_miss_um=0.0, worst_miss_deg=0.0,
        endings={"jam": 1},
    )  # fmt: skip
    done = ran.model_copy(update={"completed": 1, "in_goal": 1})
    missed = done.model_copy(update={"in_goal": 0, "worst_miss_um": 3.2})

    assert worst_words(ran) == "no run carried out all moves"
    assert worst_words(done) == "every run that carried out all moves ends in it"
    assert worst_words(missed).endswith("misses it by 3.2 um, 0 deg")


def _post(x: float) -> ModelDocument:
    """A post on the part's way to the goal, or wherever else x is."""
    return model(
        {
            "unmodelled_wall.radius_um": (20.0, 30.0),
            "unmodelled_wall.x_um": (x, x + 10.0),
            "unmodelled_wall.y_um": (-5.0, 5.0),
        }
    )


def test_a_post_out_of_the_way_is_of_no_effect() -> None:
    found = made(_post(-2600.0))
    told = document(found)

    assert told.verdict == "PROVED"
    assert told.beyond is not None
    assert (told.beyond.verdict, told.beyond.open) == ("PROVED", "")
    assert told.evidence is not None
    assert told.evidence.in_goal == SAMPLES


def test_a_post_in_the_way_leaves_the_certificate_of_the_task_without_a_verdict() -> None:
    found = made(_post(1000.0))
    certificate, told = found.planned.certificate, document(found)

    assert found.broken == ()
    assert certificate.verdict == told.verdict == "UNKNOWN"
    assert told.beyond is not None
    assert told.beyond.verdict == "UNKNOWN"
    assert certificate.undecided is not None
    assert certificate.undecided.reason.id in {Id.PART_CLEAR_OF_WALLS, Id.TIPS_CLEAR_OF_WALLS}
    assert certificate.reading.undecided is not None
    assert told.beyond.open == certificate.reading.undecided.claim
    assert told.beyond.open in told.why
    assert certificate.margin.factor == 0.0
    listed = {one.inequality for step in certificate.steps for one in step.obligations}
    assert set(certificate.claim.inequalities) == listed
    assert told.evidence is not None
    assert told.evidence.in_goal == 0


def test_bounds_that_grow_with_place_and_time_are_those_of_the_plan_that_was_found() -> None:
    drift = {
        "camera_drift.x_um_s": (-0.01, 0.01),
        "camera_drift.y_um_s": (0.0, 0.0),
        "camera_scale.percent": (-0.02, 0.02),
    }
    found = searched(model(drift))
    need = needed(found.wide, found.changed.task, 1616 / 837)

    assert found.kept
    assert found.wide.verdict is Verdict.PROVED
    added = found.changed.task.uncertainty.sensed_position_um - 5.0
    # what a plan of that length and reach makes of 0.01 um/s and 0.02 %
    least = 0.01 * need.seconds + 2e-4 * need.radius_um
    assert least <= added <= 1.2 * least


def test_a_plan_that_leaves_its_budget_is_not_proved(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "enough", lambda *_: False)
    monkeypatch.setattr(module, "_bounded", lambda _: True)
    monkeypatch.setattr(module, "_ROUNDS", 1)

    found = made(model())

    assert found.planned.certificate.verdict == "UNKNOWN"
    assert "places and times" in why(found)


def test_a_failing_run_refutes_the_plan_of_a_plain_model_only(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Errors within a bound of an effect need not be ones that the effect makes."""
    plain = made(model()).planned
    refuted = plain.certificate.model_copy(update={"verdict": "REFUTED"})
    monkeypatch.setattr(module, "judge", lambda *_: replace(plain, certificate=refuted))

    bounded = made(model({"drag_drift.rate_percent_s": (1.0, 2.0)})).planned.certificate

    assert made(model()).planned.certificate.verdict == "REFUTED"
    assert (bounded.verdict, bounded.witness) == ("UNKNOWN", None)


def test_nothing_is_promised_with_a_model_that_its_recordings_reject() -> None:
    quality = {
        "chi2": 9e3,
        "freedom": 3000,
        "p_value": 1e-12,
        "correlation": 0.5,
        "inflation": 3.0,
        "numerical": 0.0,
    }
    found = made(model(quality=quality))

    assert found.planned.certificate.verdict == "UNKNOWN"
    assert "the recordings support one model [the recordings reject the model: χ² = 9,000" in why(
        found
    )
    assert "`meso-robust diagnose`" in summary(found)
    assert not any("does not" in one for one in document(made(model())).caution)


def test_the_hash_of_a_model_is_of_its_values() -> None:
    other = values()
    other["parameters"]["mu"]["high"] += 1e-9

    assert model_hash(model()) == model_hash(model())
    assert model_hash(model(parameters=other["parameters"])) != model_hash(model())


def test_a_certified_plan_stays_certified_for_any_size_within_the_interval() -> None:
    """Corners and the middle of the sizes, one by one, from the plan for all of them."""
    found = _larger()
    ends = found.wide.end
    assert ends is not None

    for length in (1620.0, 1622.0, 1624.0):
        for width in (841.0, 843.0, 845.0):
            part = found.changed.task.part.model_copy(
                update={"length_um": length, "width_um": width, "size_tolerance_um": 0.0}
            )
            task = found.changed.task.model_copy(update={"part": part})
            alone = certify(found.plan.rules, setup_of(task))
            assert alone.verdict is Verdict.PROVED
            assert alone.end is not None
            assert alone.end.within(ends)


def half_open(low: float | None, high: float | None, value: float) -> ModelDocument:
    """A model with a best value of µ, whose recordings give no bound where an end is None."""
    given = values(base=SURE)
    given["parameters"]["mu"] |= {
        "value": value,
        "low": 0.0 if low is None else low,
        "high": 3.0 if high is None else high,
        "open_low": low is None,
        "open_high": high is None,
    }
    given["not_identifiable"] = [{"name": "mu", "why": "the recordings give no bound on one side"}]
    return parse_model(given, "a model")


@pytest.mark.parametrize(
    ("low", "high", "expected", "side"),
    [
        (0.325, None, [0.325, 0.36], "the upper end"),
        (None, 0.335, [0.3, 0.335], "the lower end"),
        (None, None, [0.3, 0.36], "agree with it"),
    ],
)
def test_the_task_lends_the_ends_of_friction_that_the_recordings_leave_open(
    low: float | None, high: float | None, expected: list[float], side: str
) -> None:
    """What the user stated of µ is a premise as it was before the recordings; a measured end is theirs."""
    given = half_open(low, high, 0.33)
    found = made(given)
    assert found.planned.certificate.verdict == "PROVED"
    assert list(found.changed.task.uncertainty.friction) == expected
    (said,) = [one for one in document(found).caution if "as the task states it" in one]
    assert side in said
    assert document(found).model.sha256 == model_hash(given)


@pytest.mark.parametrize(("low", "value"), [(0.4, 0.5), (None, 0.5)])
def test_the_task_lends_nothing_where_the_recordings_contradict_it(
    low: float | None, value: float
) -> None:
    found = searched(half_open(low, None, value))
    (friction,) = [one for one in found.standings if one.name == "mu"]
    assert friction.word == "not identified"
    assert list(found.changed.task.uncertainty.friction) == [0.3, 0.36]
