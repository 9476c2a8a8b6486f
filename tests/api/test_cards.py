"""What notebooks show: well-formed, of its own style, nothing from outside, all text escaped."""

from __future__ import annotations

import re
from pathlib import Path
from xml.etree import ElementTree

import pytest

import meso_robust as mr
from meso_robust.diagnosis.document import Verdict
from meso_robust.reporting.card import card
from meso_robust.reporting.cards import diagnosed_card
from meso_robust.tasks import PAPER
from tests.reporting import diagnoses

EVIL = "<script>alert(1)</script>&\"'<img src=x onerror=alert(2)>"


def parsed(card: str) -> ElementTree.Element:
    """The card as XML, to which well-formed HTML of this kind is equal."""
    root = ElementTree.fromstring(card)
    assert (root.tag, root.get("class")) == ("div", "meso-robust")
    return root


def ids(card: str) -> list[str]:
    return re.findall(r'\bid="([^"]*)"', card)


def check(result: object, word: str, figure: str) -> str:
    """What holds of every card; gives it back."""
    assert re.fullmatch(r"<[A-Z]\w+ .{5,120}>", repr(result))
    card = str(result._repr_html_())  # type: ignore[attr-defined]
    root = parsed(card)
    shown = " ".join(root.itertext())
    assert word in shown
    assert figure in shown
    assert root.findtext(".//details/pre") == str(result)
    assert len(root.findall(".//{http://www.w3.org/2000/svg}svg")) == 1
    assert len(set(ids(card))) == len(ids(card))
    outside = re.findall(r"""(?:src|href)=["'](?!#)[^"']*|url\((?!["']?#)[^)]*|@import""", card)
    assert outside == []
    for style in root.iter("style"):
        assert_scoped(style.text or "")
    for style in root.iter("{http://www.w3.org/2000/svg}style"):
        assert_scoped(style.text or "")
    return card


def assert_scoped(style: str) -> None:
    """Every rule is about what stands inside the card."""
    for selector in re.findall(r"([^{}]+)\{[^{}]*\}", style):
        for one in selector.split(","):
            assert re.match(r"\.meso-robust\b|#c[0-9a-f]{12} ", one.strip()), one


def test_a_plan_and_its_check(planned: mr.Planned) -> None:
    card = check(planned, "PROVED", "30 of 30")
    stated = sum(len(step.obligations) for step in planned.certificate.steps)
    other = check(mr.check(planned, planned.task), "VERIFIED", f"{stated} of {stated}")
    assert not set(ids(card)) & set(ids(other))  # both may stand in one page
    assert len(card) < 100_000


SHAPES = {
    "paper": "1616 × 837",
    "slot": "1616 × 837",
    "hexagon": "6 corners",
    "l_shape": "6 corners",
}


@pytest.mark.parametrize("name", SHAPES)
def test_a_task_with_the_outline_at_start_and_goal(name: str) -> None:
    task = mr.Task.load(PAPER.with_name(f"{name}.toml"))
    root = parsed(card := task._repr_html_() or "")
    shown = " ".join(root.itertext())
    assert task.name in shown
    assert SHAPES[name] in shown
    assert root.findtext(".//details/pre") == str(task)
    drawn = [g.get("id", "")[14:] for g in root.iter("{http://www.w3.org/2000/svg}g")]
    # two grounds, four sides of the frame, start and goal
    assert sum(one.startswith("patch") for one in drawn) == 8 + (name == "slot")
    assert len(set(ids(card))) == len(ids(card))


def test_runs(planned: mr.Planned) -> None:
    check(mr.simulate(planned.task, planned, samples=20), "IN THE GOAL", "20 of 20")


def test_two_results_of_one_kind_share_no_ids(planned: mr.Planned) -> None:
    few, more = (mr.simulate(planned.task, planned, samples=n) for n in (3, 4))
    assert not set(ids(few._repr_html_())) & set(ids(more._repr_html_()))


def test_recordings_and_a_fit(recorded: Path, identified: mr.Identified) -> None:
    check(mr.read_recordings(recorded), "CLEAN", "4 recordings")
    check(identified, "IDENTIFIED", "2 of 2 parameters")


def test_videos(tracked: mr.Tracked) -> None:
    check(tracked, "TRACKED", "4 of 4")


def test_a_campaign(campaigned: mr.Campaigned) -> None:
    check(campaigned, "MEASURED", "2 of 2")


@pytest.mark.parametrize("verdict", ["consistent", "named", "ambiguous", "unknown"])
def test_a_diagnosis(verdict: Verdict) -> None:
    document = diagnoses.document(verdict)
    card = diagnosed_card(document, diagnoses.evidence(verdict), "in words")
    shown = " ".join(parsed(card).itertext())
    assert verdict.upper() in shown
    assert len(set(ids(card))) == len(ids(card))


def test_text_of_users_is_shown_and_not_run(planned: mr.Planned) -> None:
    task = mr.Task.from_dict(planned.task.to_dict() | {"name": EVIL})
    plan = planned.plan.model_copy(update={"task": EVIL, "task_hash": task.hash})
    simulated = mr.simulate(task, plan, samples=3)
    root = parsed(check(simulated, EVIL, "3 of 3"))
    assert not list(root.iter("script"))
    assert not list(root.iter("img"))


def test_a_card_without_a_picture_has_no_plate() -> None:
    figures = ((EVIL, EVIL),)
    root = parsed(
        card(word=EVIL, colour="NEUTRAL", about=EVIL, meaning=EVIL, figures=figures, text=EVIL)
    )
    assert "".join(root.itertext()).count(EVIL) == 6
    assert "plate" not in {element.get("class") for element in root.iter()}
