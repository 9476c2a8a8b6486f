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

from meso_robust.api.diagnose import diagnose
from meso_robust.copies import allow
from meso_robust.diagnosis.document import DiagnosisDocument
from meso_robust.files import write_all
from meso_robust.recordings import RecordingSet
from meso_robust.recordings.importers import FORMATS
from meso_robust.reporting.diagnosis_words import answer, effect_words, parameters_words

NO_OUTLINE = ("butter",)
"""Parts whose outline stands neither in the logs nor beside them."""
HEAD = """# What the diagnosis says of real recordings

Command: `python -m reports.diagnosis.real_report --recordings FOLDER --out reports/diagnosis/real.md{quick}`

Recordings of other laboratories, macroscopic and dry: a single kinematic pusher, or two tips, move a part on an
ellipsoidal limit surface as on a film with ρ = (m_max/f_max)². Nothing was tuned to them. *Explains*: share of the
explainable error, out of fold, with its 90 % interval. *Out of fold*: root mean square errors of all recordings, each
predicted from rest by a fit to the other folds, beyond what free hidden inputs leave: of the plain model (place or the
turn of the farthest corner, whichever is larger), and with what is told (place; turn). *Held out*: whole errors of the few recordings that
the effects were chosen without.

| set | recordings | verdict | told | explains, % | out of fold, mm | held out, mm |
|---|---:|---|---|---:|---:|---:|
{rows}
"""


def sets(folder: Path) -> Iterator[tuple[str, RecordingSet]]:
    """Names and recordings."""
    yield "mit_plywood", FORMATS["mcube_json"].read(folder / "mit_plywood").recordings
    for part in sorted((folder / "cmu_two_finger").iterdir()):
        if part.is_dir() and part.name.split("_")[0] not in NO_OUTLINE:
            yield f"cmu_two_finger/{part.name}", FORMATS["two_finger_log"].read(part).recordings


def row(name: str, found: DiagnosisDocument, count: int) -> str:
    """One set in the table."""
    told = " + ".join(one.name for one in found.effects) or "–"
    share, left = found.explained, found.remainder
    held = f"{found.held_out.baseline_um / 1e3:.2f} → {found.held_out.extended_um / 1e3:.2f}"
    sure = (
        "–"
        if share is None
        else f"{_percent(share.share)} [{_percent(share.low)}, {_percent(share.high)}]"
    )
    before = found.explainable_um
    whole = "–" if before is None else f"{before / 1e3:.2f}"
    rest = "–" if left is None else f"{left.um / 1e3:.2f}; {left.deg:.2f}°"
    return f"| {name} | {count} | {found.verdict} | {told} | {sure} | {whole} → {rest} | {held} |"


def _percent(share: float) -> str:
    return f"{100.0 * share:.0f}"


def section(name: str, found: DiagnosisDocument, seconds: float) -> str:
    """One set in Markdown."""
    effects = "".join(f"- {effect_words(one)}\n" for one in found.effects)
    rows = "".join(
        f"| {' + '.join(one.effects)} | {one.gain:.0f} | {one.rejected or 'nothing against it'} |\n"
        for one in found.candidates[:6]
    )
    return (
        f"\n## {name}\n\n**{found.verdict}**: {answer(found)}.\n\n{found.why}. "
        f"{len(found.held_out.recordings)} recordings held out; {seconds:.0f} s.\n\n{effects}"
        f"- plain model: {parameters_words(found.baseline.parameters)}\n"
        f"- not to be told by these recordings: {', '.join(found.not_identifiable) or 'nothing'}\n\n"
        f"| set of effects | gain, nats | what speaks against it |\n|---|---:|---|\n{rows}"
    )


def main(arguments: Sequence[str] | None = None) -> None:
    """Diagnose every set and write the report."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--recordings", type=Path, required=True)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--quick", action="store_true", help="the quick form")
    options = parser.parse_args(arguments)
    allow()
    rows, sections = "", ""
    for name, recordings in sets(options.recordings):
        before = time.perf_counter()
        found = diagnose(recordings, quick=options.quick).document
        seconds = time.perf_counter() - before
        rows += row(name, found, len(recordings.recordings)) + "\n"
        sections += section(name, found, seconds)
        sys.stderr.write(f"{name}: {found.verdict}, {seconds:.0f} s\n")
        head = HEAD.format(quick=" --quick" if options.quick else "", rows=rows.rstrip("\n"))
        write_all(options.out.parent, {options.out.name: head + sections})


if __name__ == "__main__":
    main()
