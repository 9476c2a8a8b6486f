"""What recordings of others show: ``python -m reports.identification.real_report --help``.

``--recordings`` names a folder with ``mit_plywood``, ``cmu_two_finger`` and ``cmu_support_points``; their
importers' notes tell where they are from. The report holds derived results only.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from meso_robust.files import write_all
from reports.identification.real.push_tables import plywood, two_fingers
from reports.identification.real.support_tables import support_points_text

TEXT = """# What real recordings show

Command: `python -m reports.identification.real_report --recordings FOLDER --out reports/identification/real.md
--draws {draws} --starts {starts}`

Recordings of other laboratories, macroscopic and dry, read by `meso_robust.recordings.importers`. The model
is fitted by robust least squares (soft L1) of pose errors, θ times the part's characteristic length, every
push counting alike. Intervals in brackets are 5 % to 95 % over pushes drawn with replacement: they hold
what differs from push to push, not what is wrong with all. "Unseen" errors are of pushes that the fit had
not seen. Errors are root mean squares over the frames of a push, then over pushes.

{plywood}
{fingers}
{supports}"""


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure everything and write the report."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--recordings", type=Path, required=True)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--draws", type=int, default=24, help="refits to pushes drawn again")
    parser.add_argument("--starts", type=int, default=5, help="searches for support points")
    options = parser.parse_args(arguments)
    options.out.parent.mkdir(parents=True, exist_ok=True)
    text = TEXT.format(
        draws=options.draws,
        starts=options.starts,
        plywood=plywood(options.recordings / "mit_plywood", options.draws),
        fingers=two_fingers(options.recordings / "cmu_two_finger", options.draws),
        supports=support_points_text(
            options.recordings / "cmu_support_points", options.out, options.draws, options.starts
        ),
    )
    write_all(options.out.parent, {options.out.name: text})


if __name__ == "__main__":
    main()
