"""The table of named boxes: ``python -m reports.basis.report --out reports/basis``."""

from __future__ import annotations

import argparse
import math
import time
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from meso_robust.basis import BasisProof, prove_basis
from meso_robust.basis.bulk import exclude_many, hold_many
from meso_robust.basis.layout import layout, others
from meso_robust.basis.problem import assemble
from meso_robust.bounds import Interval
from tests.basis.examples import Example, examples

BOXES = 5_000

TEXT = """# The basis certificate: named boxes

One complementarity basis (contact modes) proved over a whole box of poses and parameters, all other
modes excluded (paper, Section XI). Each widened box replaces the sides named beside it and must not
be proved. Box counts are those bounded for the basis and for the exclusion of all other modes; times
include setting up the equations, on one core.

| example | modes | proved box | verdict, unique | boxes | ms | widened side | verdict |
|---|---|---|---|---|---|---|---|
{rows}

Boxes a second, one core, boxes of a tenth of the named box's sides:

| example | basis | all other modes |
|---|---|---|
{speeds}

Command: `python -m reports.basis.report --out reports/basis`
"""


def shown(box: Mapping[str, Interval]) -> str:
    """A box for display, lengths in µm and angles in degrees."""
    return ", ".join(_side(name, side) for name, side in box.items())


def _side(name: str, side: Interval) -> str:
    factor, unit = 1.0, ""
    if name == "theta":
        factor, unit = 180.0 / math.pi, "°"
    elif name == "rho":
        factor, unit = 1e12, " µm²"
    elif max(abs(side.lo), abs(side.hi)) < 2e-3:
        factor, unit = 1e6, " µm"
    return f"{name} {factor * side.lo:.6g} … {factor * side.hi:.6g}{unit}"


def timed(e: Example, box: Mapping[str, Interval]) -> tuple[BasisProof, float]:
    """A proof and the seconds it took."""
    started = time.perf_counter()
    proof = prove_basis(e.part, e.contacts, e.support, e.modes, box)
    return proof, time.perf_counter() - started


def row(e: Example) -> str:
    """One line of the table."""
    proof, seconds = timed(e, e.box)
    wide, _ = timed(e, e.wide_box)
    modes = ", ".join(mode.name for mode in e.modes)
    return (
        f"| {e.name} | {modes} | {shown(e.box)} | {proof.verdict.word}, {proof.unique.word} | "
        f"{proof.boxes} + {proof.unique_boxes} | {1e3 * seconds:.0f} | {shown(e.wider)} | "
        f"{wide.verdict.word} |"
    )


def speed(e: Example) -> str:
    """Boxes a second of both kernels."""
    problem = assemble(e.part, e.contacts, e.support, e.box)
    width = problem.hi - problem.lo
    lo = problem.lo + 0.9 * width * np.random.default_rng(0).random((BOXES, len(width)))
    hi = np.minimum(lo + 0.1 * width, problem.hi)
    started = time.perf_counter()
    hold_many(problem, layout([e.modes], problem.movers), lo, hi)
    middle = time.perf_counter()
    exclude_many(problem, layout(others(e.modes), problem.movers), lo, hi)
    ended = time.perf_counter()
    return f"| {e.name} | {BOXES / (middle - started):,.0f} | {BOXES / (ended - middle):,.0f} |"


def main() -> None:
    """Write the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, required=True)
    out = parser.parse_args().out
    timed(examples()[0], examples()[0].box)  # compiled code is loaded once
    rows = "\n".join(row(e) for e in examples())
    speeds = "\n".join(speed(e) for e in (examples()[0], examples()[2], examples()[-3]))
    out.mkdir(parents=True, exist_ok=True)
    page = TEXT.format(rows=rows, speeds=speeds)
    (out / "examples.md").write_text(page, encoding="utf-8")


if __name__ == "__main__":
    main()
