"""The register as files: complete, safe, typeset, the same every time, its pictures true."""

from __future__ import annotations

import cmath
import hashlib
import json
import math
import os
import re
import subprocess
import sys
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
import sympy as sp
from markupsafe import Markup

from derivations import _smt
from derivations._claim import Claim, Verdict
from derivations._derivation import Derivation
from derivations._statement import (
    DerivationError,
    angle,
    for_all,
    identity,
    positive_by,
    there_is,
    together,
)
from derivations.report import FOLDER, figures, formulas, jam, notation, register, render, witnesses
from derivations.report.page import page
from meso_robust._generated import one_point_sticking
from meso_robust.reporting.theme import themed

ROOT = Path(__file__).resolve().parents[2]
x, y = sp.symbols("x y", real=True)
p, q = sp.symbols("p q", positive=True)
t = sp.Symbol("theta", real=True)
TITLE = "Squares <script>alert(1)</script> & sums | bars"


def sample() -> tuple[Derivation, ...]:
    """One claim of every verdict, made by the functions that decide."""
    square = for_all("$x^2 + y^2 < 2 x y - 1$ never", [], x**2 + y**2 > 2 * x * y - 1)
    quarter = {**angle(sp.Rational(1, 5), t), p: sp.Rational(7, 3)}
    one = (
        Claim(
            key="confirmed",
            title=TITLE,
            place="eq. (1)",
            printed=r"$(x + y)^2 = x^2 + 2 x y + y^2$",
            derived="the same",
            steps=("Expand $(x+y)(x+y)$.", "Collect."),
            of_print=(identity("binomial", (x + y) ** 2, x**2 + 2 * x * y + y**2),),
        ),
        Claim(
            key="added",
            title="A root",
            place="eq. (2)",
            printed="$x > 1$",
            derived="$x > 1$ where $x > 2$",
            hypotheses=("$x$ real", "$x > 2$"),
            added=("$x > 2$",),
            of_print=(for_all("$x > 1$ for $x > 0$", [x > 0], x > 1, at={x: sp.Rational(1, 3)}),),
            with_added=(for_all("$x > 1$", [x > 2], x > 1),),
        ),
        Claim(
            key="empty",
            title="Nothing is left",
            place="eq. (6)",
            printed="$p > 1$",
            derived="$p > 1$ where $p > q$ and $q > 3$, but $p < 2$",
            added=("$p > q$", "$q > 3$"),
            of_print=(for_all("$p > 1$ as it stands", [], p > 1, at={p: sp.Rational(1, 3)}),),
            with_added=(for_all("$p > 1$", [p > q, q > 3], p > 1),),
            compatible=(together("both where $p < 2$", p > q, q > 3, p < 2),),
        ),
        Claim(
            key="sharpened",
            title="A bound",
            place="eq. (3)",
            printed="$x^2 + y^2 > 2 x y - 1$",
            derived=r"$x^2 + y^2 \ge 2 x y$",
            of_print=(square,),
            sharper=(for_all(r"$x^2 + y^2 \ge 2 x y$", [], x**2 + y**2 >= 2 * x * y),),
        ),
    )
    two = (
        Claim(
            key="refuted",
            title="No square is small",
            place="eq. (4)",
            printed="$x^2 > 1$",
            derived="not so",
            of_print=(for_all("$x^2 > 1$ for $x > 0$", [x > 0], x**2 > 1),),
        ),
        Claim(
            key="inconsistent",
            title="Two at once",
            place="eq. (5)",
            printed="$x > 1$ and $x < 0$",
            derived="not both",
            consistent=(
                together("the first alone", x > 1),
                together("both relations", x > 1, x < 0),
            ),
        ),
        Claim(
            key="new-one",
            title="Product of sums",
            place="new",
            derived="$(p + q)^2 > 4 p q - 1$",
            checks=(
                positive_by("$p q + p > 0$", p * q + p, {"p": p, "q": q}, "p", "p**2*q + p**2"),
                there_is("an angle", [sp.cos(t) > 0, p > 2], quarter),
            ),
        ),
    )
    return (
        Derivation(name="first", summary="First file.", claims=one),
        Derivation(name="second", summary="Second file.", claims=two),
        Derivation(name="without", summary="Nothing claimed here.", claims=()),
    )


def alone(**changes: object) -> tuple[Derivation, ...]:
    """One file with one claim."""
    fields = {
        "key": "lonely",
        "title": "Lonely",
        "place": "eq. (1)",
        "derived": "so",
        "checks": (identity("zero", sp.Derivative(y, x), sp.S.Zero),),
        **changes,
    }
    claim = Claim(**fields)  # type: ignore[arg-type]
    return (Derivation(name="one", summary="One.", claims=(claim,)),)


AGAIN = """
from tests.derivations.test_report import FOLDER, digest, render, sample
print(digest({path.relative_to(FOLDER).as_posix(): text for path, text in render(sample()).items()}))
"""


@pytest.fixture(scope="module", autouse=True)
def elsewhere(tmp_path_factory: pytest.TempPathFactory) -> Iterator[subprocess.Popen[str]]:
    """Another run of the sample, in another folder and hash order, beside the tests."""
    run = subprocess.Popen(
        [sys.executable, "-c", AGAIN],
        cwd=tmp_path_factory.mktemp("elsewhere"),
        env={**os.environ, "PYTHONHASHSEED": "4711", "PYTHONPATH": str(ROOT)},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    with run:
        yield run


@pytest.fixture(scope="module")
def derivations() -> tuple[Derivation, ...]:
    return sample()


@pytest.fixture(scope="module")
def files(derivations: tuple[Derivation, ...]) -> dict[str, str]:
    return {path.relative_to(FOLDER).as_posix(): text for path, text in render(derivations).items()}


class Reader(HTMLParser):
    """Text, elements, ids and references of a page; stops at wrong nesting."""

    VOID = ("meta", "br", "wbr")

    def __init__(self, page: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.tags: list[str] = []
        self.ids: list[str] = []
        self.targets: list[str] = []
        self.text = ""
        self.feed(page)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        for name, value in attrs:
            assert value is not None
            assert not name.startswith("on")
            if name == "id":
                self.ids.append(value)
            if name in {"href", "xlink:href", "src"}:
                self.targets.append(value)
            self.targets += re.findall(r"url\(([^)]*)\)", value)
        if tag not in self.VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.handle_starttag(tag, attrs)
        if tag not in self.VOID:
            self.open.pop()

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        if "style" not in self.open:
            self.text += data


@pytest.fixture(scope="module")
def read(files: dict[str, str]) -> Reader:
    return Reader(files["index.html"])


# -- completeness ---------------------------------------------------------------------------------


def test_the_samples_have_every_verdict(derivations: tuple[Derivation, ...]) -> None:
    assert [c.verdict for d in derivations for c in d.claims] == list(Verdict)


def test_the_page_shows_every_claim_with_its_verdict(
    files: dict[str, str], derivations: tuple[Derivation, ...]
) -> None:
    pattern = re.compile(r'<article class="entry \w+" id="([^"]+)">(.*?)</article>', re.DOTALL)
    articles = dict(pattern.findall(files["index.html"]))
    claims = [claim for derivation in derivations for claim in derivation.claims]
    assert list(articles) == [claim.key for claim in claims]
    for claim in claims:
        words = Reader(articles[claim.key]).text
        mark = register.MARKS[claim.verdict]
        assert f"{mark} {claim.verdict.words}" in words
        assert claim.title in words
        assert claim.place in words
        assert words.count("✓ holds") + words.count("✗ fails") == len(claim.findings)
        assert ("As printed" in words) == bool(claim.printed)


def test_the_head_counts_by_verdict(read: Reader) -> None:
    assert "2 of 6 printed statements stand as printed" in read.text
    assert read.text.index("2 of 6 printed") < read.text.index("Overview")
    assert len(set(register.MARKS.values())) == len(Verdict)


def test_the_overview_links_to_every_claim(
    read: Reader, derivations: tuple[Derivation, ...]
) -> None:
    for derivation in derivations:
        for claim in derivation.claims:
            assert read.targets.count(f"#{claim.key}") == 2  # the overview and its own heading


def test_a_file_without_claims_has_no_chapter(read: Reader, files: dict[str, str]) -> None:
    assert "Nothing claimed here" not in read.text + files["README.md"]


def test_added_hypotheses_are_marked_and_only_they(files: dict[str, str]) -> None:
    for name in ("index.html", "README.md"):
        assert files[name].count("the print lacks it") == 3
    for formula in (r"x \gt 2", r"p \gt q", r"q \gt 3"):
        assert f"- ${formula}$ **(added" in files["README.md"]


def test_the_json_says_everything(
    files: dict[str, str], derivations: tuple[Derivation, ...]
) -> None:
    content = json.loads(files["register.json"])
    assert content["counts"] == {verdict.words: 1 for verdict in Verdict}
    claims = {claim.key: (claim, d) for d in derivations for claim in d.claims}
    assert [entry["key"] for entry in content["claims"]] == list(claims)
    for entry in content["claims"]:
        claim, derivation = claims[entry["key"]]
        assert entry["verdict"] == claim.verdict.words
        assert entry["derivation"] == f"derivations/{derivation.name}.py"
        for name in ("title", "place", "printed", "derived"):
            assert entry[name] == getattr(claim, name)
        for name in ("hypotheses", "added", "steps"):
            assert tuple(entry[name]) == getattr(claim, name)
        for shown, finding in zip(entry["findings"], claim.findings, strict=True):
            assert {k: shown[k] for k in ("what", "holds", "how", "witness")} == {
                "what": finding.what,
                "holds": finding.holds,
                "how": finding.how,
                "witness": dict(finding.witness),
            }


def test_the_json_names_the_routes(files: dict[str, str]) -> None:
    entries = {entry["key"]: entry for entry in json.loads(files["register.json"])["claims"]}
    routes = {key: [f["route"] for f in entry["findings"]] for key, entry in entries.items()}
    assert routes["confirmed"] == ["identity"]
    assert routes["added"] == ["witness", "z3"]
    assert routes["empty"] == ["witness", "z3", "z3"]
    assert routes["new-one"] == ["certificate", "witness"]


def test_the_markdown_says_what_the_page_says(
    files: dict[str, str], derivations: tuple[Derivation, ...]
) -> None:
    text = files["README.md"]
    for derivation in derivations:
        for claim in derivation.claims:
            chapter = text[text.index(f'<a id="{claim.key}">') :]
            assert f"{register.MARKS[claim.verdict]} **{claim.verdict.words}**" in chapter
            assert f"](#{claim.key})" in text
    for picture in re.findall(r"!\[[^\]]*\]\(([^)]*)\)", text):
        assert picture in files
    assert text.count("![") == len([name for name in files if name.endswith(".svg")])


# -- stored proofs --------------------------------------------------------------------------------


def test_every_query_is_stored_and_z3_answers_as_promised(files: dict[str, str]) -> None:
    findings = [
        finding
        for entry in json.loads(files["register.json"])["claims"]
        for finding in entry["findings"]
    ]
    promised = {f["proof"]: f["answer"] for f in findings if f["proof"]}
    assert set(promised) == {name for name in files if name.endswith(".smt2")}
    assert sorted(promised.values()) == ["sat"] * 2 + ["unsat"] * 6
    for name, answer in promised.items():
        assert _smt.solve(files[name])[0] == answer, name
    assert "proofs/added-2.smt2" in promised  # the second finding of its claim


def test_the_page_links_to_the_stored_proofs(read: Reader, files: dict[str, str]) -> None:
    linked = {target for target in read.targets if target.startswith("proofs/")}
    assert linked == {name for name in files if name.startswith("proofs/")}
    assert "must answer unsat" in read.text


def test_a_query_with_an_unknown_answer_is_refused() -> None:
    (finding,) = sample()[1].claims[0].of_print
    strange = replace(finding, holds=True, how="z3: perhaps", query="(check-sat)")
    with pytest.raises(DerivationError, match=r"lonely: no known answer .* perhaps"):
        register.chapters(alone(checks=(strange,)))


def test_findings_are_numbered_in_the_claims_own_order(derivations: tuple[Derivation, ...]) -> None:
    for entry in register.every_entry(register.chapters(derivations)):
        assert [found.finding for found in entry.found] == list(entry.claim.findings)
        assert [f for _, group in entry.groups for f in group] == list(entry.found)


# -- safety and form ------------------------------------------------------------------------------


def test_the_page_is_well_formed_and_needs_nothing_else(
    read: Reader, files: dict[str, str]
) -> None:
    assert read.open == []
    assert len(read.ids) == len(set(read.ids))
    for target in read.targets:
        assert target.startswith("#") or target in files, target
        if target.startswith("#"):
            assert target[1:] in read.ids, target
    assert not {"script", "link", "img", "iframe", "object", "embed", "image"} & set(read.tags)
    known = {"http://www.w3.org/2000/svg", "http://www.w3.org/1999/xlink"}
    assert set(re.findall(r'https?://[^\s"<>]*', files["index.html"])) <= known
    assert "@import" not in files["index.html"]


def test_texts_are_escaped(read: Reader, files: dict[str, str]) -> None:
    assert TITLE in read.text
    assert "<script" not in files["index.html"]
    assert not re.search(r"(?<!\\)<script", files["README.md"])


def test_markdown_tables_keep_their_columns(files: dict[str, str]) -> None:
    rows = [line for line in files["README.md"].splitlines() if line.startswith("|")]
    assert rows
    for table in re.findall(r"(?:^\|.*\n)+", files["README.md"], re.MULTILINE):
        bars = {len(re.findall(r"(?<!\\)\|", row)) for row in table.splitlines()}
        assert len(bars) == 1, table


@pytest.mark.parametrize("field", ["title", "place", "derived", "printed"])
def test_a_lone_dollar_names_the_claim(field: str) -> None:
    findings = alone()[0].claims[0].checks
    wrong = {field: "costs $5"} | ({"of_print": findings} if field == "printed" else {})
    with pytest.raises(DerivationError, match=r"lonely: a dollar sign without its partner"):
        page(register.chapters(alone(**wrong)), ())


@pytest.mark.parametrize(
    "text", ["$$", "$x = $y$$", "$ $", r"$\text{<b>x</b>}$", r"$\href{u}{x}$", r"$\foo$", "$x{$"]
)
def test_a_faulty_formula_names_the_claim(text: str) -> None:
    with pytest.raises(DerivationError, match=r"^lonely: "):
        formulas.to_html(text, "lonely")


def test_a_lone_dollar_in_a_finding_names_the_claim() -> None:
    with pytest.raises(DerivationError, match=r"lonely: a dollar"):
        page(
            register.chapters(alone(checks=(identity("zero $x", sp.Derivative(y, x), sp.S.Zero),))),
            (),
        )


@pytest.mark.parametrize("key", ["", "a b", "../a", "A", "a--b", "a/b"])
def test_a_key_that_is_no_file_name_is_refused(key: str) -> None:
    with pytest.raises(DerivationError, match="a key is made of"):
        register.chapters(alone(key=key))


def test_a_key_used_twice_is_refused() -> None:
    with pytest.raises(DerivationError, match="lonely: 2 claims have this key"):
        register.chapters((*alone(), *alone()))


# -- formulas -------------------------------------------------------------------------------------


def shown(latex: str) -> str:
    """The characters of a formula as a browser draws them."""
    return re.sub(r"<[^>]*>|\s", "", formulas.to_html(f"${latex}$", "test"))


@pytest.mark.parametrize(
    ("latex", "characters"),
    [
        (r"\lambda_n = -e_x v_p N/F", "λn=−exvpN/F"),
        (r"\operatorname{atan}{\left(C + \mu A \right)}", "atan(C+μA)"),
        (r"a < b \le c", "a&lt;b≤c"),
        (r"\left[\begin{matrix}a & b\\c & d\end{matrix}\right]", "[abcd]"),
        (r"\frac{\sqrt{1 + \mu^{2}}}{2}", "1+μ22"),
    ],
)
def test_formulas_keep_their_characters(latex: str, characters: str) -> None:
    assert shown(latex) == characters


LONG = (
    r"\lambda_n = -e_x v_p \left(a + b\right) + |c + d - e| (f - g), \quad \rho = e_\theta/e_x > 0"
)


def test_long_formulas_may_break_at_their_outermost_signs_only() -> None:
    pieces = formulas.breakable(LONG)
    assert pieces[0] == r"\lambda_n = -e_x v_p \left(a + b\right)"
    assert pieces[1] == r"+ |c + d - e| (f - g),\ \rho"
    assert formulas.breakable("a + b = c") == ["a + b = c"]
    whole = shown(LONG)
    assert whole == "λn=−exvp(a+b)+|c+d−e|(f−g),ρ=eθ/ex&gt;0"


def test_markdown_formulas_hold_nothing_that_markdown_takes_for_its_own() -> None:
    text = formulas.to_markdown(r"a_b * $\max\{|x|, y\} < 1,\ z * w \\ v$ <i>", "test")
    assert text.startswith(r"a\_b \* $\max\lbrace \vert x\vert , y\rbrace \lt 1,")
    assert text.endswith(r"\<i\>")
    formula = text.split("$")[1]
    assert not re.search(r"[|<>*]|\\[^A-Za-z]", formula)


def test_a_witness_reads_in_degrees_and_decimals() -> None:
    rows = witnesses.values(
        {"cos(theta)": "-5/13", "d1": "837/2", "sin(theta)": "12/13", "w": "3", "z": "sqrt(2)"}
    )
    assert [(row.exact, row.decimal) for row in rows] == [
        ("(-5/13, 12/13)", "112.62°"),
        ("837/2", "418.5"),
        ("3", ""),
        ("sqrt(2)", ""),
    ]
    assert rows[0].name == r"$(\cos \theta, \sin \theta)$"
    (row,) = witnesses.values({"cos_theta": "1/2"})  # half an angle stays what it is
    assert (row.name, row.exact) == (r"$\cos \theta$", "1/2")


def test_a_certificate_is_typeset_or_left_as_it_is() -> None:
    (finding, _) = sample()[1].claims[2].checks
    read = witnesses.certificate(finding.how.removeprefix("certificate, "))
    assert read is not None
    assert read.equation == r"$\text{goal} \cdot (p) = p^{2} \cdot q + p^{2}$"
    goal = (r"$\text{goal}$", "$p q + p$")
    assert read.given == (goal, ("$p$", "$p$"), ("$q$", "$q$"))
    named = witnesses.certificate(
        "checked exactly: goal = cos*S with S = sin(x), cos = x all positive"
    )
    assert named is not None  # a name is a name, whatever else it may mean
    assert named.given == (("$S$", r"$\sin{\left(x \right)}$"), (r"$\text{cos}$", "$x$"))
    assert witnesses.certificate("checked exactly: by hand") is None
    assert witnesses.certificate("checked exactly: goal = ( with a = 1 all positive") is None


# -- the same every time --------------------------------------------------------------------------


def digest(rendered: dict[str, str]) -> str:
    """One hash of all paths and texts."""
    return hashlib.sha256(json.dumps(list(rendered.items())).encode()).hexdigest()


def test_another_run_elsewhere_with_another_hash_order_writes_the_same_bytes(
    files: dict[str, str], elsewhere: subprocess.Popen[str]
) -> None:
    out, err = elsewhere.communicate(timeout=120)
    assert elsewhere.returncode == 0, err
    assert out.strip() == digest(files)


def test_no_date_and_no_path_of_the_machine(files: dict[str, str]) -> None:
    for name, text in files.items():
        assert str(ROOT) not in text, name
        assert not re.search(r"\b20[2-9]\d-\d\d-\d\d\b", text), name


# -- pictures -------------------------------------------------------------------------------------

MM = {"width": figures.WIDTH / 1e3, "rho": figures.RHO / 1e6}


def picture(name: str, files: dict[str, str]) -> str:
    """Caption of a picture in the Markdown."""
    return files["README.md"].split(f"(figures/{name}.svg)\n\n")[1].split("\n\n")[0]


def test_every_picture_stands_alone(files: dict[str, str]) -> None:
    for name in (name for name in files if name.endswith(".svg")):
        root = ET.fromstring(files[name])
        assert root.tag == "{http://www.w3.org/2000/svg}svg"
        assert root.get("width", "").endswith("pt")
        assert "data:" not in files[name]  # no images within
        assert root.find("{http://www.w3.org/2000/svg}title") is not None


def test_the_pictures_in_the_page_are_the_files(files: dict[str, str]) -> None:
    for name in (name for name in files if name.endswith(".svg")):
        inside = re.sub(r'<svg width="[^"]*" height="[^"]*"', "<svg", files[name]).strip()
        assert themed(Markup(inside)) in files["index.html"]


def forces(theta: float) -> tuple[float, float]:
    """Normal and tangential force of the example's sticking contact, by one linear solve."""
    a, n = (
        np.array([math.cos(theta), math.sin(theta)]),
        np.array([math.sin(theta), -math.cos(theta)]),
    )
    arm = (figures.OFFSET * a + figures.HALF_WIDTH * n) / 1e3
    rho = figures.RHO / 1e6
    rows = np.zeros((5, 5))
    rows[:3, :3] = np.diag([1.0, 1.0, rho])
    for column, force in ((3, -n), (4, a)):
        rows[:2, column] = -force
        rows[2, column] = -(arm[0] * force[1] - arm[1] * force[0])
    rows[3, [0, 2]] = 1.0, -arm[1]
    rows[4, [1, 2]] = 1.0, arm[0]
    solved = np.linalg.solve(rows, [0.0, 0.0, 0.0, -1.0, 0.0])
    return float(solved[3]), float(solved[4])


def test_the_limits_of_sticking_by_linear_solves_and_bisection(files: dict[str, str]) -> None:
    found = []
    for inside, outside in ((100.0, 70.0), (115.0, 140.0)):
        for _ in range(50):
            middle = 0.5 * (inside + outside)
            normal, shear = forces(math.radians(middle))
            sticks = normal > 0 and abs(shear) < figures.MU * normal
            inside, outside = (middle, outside) if sticks else (inside, middle)
        found.append(inside)
    assert figures.sticking_limits() == pytest.approx(found, abs=1e-9)
    assert found[1] == pytest.approx(120.96, abs=0.005)
    caption = picture("sticking-interval", files)
    assert f"{found[0]:.2f}° to {found[1]:.2f}°" in caption
    assert "129.9°" in caption


def test_the_printed_limit_by_the_phase_of_complex_numbers() -> None:
    first = cmath.phase(complex(350.0, 418.5))
    second = cmath.phase(complex(376_900.0 + 418.5**2, 418.5 * 350.0))
    assert figures.printed_limit() == pytest.approx(180.0 - math.degrees(max(first, second)))
    assert round(figures.printed_limit(), 1) == 129.9


def test_the_curve_is_the_ratio_of_the_forces() -> None:
    for theta in (62.0, 90.0, 104.0, 125.0, 160.0):
        normal, shear = forces(math.radians(theta))
        drawn = figures.force_ratio(np.array([theta]))
        assert drawn == pytest.approx(abs(normal / shear), rel=1e-9)


def test_the_signs_of_the_notation_are_those_of_the_code() -> None:
    """lambda_t/lambda_n = -D/N with N and D as in the list of letters."""
    (meaning,) = (words for letters, words in notation.SYMBOLS if letters == "$N$, $D$")
    assert r"\lambda_n = -e_x v_p N/F" in meaning
    assert r"\lambda_t = e_x v_p D/F" in meaning
    theta, d1, d2, rho = 1.9, 0.4, 0.3, 0.37
    N = d1 * d2 * math.cos(theta) + (rho + d1**2) * math.sin(theta)
    D = (rho + d2**2) * math.cos(theta) + d1 * d2 * math.sin(theta)
    assert one_point_sticking.stick_ratio(math, theta, d1, d2, rho)[0] == pytest.approx(-D / N)


def jams_somewhere(V: float, mu: float) -> bool:
    """By the enumeration of modes, on a fine grid of h that leaves out 0."""
    ahead = (np.arange(400) + 0.5) / 1e3
    h: jam.Floats = np.concatenate([ahead, -ahead[:100]])
    ones: jam.Floats = np.ones(h.shape)
    return bool(jam.jams(V / 1e3 * ones, h, mu * ones, **MM).any())


def test_the_jam_limit_by_bisecting_the_enumeration_of_modes(files: dict[str, str]) -> None:
    jammed, free = 857.0, 930.0
    for _ in range(20):
        middle = 0.5 * (jammed + free)
        jammed, free = (middle, free) if jams_somewhere(middle, figures.MU) else (jammed, middle)
    assert jammed == pytest.approx(881.4, abs=0.01)
    assert float(figures.jam_limit(figures.MU)) == pytest.approx(jammed, abs=0.01)
    assert "881.4 µm" in picture("jam-map", files)
    assert "857 µm" in picture("jam-map", files)


def test_the_raster_agrees_with_the_derived_limit_within_a_cell() -> None:
    raster = figures.jam_raster()
    cell = figures.JAM_V[1] - figures.JAM_V[0]
    limit = figures.WIDTH * np.sqrt(1.0 + figures.JAM_MU**2)
    for column, boundary in zip(raster.T, limit, strict=True):
        below = boundary > figures.JAM_V
        wrong = column != below
        assert not (wrong & (np.abs(figures.JAM_V - boundary) > cell)).any()
    assert raster.any()
    assert not raster.all()


def test_without_coulombs_cone_nothing_would_jam(monkeypatch: pytest.MonkeyPatch) -> None:
    real = jam._conditions

    def loose(
        contact: jam.Contact, mode: jam.Mode, forces: jam.Floats, mu: jam.Floats
    ) -> list[jam.Flags]:
        return list(real(contact, mode, forces, mu))[:1]  # forces press, and no more

    assert jams_somewhere(857.0, figures.MU)
    monkeypatch.setattr(jam, "_conditions", loose)
    assert not jams_somewhere(857.0, figures.MU)


def test_the_contacts_of_the_enumeration_follow_from_the_positions() -> None:
    """Forces on the part move it as the drag says, points move with it: in world axes."""
    V, h, slide = 0.9, 0.21, 0.07
    width, rho = MM["width"], MM["rho"]
    at_D, at_S = jam.contacts(np.array([V]), np.array([h]), width, rho, slide)
    reach = math.hypot(h, V)
    theta = math.atan2(V, h) + math.asin(width / reach)
    a, n = (
        np.array([math.cos(theta), math.sin(theta)]),
        np.array([math.sin(theta), -math.cos(theta)]),
    )
    S, D = np.zeros(2), np.array([h, V])
    middle_of_edges = 0.5 * (S + D)
    centre = middle_of_edges + slide * a
    pushes = [(D, -n), (D, a), (S, n), (S, a)]
    for column, (place, force) in enumerate(pushes):
        arm = place - centre
        turn = (arm[0] * force[1] - arm[1] * force[0]) / rho
        for contact, point in ((at_D, D), (at_S, S)):
            arm = point - centre
            velocity = force + turn * np.array([-arm[1], arm[0]])
            assert contact.point[0, :, column] == pytest.approx([velocity @ a, velocity @ n])
    assert at_D.tip[0] == pytest.approx([-a[0], -n[0]])


def test_the_tilt_by_bisecting_the_distance_of_the_edges(files: dict[str, str]) -> None:
    """Parallel lines through both tips are as far apart as the part is wide."""

    def tilt(push: float) -> float:
        h, V = figures.WIDTH - push, figures.SEPARATION
        low, high = 1e-6, math.pi / 2 + 1e-9  # tilt
        for _ in range(60):
            middle = 0.5 * (low + high)
            theta = math.pi - middle
            apart = h * math.sin(theta) - V * math.cos(theta)
            low, high = (low, middle) if apart < figures.WIDTH else (middle, high)
        return math.degrees(low)

    for push in (300.0, 1100.0, 2000.0):
        assert figures.tilt(np.array([push])) == pytest.approx(tilt(push), abs=1e-6)
    assert tilt(figures.push_to_printed_tilt()) == pytest.approx(figures.printed_tilt(), abs=1e-6)
    expected = cmath.phase(complex(math.sqrt(837**2 + 1616**2 - 857**2), 857)) - cmath.phase(
        1616 + 837j
    )
    assert figures.printed_tilt() == pytest.approx(math.degrees(expected))
    caption = picture("tilt-by-push", files)
    for number in ("0.71°", "2.44 mm", "3.9°"):
        assert number in caption


# -- looks ----------------------------------------------------------------------------------------


def luminance(colour: str) -> float:
    """Relative luminance of ``#rrggbb``."""
    parts = [int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5)]
    linear = [v / 12.92 if v <= 0.04045 else ((v + 0.055) / 1.055) ** 2.4 for v in parts]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


@pytest.mark.parametrize("theme", [0, 1], ids=["light", "dark"])
def test_verdicts_are_legible_in_both_themes(theme: int, files: dict[str, str]) -> None:
    for verdict in Verdict:
        ink, paper = (
            re.findall(rf"--{verdict.name}{suffix}: (#\w{{6}});", files["index.html"])[theme]
            for suffix in ("", "-soft")
        )
        light, dark = sorted((luminance(ink), luminance(paper)), reverse=True)
        assert (light + 0.05) / (dark + 0.05) >= 4.5, verdict
