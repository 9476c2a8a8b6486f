"""What the diagnosis says of recordings of others: ``python -m reports.diagnosis.real_report --help``.

``--recordings`` names a folder with ``mit_plywood`` and ``cmu_two_finger``; their importers' notes tell where they
are from. The report holds derived results only.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Iterator, Sequence
from pathlib import Path

from meso_robust import __version__
from meso_robust.diagnosis.answer import document
from meso_robust.diagnosis.diagnose import diagnose
from meso_robust.diagnosis.document import DiagnosisDocument
from meso_robust.files import write_all
from meso_robust.recordings import RecordingSet
from meso_robust.recordings.importers import FORMATS

NO_OUTLINE = ("butter",)
"""Parts whose outline stands neither in the logs nor beside them."""
HEAD = """# What the diagnosis says of real recordings

Command: `python -m reports.diagnosis.real_report --recordings FOLDER --out reports/diagnosis/real.md{quick}`

Recordings of other laboratories, macroscopic and dry: a single kinematic pusher moves a part on an ellipsoidal
limit surface as on a film with ρ = (m_max/f_max)². Nothing was tuned to them. Their sensors' noise is neither stated
nor seen in still frames, so that errors are weighed by the fit's own residuals; the floor is the white part of
the poses' roughness. Held-out recordings are seen by no fit.

"""


def sets(folder: Path) -> Iterator[tuple[str, RecordingSet]]:
    """Names and recordings."""
    yield "mit_plywood", FORMATS["mcube_json"].read(folder / "mit_plywood").recordings
    for part in sorted((folder / "cmu_two_finger").iterdir()):
        if part.is_dir() and part.name.split("_")[0] not in NO_OUTLINE:
            yield f"cmu_two_finger/{part.name}", FORMATS["two_finger_log"].read(part).recordings


def section(name: str, found: DiagnosisDocument, count: int, seconds: float) -> str:
    """One set in Markdown."""
    held = found.held_out
    effects = "; ".join(
        f"{one.name} ("
        + ", ".join(
            f"{key} {of.value:.3g} [{of.low:.3g}, {of.high:.3g}]"
            for key, of in one.parameters.items()
        )
        + ")"
        for one in found.effects
    )
    rows = "".join(
        f"| {' + '.join(one.effects)} | {one.gain:.0f} | {one.rejected or 'none: it may be the answer'} |\n"
        for one in found.candidates[:6]
    )
    plain = ", ".join(
        f"{key} {of.value:.4g} [{of.low:.4g}, {of.high:.4g}]"
        for key, of in found.baseline.parameters.items()
    )
    return (
        f"## {name}\n\n{count} recordings, {len(held.recordings)} held out; {seconds:.0f} s.\n\n"
        f"**{found.verdict}** – {found.why}.\n\n"
        f"- plain model: {plain}\n"
        f"- explained part: {effects or 'none'}\n"
        f"- held-out error {held.baseline_um / 1e3:.2f} → {held.extended_um / 1e3:.2f} mm; in the fit's weights "
        f"{held.baseline_sigma:.2f} → {held.extended_sigma:.2f}, change "
        f"{100 * held.improvement_low:.0f} … {100 * held.improvement_high:.0f} % (90 %); floor "
        f"{held.noise_floor_sigma:.3f}\n"
        f"- could not be shown by these recordings: {', '.join(found.not_identifiable)}\n\n"
        f"| set | gain, nats | why not |\n|---|---:|---|\n{rows}\n"
    )


def main(arguments: Sequence[str] | None = None) -> None:
    """Diagnose every set and write the report."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--recordings", type=Path, required=True)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--quick", action="store_true", help="the quick form")
    options = parser.parse_args(arguments)
    text = HEAD.format(quick=" --quick" if options.quick else "")
    for name, recordings in sets(options.recordings):
        before = time.perf_counter()
        found = document(diagnose(recordings, quick=options.quick), __version__)
        seconds = time.perf_counter() - before
        text += section(name, found, len(recordings.recordings), seconds)
        sys.stderr.write(f"{name}: {found.verdict}, {seconds:.0f} s\n")
        write_all(options.out.parent, {options.out.name: text})


if __name__ == "__main__":
    main()
