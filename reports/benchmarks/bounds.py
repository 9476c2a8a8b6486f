"""Speed of the bounds beside their peers: ``python -m reports.benchmarks.bounds [--out FILE]``.

Every engine gets the same inequality: the ratio of normal to tangential force of eq. (5) is larger
than 3.3581 on a box of +-2 %, where its least value is 3.358117. Prints Markdown and asserts nothing.
Peers that are not installed are left out and named; ``make benchmark`` installs them.
"""

import argparse
import os
import platform
from collections.abc import Callable
from pathlib import Path

import casadi as ca
import numpy as np

from meso_robust.bounds import Bounded, bounded, enclose_many, prove_positive
from meso_robust.conditions.formula import formula
from reports.benchmarks.bounds_peers import PEERS, Peer, missing, versions
from reports.benchmarks.ratio import BOX, LEAST, NAMES, THRESHOLD, random_boxes
from reports.benchmarks.timing import best_of, number, reached, table

MANY = 100_000
CALLS = 200


def ratio() -> Bounded:
    """lambda_n/lambda_t of the generated formula less a threshold."""
    x = ca.SX.sym("x", 5)
    d1, d2, rho, theta, least = ca.vertsplit(x)
    (stick,) = formula("one_point_sticking", "stick_ratio")(ca, theta, d1, d2, rho)
    return bounded("ratio", (*NAMES, "least"), ca.Function("ratio", [x], [-1 / stick - least]))


def _own_rows() -> tuple[list[tuple[str, ...]], list[tuple[str, ...]]]:
    of = ratio()
    low, high = random_boxes(MANY)
    lo = np.column_stack([low, np.full(MANY, THRESHOLD.lo)])
    hi = np.column_stack([high, np.full(MANY, THRESHOLD.hi)])
    natural = best_of(lambda: enclose_many(of, lo, hi, natural=True))
    full = best_of(lambda: enclose_many(of, lo, hi))
    box = {**dict(zip(NAMES, BOX, strict=True)), "least": THRESHOLD}

    def prove() -> None:
        for _ in range(CALLS):
            prove_positive(of, box)

    proof, clock = prove_positive(of, box), best_of(prove)
    millis = 1e3 * clock.cpu / CALLS
    rows = [
        _row("meso-robust, natural, in bulk", MANY / natural.cpu, None),
        _row(
            "meso-robust, natural + monotonicity + mean value",
            MANY / full.cpu,
            (proof.verdict.word, proof.boxes, millis),
        ),
    ]
    rate, target = MANY / natural.cpu, 1e7
    goals: list[tuple[str, ...]] = [
        ("evaluations of the eq. (5) ratio a second", number(rate), *reached(rate, target)),
        ("proof of ratio > 3.3581, ms", number(millis), *reached(millis, 0.05, most=True)),
    ]
    return rows, goals


def _row(name: str, rate: float | None, proof: tuple[str, int, float] | None) -> tuple[str, ...]:
    found = ("", "", "") if proof is None else (proof[0], str(proof[1]), number(proof[2]))
    return (name, "" if rate is None else number(rate), *found)


def _peer_row(peer: Peer) -> tuple[str, ...]:
    evaluate: Callable[[], object] | None = peer.evaluate
    rate = None if evaluate is None else peer.count / best_of(evaluate, 3).cpu
    if peer.prove is None:
        return _row(peer.name, rate, None)
    word, boxes = peer.prove()
    return _row(peer.name, rate, (word, boxes, 1e3 * best_of(peer.prove, 3).cpu))


def report() -> list[str]:
    """Lines of the report."""
    own, goals = _own_rows()
    rows = own + [_peer_row(make()) for make in PEERS if missing(make) is None]
    absent = sorted(name for name in map(missing, PEERS) if name)
    ends = ", ".join(
        f"{n} in [{_short(b.lo)}, {_short(b.hi)}]" for n, b in zip(NAMES, BOX, strict=True)
    )
    lines = [
        "# Speed of the bounds",
        "",
        f"{platform.machine()}, {os.cpu_count()} cores, Python {platform.python_version()}; "
        f"{', '.join(versions())}. One thread, CPU time, best of several. Made by `make benchmark`.",
        "",
        f"Inequality: lambda_n/lambda_t > 3.3581 for {ends} (mm, mm², rad). The least value is "
        f"{LEAST}. The engines without gradients bisect the widest side (relative to the box) and "
        "use the natural extension.",
        "",
    ]
    heads = ("engine", "evaluations/s", "verdict", "boxes", "ms a proof")
    lines += table("The same inequality by every engine", heads, rows)
    lines += table("Targets", ("CPU time of one core", "value", "target", "reached"), goals)
    lines += [
        "The NumPy engine trusts the system's sine and cosine to one unit in the last place; the "
        "others promise every digit of their enclosures. z3 replaces sine and cosine by the circle "
        "and a rational range of the cosine, rounded outward.",
        "",
    ]
    if absent:
        lines += [f"Not installed, so not timed: {', '.join(absent)}.", ""]
    return lines


def _short(value: float) -> str:
    return f"{value:.5g}"


def main() -> None:
    """Print the report, and write it to a file if one is named."""
    parser = argparse.ArgumentParser(
        prog="python -m reports.benchmarks.bounds", description=__doc__
    )
    parser.add_argument("--out", type=Path, help="file to write the report to")
    chosen = parser.parse_args()
    text = "\n".join(report())
    print(text)
    if chosen.out is not None:
        chosen.out.parent.mkdir(parents=True, exist_ok=True)
        chosen.out.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
