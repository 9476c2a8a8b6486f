"""The page: answer first, true to the certificate, safe, well-formed and the same every time."""

from __future__ import annotations

import html
import math
import re
import sys
from dataclasses import replace
from html.parser import HTMLParser
from importlib import import_module

import pytest

from meso_robust.certificates.document import name_of
from meso_robust.certificates.words import inequality_words, words
from meso_robust.pipeline import Planned
from meso_robust.planning.document import AimDocument, RuleDocument
from meso_robust.reporting import rows
from meso_robust.reporting.plan import report

VOID = {"meta", "br", "link", "img", "hr", "input"}
NAMESPACES = {"http://www.w3.org/2000/svg", "http://www.w3.org/1999/xlink"}


class Reader(HTMLParser):
    """Checks the nesting of elements and collects text, ids and references."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.ids: list[str] = []
        self.targets: list[str] = []
        self.tags: list[str] = []
        self._text: list[str] = []
        self.feed(page)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        for name, value in attrs:
            assert value is not None, f"{tag} {name}"
            if name == "id":
                self.ids.append(value)
            if name in {"href", "xlink:href", "src"}:
                self.targets.append(value)
            self.targets += re.findall(r"url\(([^)]*)\)", value)
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.handle_starttag(tag, attrs)
        if tag not in VOID:
            self.open.pop()

    def handle_endtag(self, tag: str) -> None:
        assert self.open, f"</{tag}> closes nothing"
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        if self.open and self.open[-1] != "style":
            self._text.append(data)

    @property
    def text(self) -> str:
        return re.sub(r"\s+", " ", " ".join(self._text))


@pytest.fixture(params=["proved_page", "refuted_page"])
def page(request: pytest.FixtureRequest) -> str:
    return str(request.getfixturevalue(request.param))


def test_the_page_is_well_formed(page: str) -> None:
    reader = Reader(page)
    assert page.startswith("<!DOCTYPE html>")
    assert reader.open == []
    assert len(reader.ids) == len(set(reader.ids))


def test_the_page_needs_nothing_else(page: str) -> None:
    reader = Reader(page)
    assert {target[0] for target in reader.targets} == {"#"}
    assert {target[1:] for target in reader.targets} <= set(reader.ids)
    assert not {"link", "img", "iframe", "image"} & set(reader.tags)
    assert "<script src" not in page
    assert set(re.findall(r'https?://[^\s"<>]*', page)) <= NAMESPACES
    assert "@import" not in page
    assert len(page.encode()) < 2.5e6


def test_the_page_leads_with_the_verdict(proved_page: str, refuted_page: str) -> None:
    for page, verdict in ((proved_page, "PROVED"), (refuted_page, "REFUTED")):
        assert f"<title>{verdict}:" in page
        assert f'<header class="{verdict}">' in page
        words = Reader(page[page.index("<body>") :].removesuffix("</html>\n")).text.split()
        assert verdict in words[:12]


def test_the_banner_holds_the_summary(proved: Planned, proved_page: str) -> None:
    banner = Reader(proved_page[proved_page.index("<header") : proved_page.index("</header>") + 9])
    assert "moves 4" in banner.text
    assert "simulated runs end in the goal 40 of 40" in banner.text
    margin = proved.certificate.margin
    assert f"× {int(margin.factor * 100) / 100:.2f} binds first" in banner.text
    assert margin.binds_first is not None
    assert banner.text.rstrip().endswith(margin.binds_first.replace("_", " "))


def test_the_page_says_what_the_certificate_says(proved: Planned, proved_page: str) -> None:
    text, certificate = Reader(proved_page).text, proved.certificate
    # the page has one spelling of its units
    assert certificate.reading.claim in text.replace("µm²", "um^2").replace("µm", "um")
    assert certificate.task_hash in text
    for premise in certificate.reading.premises.values():
        assert premise in text
    for step in certificate.steps:
        said = words(name_of(step.property))
        assert said[0].upper() + said[1:] in text
        count = len(step.obligations)
        assert f"{count} of {count} inequalities proved" in text
        for obligation in step.obligations:
            inequality = obligation.inequality
            assert inequality_words(inequality) in text
            assert (inequality.derivation or "interval arithmetic") in text
            assert obligation.lower_bound is None or (
                f"{float.fromhex(obligation.lower_bound):.3g}".replace("-", "−") in text
            )
    for name, value in certificate.made_with.items():
        assert f"{name} {value}" in text


def test_boxes_in_the_page_hold_the_certified_ones(proved: Planned, proved_page: str) -> None:
    cards = re.findall(r'<div class="ends">.*?</div>\n</div>', proved_page, re.DOTALL)
    found = re.findall(r">([xyθ]) (\S+) … (\S+) (?:µm|deg)<", "".join(cards))
    shown = [(float(a.replace("−", "-")), float(b.replace("−", "-"))) for _, a, b in found]
    wanted = [
        ends
        for step in proved.certificate.steps
        for box in (step.pre, step.post)
        if box is not None
        for ends in (box.x_um, box.y_um, box.theta_deg)
    ]
    assert len(shown) == len(wanted) == 24
    for (low, high), (exact_low, exact_high), (name, _, _) in zip(
        shown, wanted, found, strict=True
    ):
        digit = 0.01 if name == "θ" else 0.1
        # the certificate's ends are rounded outward to a thousandth themselves
        assert low - 0.0021 <= exact_low < low + digit
        assert high - digit < exact_high <= high + 0.0021


def test_the_policy_can_be_carried_out_from_the_page(proved: Planned, proved_page: str) -> None:
    text = Reader(proved_page).text
    for rule in proved.certificate.policy:
        for name, aim in (("x", rule.dual_x), ("y", rule.dual_y), ("x", rule.dual_end_x)):
            size = f"{abs(aim.offset_um):.1f} µm"
            sign = "−" if aim.offset_um < 0 else "+"
            part = f"sensed {name} {sign} {size}"
            assert (part if aim.relative_to == "sensed part" else size) in text
    for move in proved.plan.moves:
        for probe in move.probes:
            x, y = (f"{value:.1f}".replace("-", "−") for value in probe.start_um)
            assert f"({x}, {y})" in text


def test_the_margins_are_those_of_the_certificate(proved: Planned, proved_page: str) -> None:
    section = proved_page[proved_page.index('id="margin"') : proved_page.index('id="simulation"')]
    text = Reader(f"<div><h2 {section}</h2></div>".replace("<h2 </h2>", "")).text
    for value in (proved.certificate.margin.factor, *proved.certificate.margin.each_alone.values()):
        assert f"× {int(value * 100 + 1e-9) / 100:.2f}" in text
    # 5 um times the factor, rounded down; the middle of 0.30 ... 0.36 is 0.33
    alone = proved.certificate.margin.each_alone
    assert f"± {int(alone['probe_position'] * 5000) / 1000:g} µm" in text
    reach = 0.03 * alone["friction"]
    low, high = math.ceil(330 - 1000 * reach) / 1000, math.floor(330 + 1000 * reach) / 1000
    assert f"{low:g} … {high:g}" in text
    assert proved.certificate.margin.limit is not None
    assert proved.certificate.reading.limit is not None
    assert words(name_of(proved.certificate.margin.limit)) in proved.certificate.reading.limit
    assert proved.certificate.reading.limit in text
    assert section.count('class="bar') == 1 + len(proved.certificate.margin.each_alone)


def test_the_page_says_how_to_make_it_again(page: str) -> None:
    assert "meso-robust plan TASK.toml --samples 40 --seed 3" in page


def test_the_refuted_page_names_the_open_inequality_and_the_witness(
    refuted: Planned, refuted_page: str
) -> None:
    certificate, text = refuted.certificate, Reader(refuted_page).text
    assert certificate.undecided is not None
    assert certificate.witness is not None
    lead = text[: text.index("The nominal run, in which")]
    claim = words(name_of(certificate.undecided.reason))
    assert claim[0].upper() + claim[1:] in lead
    assert certificate.undecided.inequality is not None
    assert inequality_words(certificate.undecided.inequality) in lead
    assert words(name_of(certificate.undecided.settled_by)) in lead
    outcome = certificate.reading.outcome
    assert outcome is not None
    assert outcome[0].upper() + outcome[1:] in lead
    x = float.fromhex(certificate.witness.start[0]) * 1e6
    assert f"({x:.2f} µm" in lead
    for end in (*certificate.undecided.over.values(), certificate.witness.start):
        assert end[0] not in text
    assert "not reached by the proof" in text
    assert "there is no margin" in text
    assert "binds first" not in text


def test_an_unknown_page_says_that_nothing_is_refuted(refuted: Planned) -> None:
    unknown = refuted.certificate.model_copy(update={"verdict": "UNKNOWN", "witness": None})
    page = report(replace(refuted, certificate=unknown))
    assert '<header class="UNKNOWN">' in page
    assert 'id="witness"' not in page
    assert 'id="open"' in page
    assert Reader(page).open == []


def test_text_of_the_user_is_escaped(proved: Planned) -> None:
    evil = '<script>alert("1")</script> & "co"'
    task = proved.task.model_copy(update={"name": evil})
    certificate = proved.certificate.model_copy(update={"task": evil})
    page = report(replace(proved, task=task, certificate=certificate))
    assert page.count("<script") == 2  # the data of the view, and ours
    assert html.escape("<script>") in page
    assert evil in Reader(page).text


def test_the_page_is_the_same_every_time(proved: Planned, proved_page: str) -> None:
    assert report(proved) == proved_page


def test_the_page_needs_no_plotting_library(proved: Planned, proved_page: str) -> None:
    ours = {name for name in sys.modules if name.startswith("meso_robust.reporting.")}
    with pytest.MonkeyPatch.context() as patch:
        for name in [name for name in sys.modules if name.split(".")[0] == "matplotlib"]:
            patch.setitem(sys.modules, name, None)  # an import of it fails
        for name in ours - {"meso_robust.reporting.reading"}:  # whose standings are compared
            patch.delitem(sys.modules, name)
        assert import_module("meso_robust.reporting.plan").report(proved) == proved_page


def test_a_move_in_other_axes_says_which() -> None:
    rule = RuleDocument(
        step=1,
        primitive="x_translation",
        action="straighten",
        side=0,
        dual_x=AimDocument(relative_to="sensed part", offset_um=1.0),
        dual_y=AimDocument(relative_to="sensed part", offset_um=1.0),
        dual_end_x=AimDocument(relative_to="world", offset_um=1.0),
    )
    turned = rule.model_copy(update={"heading": "-y", "mirrored": True})

    assert rows._axes(rule) == ""
    assert rows._axes(turned) == "pushes along −y of the world, y mirrored"
