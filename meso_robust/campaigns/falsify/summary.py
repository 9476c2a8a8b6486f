"""What a part found, in a sentence and a few numbers."""

from __future__ import annotations

import functools
from decimal import ROUND_CEILING

from meso_robust.campaigns.falsify.ready import Ready, ready_of
from meso_robust.campaigns.falsify.totals import Totals, added
from meso_robust.campaigns.falsify.views import corners_met, highest, pooled, views
from meso_robust.campaigns.intervals import percent, share_interval
from meso_robust.campaigns.kind import Part, Told, Values, Verdict
from meso_robust.wording import do, up

Figures = tuple[tuple[str, str], ...]
Counts = dict[str, int]
"""Searches, their executions, and how many end in a broken claim."""

NOT_CERTIFIED = " Nothing is certified at {:g} times the uncertainty: only the motions and the goal were at stake."
NEAR = 0.9  # of a half width: what counts as brought near


def tell(part: Part, totals: Values) -> Told:
    """The totals as reported; see ``Kind.tell``."""
    ready = ready_of(part)
    each = (Totals(**one) for one in totals["draws"].values())
    drawn = functools.reduce(Totals.plus, each, Totals())
    searches: Counts = {}
    for one in totals["searches"].values():
        searches = added(searches, one)
    verdict = _verdict(ready, drawn, searches)
    return Told(
        verdict=verdict,
        answer=_answer(ready, totals, drawn, searches),
        figures=(
            *_counts(drawn, searches),
            *_nearest(ready, totals),
            *_likely(part, totals),
            *_covered(ready, drawn),
        ),
        views=views(ready, totals, drawn),
    )


def _verdict(ready: Ready, drawn: Totals, searches: Counts) -> Verdict:
    """``held`` only of what a certificate claims, ``broken`` only within the task's uncertainty.

    A run that the engine could not finish says nothing of the plan, so it leaves the answer open.
    """
    if drawn.failed or searches.get("failed", 0):
        return "broken" if ready.plan.factor <= 1.0 else "measured"
    if not ready.certified or not (drawn.runs or searches):
        return "measured"
    return "open" if drawn.unfinished + searches.get("unfinished", 0) else "held"


def _answer(ready: Ready, totals: Values, drawn: Totals, searches: Counts) -> str:
    count = searches.get("searches", 0)
    if not drawn.runs and not count:
        return "Nothing was executed to break a claim."
    executions = f"{drawn.runs:,} execution{'s' * (drawn.runs != 1)}"
    ends = f"{count:,} search{'es' * (count != 1)}"
    of_what = "" if ready.certified else NOT_CERTIFIED.format(ready.plan.factor)
    if drawn.failed or searches.get("failed", 0):
        names = [name for name, n in added(drawn.broken, totals["broken"]).items() if n]
        counts = [(drawn.failed, executions)] if drawn.runs else []
        counts += [(searches["failed"], ends)] if count else []
        told = " and ".join(f"{failed:,} of {of}" for failed, of in counts)
        subjects = sum(failed for failed, _ in counts) if len(counts) == 1 else len(counts)
        breaks = do(subjects, "break")
        return f"{told} {breaks} a claim: {', '.join(names)}.{of_what}"
    tried = f"{executions} and {ends}"
    unfinished = drawn.unfinished + searches.get("unfinished", 0)
    if unfinished:
        tried += f", {unfinished:,} of which the engine could not finish"
    near = highest(ready, totals)
    if not near:
        return f"No counterexample in {tried}.{of_what}"
    name, value = next(iter(near.items()))
    return (
        f"No counterexample in {tried}. The nearest came to {up(value, 6)} of the half width of "
        f"{name!r}.{of_what}"
    )


def _counts(drawn: Totals, searches: Counts) -> Figures:
    found = []
    if drawn.runs:
        found.append(("executions that break a claim", f"{drawn.failed:,} of {drawn.runs:,}"))
    if searches:
        found.append(
            (
                "searches that end in a broken claim",
                f"{searches['failed']:,} of {searches['searches']:,}",
            )
        )
        found.append(("executions of the searches", f"{searches['evaluations']:,}"))
    return tuple(found)


def _nearest(ready: Ready, totals: Values) -> Figures:
    near = highest(ready, totals)
    if not near:
        return ()
    above = sum(value >= NEAR for value in near.values())
    return (
        (
            f"sides of boxes brought to {NEAR:g} of the half width or beyond",
            f"{above} of {len(near)}",
        ),
    )


def _covered(ready: Ready, drawn: Totals) -> Figures:
    if not drawn.runs:
        return ()
    return (("corners of start, friction, film and misalignment met", corners_met(ready, drawn)),)


def _likely(part: Part, totals: Values) -> Figures:
    """What uniform draws, and splitting, say of the probability of a failure."""
    found = []
    uniform = Totals(**totals["draws"].get("uniform", {}))
    if uniform.runs:
        # the upper end of the two-sided interval of this confidence is the one-sided bound
        bound = share_interval(
            uniform.failed + uniform.unfinished, uniform.runs, 2.0 * part.confidence - 1.0
        )[1]
        found.append(
            (
                f"share of uniform draws that break a claim, {100 * part.confidence:g} % bound",
                f"at most {percent(bound, ROUND_CEILING)}",
            )
        )
    likely = {name: pooled(each) for name, each in totals["rare"].items()}
    if any(share for share, _ in likely.values()):
        name = max(likely, key=lambda one: likely[one][0])
        share, variation = likely[name]
        found.append(
            (
                f"most likely above its limit, by splitting: {name}",
                f"{share:.2e} (± {100.0 * variation:.0f} %)",
            )
        )
    return tuple(found)
