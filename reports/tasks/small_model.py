"""The model of the small part whose tips adhere: ``python -m reports.tasks.small_model --out FILE``.

Fitted by `identify` to the simulated recordings of ``small_recordings``, with the pull as a parameter
beside ρ and μ and the range of the meniscus held.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import cast

import pytest

from meso_robust import __version__
from meso_robust.files import write_all
from meso_robust.identification.answer import document
from meso_robust.identification.identify import identify
from meso_robust.identification.models import MODELS, viscous, with_effects
from meso_robust.toml_files import toml_of
from reports.tasks.small_recordings import RANGE_UM, recordings

NAME = "viscous+tip_adhesion"
HEAD = """\
# The 300 um part of small.toml with tips that adhere: rho, mu and the pull of one tip over the film's
# drag, with 90 % intervals. Fitted to simulated recordings, in which mu is 0.33 and a meniscus pulls at
# 3 um/s until the tip is 2 um away (the interval is 1 % short of that: steps of the simulated fit).
# A whole meniscus of oil would pull a few hundred times as hard (R. S. Fearing 1995,
# doi:10.1109/IROS.1995.526162); a tip wetted by the film's own oil may hold so little.
"""


def main() -> None:
    """Fit and write."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, required=True, help="the file")
    out = parser.parse_args().out
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(
            cast("dict[str, object]", MODELS),
            NAME,
            lambda outline: with_effects(
                viscous(outline),
                {"tip_adhesion": {"pull_um_s": 2.0}},
                {"tip_adhesion": {"range_um": RANGE_UM}},
            ),
        )
        found = identify(recordings(), model=NAME, starts=10)
    answer = document(recordings(), found, __version__, ())
    write_all(out.parent, {out.name: HEAD + toml_of(answer)})


if __name__ == "__main__":
    main()
