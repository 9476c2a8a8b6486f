"""Runs that break a claim, made small and written down so that anybody can run them again."""

from __future__ import annotations

import numpy as np

from meso_robust.campaigns.falsify.minimising import minimal
from meso_robust.campaigns.falsify.ready import Ready
from meso_robust.campaigns.kind import MOST_FAILURES, Failure
from meso_robust.laboratory.claim_ids import Claim
from meso_robust.laboratory.judging import Judged, judge
from meso_robust.laboratory.replay import Column, nominal_row
from meso_robust.laboratory.witness_file import replay_files
from meso_robust.types import Flags, Floats

UNITS = (("_m2", 1e12, "um2"), ("_m", 1e6, "um"), ("_rad", 180.0 / np.pi, "deg"))


def failures(ready: Ready, judged: Judged, rows: Floats, how: str) -> tuple[Failure, ...]:
    """The first rows that break a claim, one for each claim before a second for any.

    Parameters
    ----------
    ready
        Plan and claims.
    judged, rows
        Runs, and the rows (N, D) they were made from.
    how
        What found them, in words.
    """
    hits = [
        (rank, claim, row)
        for claim, flags in judged.broken.items()
        for rank, row in enumerate(np.flatnonzero(flags)[:MOST_FAILURES])
    ]
    ranked = sorted(hits, key=lambda hit: (hit[0], hit[1].key, hit[2]))
    return tuple(_failure(ready, claim, rows[row], how) for _, claim, row in ranked[:MOST_FAILURES])


def _failure(ready: Ready, claim: Claim, row: Floats, how: str) -> Failure:
    small = smallest(ready, claim, row)
    engine, factor = ready.player.engine, ready.plan.factor
    return Failure(
        what=claim.words,
        detail=f"{claim.words}: broken at {_told(ready, small)}; found by {how}, {engine}, all "
        f"uncertainties times {factor:g}",
        files=replay_files(
            ready.plan.task,
            ready.plan.plan,
            ready.player,
            small,
            factor=factor,
            engine=engine,
            breaks=(claim.words,),
        ),
    )


def smallest(ready: Ready, claim: Claim, row: Floats) -> Floats:
    """(D,) the row made minimal for one claim; the row itself if that does not fail by itself.

    The steps of a batch depend on its longest travel, so a stepped run by itself may differ in the
    last digits.
    """

    def breaks(rows: Floats) -> Flags:
        return judge(ready.player, ready.claims, rows).broken[claim]

    small = minimal(row, nominal_row(ready.player)[0], breaks)
    return small if breaks(small[None])[0] else row


def _told(ready: Ready, row: Floats) -> str:
    off = [
        _coordinate(column, float(value))
        for column, value in zip(ready.player.columns, row, strict=True)
        if value != column.mid
    ]
    return f"{', '.join(off)}, all else at its middle" if off else "the middle of everything"


def _coordinate(column: Column, value: float) -> str:
    for ending, scale, unit in UNITS:
        if column.name.endswith(ending):
            return f"{column.name.removesuffix(ending)} {value * scale:.6g} {unit}"
    return f"{column.name} {value:.6g}"
