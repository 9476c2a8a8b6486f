"""The register as a whole: verdicts that are computed, files that are what is derived."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
import sympy as sp

from derivations import generate, mechanics, report
from derivations._claim import Claim, Verdict
from derivations._derivation import Derivation
from derivations._statement import (
    DerivationError,
    angle,
    as_written,
    combined,
    crossed,
    for_all,
    identity,
    positive_by,
    require_zero,
    there_is,
    together,
)
from reports.flipped_signs.mutants import Mutant, caught
from tests.nightly import at_night

VERDICTS = {
    "eq-5-normal-force": "CONFIRMED",
    "eq-5-turning": "CONFIRMED",
    "eq-5-ratio": "CONFIRMED",
    "sentence-under-eq-5": "REFUTED",
    "eq-7": "CONFIRMED",
    "eq-8": "CONFIRMED",
    "sticking-arc": "NEW",
    "turning-over-the-arc": "NEW",
    "proof-of-lemma-1": "REFUTED",
    "lemma-1": "REFUTED",
    "uniqueness-one-contact": "NEW",
    "closed-form-motion": "NEW",
    "eq-9-normal-forces": "CONFIRMED",
    "eq-9-ratio": "CONFIRMED",
    "lemma-2": "CONFIRMED",
    "lemma-3": "CONFIRMED WITH ADDED HYPOTHESIS",
    "lemma-3-exact": "NEW",
    "sense-of-beta": "INCONSISTENT",
    "orientation-law": "NEW",
    "remark-pointed-cone": "REFUTED",
    "eq-10": "REFUTED",
    "no-jam": "NEW",
    "jam": "NEW",
    "remark-uniqueness": "SHARPENED",
    "eq-11": "EMPTY",
    "table-iv-rotation": "INCONSISTENT",
}
"""Of the claims whose file has no test file of its own; the others are tested there."""


def test_verdicts_are_those_known(derived: tuple[Derivation, ...]) -> None:
    found = {claim.key: claim.verdict.words for d in derived for claim in d.claims}
    assert {key: found.get(key) for key in VERDICTS} == VERDICTS


def test_every_numbered_equation_and_lemma_has_an_entry(derived: tuple[Derivation, ...]) -> None:
    places = " ".join(claim.place for d in derived for claim in d.claims if claim.printed)
    for number in range(1, 13):
        assert re.search(rf"\({number}\)", places), number
    for name in ("Lemma 1", "Lemma 2", "Lemma 3", "Step 1", "Step 2", "Step 3", "Step 4", "remark"):
        assert name in places, name


def test_files_on_disk_are_what_is_derived(derived: tuple[Derivation, ...]) -> None:
    files = generate.code(derived) | report.render(derived)
    if not report.PAGE.exists():
        del files[report.PAGE]  # not kept with the sources; one that was built is compared
    for path, text in files.items():
        assert path.read_text(encoding="utf-8") == text, path.name
    assert generate.on_disk() == set(files)


def test_every_derivation_file_is_a_source() -> None:
    files = {path.stem for path in (generate.ROOT / "derivations").glob("[!_]*.py")}
    assert set(generate.SOURCES) == files - {"generate", "mechanics"}


def test_no_verdict_is_typed_by_hand() -> None:
    for path in (generate.ROOT / "derivations").rglob("*.py"):
        text = path.read_text(encoding="utf-8")
        if path.name == "_claim.py":
            continue
        assert not re.search(r"Finding\((?=[^)]*holds=)", text) or path.name == "_statement.py", (
            path
        )
        if path.parent.name != "report":  # readers' words and colours of each verdict
            assert "Verdict" not in text, path


def test_every_stored_proof_is_answered_as_the_register_says() -> None:
    from derivations import _smt

    register = json.loads((report.FOLDER / "register.json").read_text(encoding="utf-8"))
    stored = [
        finding for claim in register["claims"] for finding in claim["findings"] if finding["proof"]
    ]
    assert len(stored) > 50
    for finding in stored[::7]:  # all of them are decided anew by derive --check
        text = (report.FOLDER / finding["proof"]).read_text(encoding="utf-8")
        assert _smt.solve(text)[0] == finding["answer"], finding["proof"]


@at_night
def test_the_same_bytes_whatever_the_hash_seed() -> None:
    run = (
        "from derivations import generate, report\n"
        "d = tuple(map(generate.derive_one, ('t2_motion', 'two_point_sticking')))\n"
        "files = generate.code(d) | report.render(d)\n"
        "print(hash(0), sorted((p.name, len(t), t.encode().hex()[:0]) for p, t in files.items()))\n"
        "import hashlib; print(hashlib.sha256(''.join(t for _, t in sorted(files.items()))"
        ".encode()).hexdigest())"
    )
    outputs = {
        subprocess.run(
            [sys.executable, "-c", run],
            cwd=generate.ROOT,
            env={**os.environ, "PYTHONHASHSEED": seed},
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        for seed in ("1", "2")
    }
    assert len(outputs) == 1


# -- a flipped sign is noticed (all of them: python -m reports.flipped_signs.mutants) -------------------

FLIPS = [
    Mutant("mechanics", 0, 0, "p[0] * q[1] - p[1] * q[0]"),
    Mutant("two_point_sticking", 0, 0, "(d4 - LEVER, LEVER)"),
    Mutant("final_orientation", 0, 0, "apart * a + w * n"),
    Mutant("t2_motion", 0, 0, "self._at(mu * self.normal - self.tangential, where)"),
]


@pytest.mark.parametrize(
    "flip",
    [pytest.param(FLIPS[0], marks=at_night), *FLIPS[1:]],  # all derivations rest on the mechanics
    ids=lambda flip: f"{flip.file}: {flip.was}",
)
def test_a_flipped_sign_makes_the_check_fail(flip: Mutant) -> None:
    path = generate.ROOT / "derivations" / f"{flip.file}.py"
    lines = path.read_text(encoding="utf-8").splitlines()
    (line,) = [k for k, text in enumerate(lines) if flip.was in text]
    sign = "+" if " + " in flip.was else "-"
    column = lines[line].index(flip.was) + flip.was.index(f" {sign} ") + 1
    assert caught(Mutant(flip.file, line + 1, column, sign))


# -- deciding -------------------------------------------------------------------------------------

x, y = sp.symbols("x y", real=True)
p, q = sp.symbols("p q", positive=True)
t = mechanics.theta


def test_identity_tells_zero_from_not_zero() -> None:
    assert identity("Pythagoras", sp.sin(t) ** 2 + sp.cos(t) ** 2, sp.Integer(1)).holds
    found = identity("no identity", x**2, x)
    assert not found.holds
    assert found.witness
    with pytest.raises(DerivationError, match="open"):
        identity("two unknowns", x, y, at={x: sp.Integer(1)})


def test_for_all_decides_with_circles_and_signs() -> None:
    assert for_all("circle", [sp.cos(t) > 0], sp.sin(t) < 1).holds
    assert for_all("signs of the symbols", [x > q], x + p > 0).holds
    found = for_all("false", [x > 0], x > 1)
    assert not found.holds
    assert 0 < sp.Rational(found.witness["x"]) <= 1
    assert found.query.endswith("(check-sat)\n")


def test_for_all_refuses_what_says_nothing() -> None:
    with pytest.raises(DerivationError, match="premises"):
        for_all("vacuous", [x > 1, x < 0], y > 0)
    with pytest.raises(DerivationError, match="no counterexample"):
        for_all("not refuted", [x > 0], x > 1, at={x: sp.Integer(2)})
    with pytest.raises(DerivationError, match="no counterexample"):
        for_all("premise broken", [x > 0], x > 1, at={x: sp.Integer(-2)})
    with pytest.raises(DerivationError, match="wrong sign"):
        for_all("sign broken", [], p > 1, at={p: sp.Integer(-1)})
    with pytest.raises(DerivationError, match="unit circle"):
        for_all("no angle", [], sp.cos(t) > 0, at={sp.cos(t): 0, sp.sin(t): sp.Rational(1, 2)})


def test_witnesses_are_checked() -> None:
    assert there_is("a root", [sp.Eq(x**2, 4)], at={x: sp.Integer(2)}).holds
    assert not there_is("no root", [sp.Eq(x**2, 4)], at={x: sp.Integer(3)}).holds
    with pytest.raises(DerivationError, match="not decided"):
        there_is("open", [x > y], at={x: sp.Integer(3)})


def test_together_finds_contradictions() -> None:
    assert together("possible", x > y, y > 0).holds
    assert not together("impossible", x > y, y > x).holds


def test_certificates_are_checked_exactly() -> None:
    given = {"a": x - 1, "b": y + 2}
    assert positive_by("product", (x - 1) * (y + 2), given, "1", "a*b").holds
    with pytest.raises(DerivationError, match="leaves"):
        positive_by("wrong", (x - 1) * (y + 3), given, "1", "a*b")
    with pytest.raises(DerivationError, match="not positive"):
        positive_by("negative", x - y - 3, given, "1", "a - b")
    with pytest.raises(DerivationError, match="not given"):
        positive_by("stranger", x, given, "1", "z")
    on_circle = positive_by(
        "circle", sp.Integer(1), {"s": x**2, "c": y**2}, "1", "s + c", on=[(x, y)]
    )
    assert on_circle.holds


def test_angles_are_exact() -> None:
    point = angle(sp.Rational(1, 2), t)
    assert point == {sp.cos(t): sp.Rational(3, 5), sp.sin(t): sp.Rational(4, 5)}


def test_require_zero_names_the_step_and_the_rest() -> None:
    require_zero((x + 1) ** 2 - x**2 - 2 * x - 1, "binomial")
    with pytest.raises(DerivationError, match=r"binomial: expected 0, but x is left over"):
        require_zero((x + 1) ** 2 - x**2 - x - 1, "binomial")


# -- what is recorded ----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("left", "right"),
    [(x, x), ([x, 0], [x, 0]), (sp.diff(x**2, x), 2 * x), (x + x - 2 * x, sp.Integer(0))],
)
def test_sides_that_print_alike_are_refused(left: object, right: object) -> None:
    with pytest.raises(DerivationError, match=r"half: both sides are .*, which says nothing"):
        identity("half", left, right)


def test_a_conclusion_that_is_given_or_true_by_itself_is_refused() -> None:
    for then in (sp.true, x > 0):
        with pytest.raises(DerivationError, match="which says nothing"):
            for_all("empty", [x > 0], then)


def test_sides_are_recorded_as_they_are_stated() -> None:
    slope = identity("slope", sp.Derivative(x**2, x), 2 * x)
    assert (slope.holds, slope.formal) == (True, "Derivative(x**2, x) = 2*x")
    area = identity("area", crossed((x, 1), (0, x)), x**2)
    assert (area.holds, area.formal) == (True, "Determinant(Matrix([ [x, 1], [0, x]])) = x**2")
    whole = identity("sum", as_written(lambda: (x + 1) - (x - 1)), sp.Integer(2))
    assert (whole.holds, whole.formal) == (True, "-(x - 1) + (x + 1) = 2")
    pair = identity("vector", combined((2, sp.Matrix([x, 1])), (-1, sp.Matrix([x, 0]))), [x, 2])
    assert pair.holds
    # a sum that stays one: its entries are compared all the same
    sides = (sp.MatAdd(sp.MatrixSymbol("A", 2, 1), sp.ImmutableMatrix([1, k])) for k in (2, 3))
    assert not identity("unlike", *sides).holds
    false = identity("slope", sp.Derivative(x**2, x), x)
    assert (false.holds, false.formal) == (False, "Derivative(x**2, x) = x")


def test_an_identity_may_hold_on_a_circle_only() -> None:
    on = identity("unit", [x**2 + t**2, x], [1, x], on=[(x, t)])
    assert on.holds
    assert on.formal == "(theta**2 + x**2, x) = (1, x) where Eq(theta**2 + x**2, 1)"
    assert not identity("unit", x**2 + t**2, sp.Integer(1)).holds


def test_no_finding_of_the_register_says_nothing(derived: tuple[Derivation, ...]) -> None:
    for claim in (claim for d in derived for claim in d.claims):
        for finding in claim.findings:
            stated = finding.formal.partition(" where ")[0]
            left, _, right = stated.partition(" => ")
            assert right not in left.split("; "), (claim.key, finding.what)
            assert stated not in ("", "True"), (claim.key, finding.what)
            if finding.how.startswith("identity"):
                left, equals, right = stated.partition(" = ")
                assert equals, (claim.key, finding.what)
                assert left != right, (claim.key, finding.what)
                assert len(finding.formal) < 2400, (
                    claim.key,
                    finding.what,
                )  # still to be read by eye


# -- verdicts -------------------------------------------------------------------------------------

TRUE = identity("true", (x + 1) ** 2, x**2 + 2 * x + 1)
FALSE = identity("false", x, 2 * x)


@pytest.mark.parametrize(
    ("fields", "expected"),
    [
        ({"checks": (TRUE,)}, Verdict.NEW),
        ({"printed": "p", "of_print": (TRUE,)}, Verdict.CONFIRMED),
        ({"printed": "p", "of_print": (TRUE,), "sharper": (TRUE,)}, Verdict.SHARPENED),
        ({"printed": "p", "of_print": (TRUE, FALSE)}, Verdict.REFUTED),
        (
            {"printed": "p", "of_print": (FALSE,), "with_added": (TRUE,), "added": ("h",)},
            Verdict.CONFIRMED_WITH_ADDED_HYPOTHESIS,
        ),
        (
            {
                "printed": "p",
                "of_print": (FALSE,),
                "with_added": (TRUE,),
                "added": ("h", "i"),
                "compatible": (FALSE,),
            },
            Verdict.EMPTY,
        ),
        (
            {
                "printed": "p",
                "of_print": (FALSE,),
                "with_added": (TRUE,),
                "added": ("h", "i"),
                "compatible": (TRUE,),
            },
            Verdict.CONFIRMED_WITH_ADDED_HYPOTHESIS,
        ),
        ({"printed": "p", "of_print": (TRUE,), "consistent": (FALSE,)}, Verdict.INCONSISTENT),
    ],
)
def test_the_verdict_follows_from_the_findings(
    fields: dict[str, object], expected: Verdict
) -> None:
    claim = Claim(key="k", title="t", place="p", derived="d", **fields)  # type: ignore[arg-type]
    assert claim.verdict is expected


@pytest.mark.parametrize(
    "fields",
    [
        {},
        {"checks": (FALSE,)},
        {"printed": "p", "checks": (TRUE,)},
        {"printed": "p", "of_print": (TRUE,), "sharper": (FALSE,)},
        {"printed": "p", "of_print": (FALSE,), "with_added": (FALSE,), "added": ("h",)},
        {"printed": "p", "of_print": (FALSE,), "with_added": (TRUE,)},
        {"printed": "p", "of_print": (FALSE,), "compatible": (FALSE,)},
        {"printed": "p", "of_print": (TRUE,), "with_added": (TRUE,), "added": ("h",)},
    ],
)
def test_findings_that_do_not_add_up_are_refused(fields: dict[str, object]) -> None:
    with pytest.raises(DerivationError, match="k: "):
        Claim(key="k", title="t", place="p", derived="d", **fields)  # type: ignore[arg-type]


def test_the_report_folder_is_where_the_project_keeps_reports() -> None:
    assert Path("reports") / "derivations" == report.FOLDER.relative_to(generate.ROOT)
