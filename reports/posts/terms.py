"""How far barriers of a slide lie beyond what can be reached, by their terms: ``python -m reports.posts.terms``.

Plain numbers, no proof. A barrier is a curve for each value of the constants, and must rise as fast as the fastest motion at each of them.
Its terms are those that fit the fastest slides best. What it needs on top is what the worst of all constants asks
for at every instant, as in a proof whose bounds of the rates were exact.
"""

from __future__ import annotations

import argparse
import itertools
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from inspect import signature
from pathlib import Path

import numpy as np

from meso_robust.bounds import Interval
from meso_robust.conditions.formula import formula
from meso_robust.files import write_all
from meso_robust.motion.two_sided import MODULE, Grip, Start
from meso_robust.types import Floats
from reports.posts.__main__ import OUT
from reports.posts.causes import the_rotation, touched

NOW = ("rho", "stretch", "shear", "mu_D", "mu_S")
"""What may change at every instant."""
TAKE_ROOM = ("d_D", "d_S", "r_D", "r_S")
STEPS = 120
PAGE = "terms.md"


@dataclass(frozen=True, slots=True, kw_only=True)
class Slides:
    """Slides between two tips."""

    grip: Grip
    start: Start
    apart: Interval
    """Of the tips across the travel, m."""
    h_end: float

    @property
    def constants(self) -> dict[str, Interval]:
        """What is constant during a run, the tips' distance in place of the room between them."""
        found = {name: side for name, side in self.grip.constants().items() if name != "room"}
        return {"V": self.apart, **found, **self.start.labels}

    @property
    def knots(self) -> Floats:
        """From the middle of all places where both tips may touch first."""
        return np.linspace(self.start.h.mid, self.h_end, STEPS + 1)

    def drawn(self, count: int) -> Floats:
        """(N, constants) the middle, corners, corners where the room is least or most, and any; -1 to 1."""
        names, rng = list(self.constants), np.random.default_rng(0)
        corners = rng.choice([-1.0, 1.0], (count // 2, len(names)))
        room = [1.0 if name == "V" else -1.0 * (name in TAKE_ROOM) for name in names]
        for k, sign in enumerate(room):
            if sign:
                corners[: count // 8, k], corners[count // 8 : count // 4, k] = -sign, sign
        any_ = rng.uniform(-1.0, 1.0, (count // 2, len(names)))
        return np.vstack([np.zeros((1, len(names))), corners, any_])

    def begun(self, at: Mapping[str, Floats], side: int) -> Floats:
        """The slide at the first knot, as far on one side as it may be."""
        off = {name: at[name] - own.mid for name, own in self.constants.items()}
        off["room"] = off["V"] - sum(off[name] for name in TAKE_ROOM)
        start = self.start
        first = start.value + start.rate * (start.h.hi - start.h.mid)
        first += start.rest.hi if side > 0 else start.rest.lo
        return np.asarray(first + sum(slope * off[name] for name, slope in start.spread.items()))

    def fastest(self, h: float, q: Floats, at: Mapping[str, Floats], side: int) -> Floats:
        """dq/d(travel) of the motion that gains most (side = 1) or least, whatever friction and film are now."""
        box = self.grip.box()
        ends = np.array(list(itertools.product(*((box[name].lo, box[name].hi) for name in NOW)))).T
        known: dict[str, Floats | float] = {name: own[:, None] for name, own in at.items()}
        known |= {"h": h, "q": q[:, None], "bend": 0.0, **dict(zip(NOW, ends, strict=True))}
        known["room"] = known["V"] - sum(known[name] for name in TAKE_ROOM)

        def value(name: str) -> tuple[Floats, ...]:
            of = formula(MODULE, name)
            return of(np, *(known[key] for key in list(signature(of).parameters)[1:]))

        (known["W"],) = value("width")
        (known["clear"],) = value("clear")
        (known["T"],) = value("apart")
        known["V"] = known["clear"] + known["W"]
        known["c"], known["s"] = value("direction")
        at_D, at_S = value("stick_rates")

        def slipping(of_D: int, of_S: int) -> Floats:
            known["tau_D"], known["tau_S"] = of_D * known["mu_D"], of_S * known["mu_S"]
            known["total"] = known["tau_D"] + known["tau_S"]
            return value("corner")[0]

        low, high = np.minimum(at_D, at_S), np.maximum(at_D, at_S)
        rate = np.where(at_D < at_S, slipping(-1, 1), slipping(1, -1))
        rate = np.where(rate < low, np.minimum(slipping(1, 1), low), rate)
        rate = np.where(rate > high, np.maximum(slipping(-1, -1), high), rate)
        return np.asarray(side * (side * rate).max(axis=1))

    def followed(self, at: Mapping[str, Floats], side: int) -> Floats:
        """(K+1, N) the slides that gain most, at every knot."""
        found = [self.begun(at, side)]
        for first, last in itertools.pairwise(self.knots):
            step, q = first - last, found[-1]
            half = q + 0.5 * step * self.fastest(first, q, at, side)
            found.append(q + step * self.fastest(0.5 * (first + last), half, at, side))
        return np.array(found)

    def at(self, drawn: Floats) -> dict[str, Floats]:
        """Constants from shares."""
        return {
            name: own.mid + 0.5 * own.width * drawn[:, k]
            for k, (name, own) in enumerate(self.constants.items())
        }

    def lifted(self, terms: Floats, at: Mapping[str, Floats], side: int) -> float:
        """How far a barrier ends beyond its terms (K+1, N), lifted by what is missing at every instant, m."""
        off = 0.0
        knots = self.knots
        for k, (first, last) in enumerate(itertools.pairwise(knots)):
            amid = 0.5 * (terms[k] + terms[k + 1]) + side * off
            rate = self.fastest(0.5 * (first + last), amid, at, side)
            off += float((side * ((first - last) * rate - (terms[k + 1] - terms[k]))).max())
        return off


def by_terms(slides: Slides, count: int) -> Iterator[tuple[str, float, float]]:
    """Terms, and how far barriers that have them end beyond the slides: the lower one, the upper one, m.

    Parameters
    ----------
    slides
        What is known.
    count
        How many values of the constants are tried.

    Yields
    ------
    tuple[str, float, float]
        Of the constants known exactly it would be nought.
    """
    drawn = slides.drawn(count)
    at = slides.at(drawn)
    pairs = itertools.combinations_with_replacement(range(drawn.shape[1]), 2)
    linear = np.hstack([np.ones((len(drawn), 1)), drawn])
    second = np.hstack([linear, *(drawn[:, [i]] * drawn[:, [j]] for i, j in pairs)])
    reached = {side: slides.followed(at, side) for side in (-1, 1)}
    for name, powers in (("linear", linear), ("and of second order", second)):
        off = []
        for side, found in reached.items():
            fit = np.linalg.lstsq(powers, found.T, rcond=None)[0]
            terms = (powers @ fit).T
            # to begin with it holds all
            terms = terms + side * (side * (found[0] - terms[0])).max()
            off.append(slides.lifted(terms, at, side))
        yield name, off[0], off[1]


def main() -> int:
    """Measure and write."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--constants", type=int, default=1600, help="values that are tried")
    parser.add_argument("--out", type=Path, default=OUT)
    asked = parser.parse_args()
    move, touch = touched(*the_rotation())
    slides = Slides(grip=move.grip, start=touch.start, apart=move.V, h_end=move.h_end.lo)
    lines = [
        "# How far barriers lie beyond what can be reached",
        "",
        "Written by `python -m reports.posts.terms`; see the [README](README.md).",
        "",
        "| terms in the constants | the lower one ends beyond the slides by (um) | the upper one |",
        "|---|---|---|",
        *(
            f"| {name} | {1e6 * below:.1f} | {1e6 * above:.1f} |"
            for name, below, above in by_terms(slides, asked.constants)
        ),
    ]
    write_all(asked.out, {PAGE: "\n".join(lines) + "\n"})
    return 0


if __name__ == "__main__":
    sys.exit(main())
