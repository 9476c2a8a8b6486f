"""What the diagnosis says of sets from the foreign plant: ``python -m reports.foreign_sets --help``."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from meso_robust import __version__
from meso_robust.diagnosis.answer import document
from meso_robust.diagnosis.diagnose import diagnose
from meso_robust.diagnosis.document import DiagnosisDocument
from meso_robust.files import write_all
from reports.foreign_sets.generate import NONE, Concealed, Pushes, Wrongs, made

CASES: dict[str, tuple[Concealed, Wrongs]] = {
    "nothing": (Concealed(), NONE),
    "small wrongs only": (Concealed(), Wrongs()),
    "camera turned by 1.5°": (Concealed(camera_turn_deg=1.5), NONE),
    "camera turned by 1.5°, small wrongs": (Concealed(camera_turn_deg=1.5), Wrongs()),
    "camera scale + 1 %": (Concealed(camera_scale=0.01), NONE),
    "part 12 µm wider": (Concealed(wider_um=12.0), NONE),
    "camera 120 ms late, small wrongs": (Concealed(latency_ms=120.0), Wrongs()),
    "drag ± 15 % at 20°, small wrongs": (Concealed(anisotropy=0.15), Wrongs()),
    "camera 9, −6 µm beside the robot, small wrongs": (Concealed(shift_um=(9.0, -6.0)), Wrongs()),
    "x axis with 10 µm of play, small wrongs": (Concealed(play_x_um=10.0), Wrongs()),
    "one edge with half the friction, small wrongs": (Concealed(edge_friction=-0.5), Wrongs()),
    "drag ± 15 % at 20°, camera turned by 0.6°, small wrongs": (
        Concealed(anisotropy=0.15, camera_turn_deg=0.6),
        Wrongs(),
    ),
}
HEAD = """| concealed | verdict | effects | explains, % | left, µm and ° |
|---|---|---|---:|---:|
"""


def row(name: str, found: DiagnosisDocument) -> str:
    """One set in Markdown."""
    effects = "; ".join(
        f"{one.name} "
        + ", ".join(
            f"{key} {of.value:.3g} [{of.low:.3g}, {of.high:.3g}]"
            for key, of in one.parameters.items()
        )
        for one in found.effects
    )
    share = "–"
    if found.explained is not None:
        share = f"{100 * found.explained.share:.0f} [{100 * found.explained.low:.0f}, {100 * found.explained.high:.0f}]"
    left = found.remainder
    size = "–" if left is None else f"{left.um:.2f}, {left.deg:.3f}"
    return f"| {name} | {found.verdict} | {effects or '–'} | {share} | {size} |\n"


def main(arguments: Sequence[str] | None = None) -> None:
    """Diagnose every set and write the table."""
    parser = argparse.ArgumentParser(prog="python -m reports.foreign_sets", description=__doc__)
    parser.add_argument("--out", type=Path, default=Path(__file__).with_name("results.md"))
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args(arguments)
    text = HEAD
    for name, (concealed, wrongs) in CASES.items():
        found = document(
            diagnose(made(given.seed, concealed, wrongs, Pushes()), quick=True), __version__
        )
        text += row(name, found)
        print(row(name, found), end="", flush=True)
        write_all(given.out.parent, {given.out.name: text})


if __name__ == "__main__":
    main(sys.argv[1:])
