"""Outward-rounded bounds and verdicts over boxes."""

from meso_robust.bounds.branch import decide_many as decide_many
from meso_robust.bounds.bulk import (
    Bounded as Bounded,
    bounded as bounded,
    enclose_many as enclose_many,
)
from meso_robust.bounds.curved import (
    Curved as Curved,
    curved as curved,
    enclose_where as enclose_where,
)
from meso_robust.bounds.interval import HALF_PI as HALF_PI, Interval as Interval
from meso_robust.bounds.prove import (
    Box as Box,
    Proof as Proof,
    Verdict as Verdict,
    VerdictWord as VerdictWord,
    enclose as enclose,
    enclose_rows as enclose_rows,
    prove_positive as prove_positive,
)
