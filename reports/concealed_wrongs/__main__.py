"""Known wrongs concealed in real recordings: ``python -m reports.concealed_wrongs --help``.

``--recordings`` names a folder with ``mit_plywood`` and ``cmu_two_finger``, as for `reports.diagnosis.real_report`. Every
diagnosis is kept in the folder ``--work`` and not made again, so that a run continues where it was stopped.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from meso_robust.api.diagnose import diagnose
from meso_robust.errors import InputError
from meso_robust.files import write_all
from meso_robust.recordings import RecordingSet
from meso_robust.recordings.direct.document import direct_document
from meso_robust.recordings.importers import FORMATS
from reports.concealed_wrongs.wrongs import WRONGS, Wrong, mixed

NOTHING, MIXED = "nothing", "mixed"
BLOCK, RIDGE = "bigrect_3pts_30_50_60", "bigrect_ridge_30_50_60"
SETS = (f"cmu_two_finger/{BLOCK}", "mit_plywood", "cmu_two_finger/bigrect_3pts_20_neg30_90")
"""Two sets of the rig with two fingers, and the one with a single pusher."""
Kept = Mapping[str, Any]
Sizes = Mapping[str, Mapping[str, float]]


def read(folder: Path, name: str, every: int = 2) -> RecordingSet:
    """Every second recording of a set, as they come: a diagnosis of all takes twice as long."""
    kind = "two_finger_log" if name.startswith("cmu_two_finger") else "mcube_json"
    found = FORMATS[kind].read(folder / name).recordings
    return replace(found, recordings=found.recordings[::every])


def wrongs_of(folder: Path, name: str) -> dict[str, Wrong]:
    """What is concealed in a set; a second surface where the same part was pushed on another one."""
    found = dict(WRONGS)
    if name.endswith(BLOCK):
        other = read(folder, f"cmu_two_finger/{RIDGE}")
        found[MIXED] = Wrong(
            words="two supports mixed, recordings in turns: three points, and a ridge",
            change=mixed(other),
        )
    return found


def asked(found: RecordingSet, wrong: Wrong) -> Kept:
    """The document of the quick diagnosis of a set with a wrong, or the words of its refusal."""
    try:
        answer = diagnose(wrong.change(found), quick=True)
    except InputError as refusal:
        return {"refused": str(refusal)}
    tests = direct_document(answer.direct)["findings"] if answer.direct else []
    return {**json.loads(answer.text()), "direct": tests}


def main(arguments: Sequence[str] | None = None) -> None:
    """Diagnose every set with every wrong, and write the page."""
    parser = argparse.ArgumentParser(prog="python -m reports.concealed_wrongs", description=__doc__)
    parser.add_argument("--recordings", type=Path, required=True)
    parser.add_argument("--work", type=Path, required=True)
    parser.add_argument("--out", type=Path, default=Path(__file__).with_name("results.md"))
    parser.add_argument("--set", nargs="*", default=SETS, choices=SETS, dest="sets")
    parser.add_argument("--wrong", nargs="*", default=None, help="only these; by default all")
    given = parser.parse_args(arguments)
    sections = []
    for name in given.sets:
        if not (given.recordings / name).is_dir():
            sys.stderr.write(f"{given.recordings / name} is not here; left out\n")
            continue
        found, wrongs = read(given.recordings, name), wrongs_of(given.recordings, name)
        paths = {key: given.work / name.replace("/", "_") / f"{key}.json" for key in wrongs}
        for key in given.wrong or wrongs:
            if not paths[key].is_file():
                text = json.dumps(asked(found, wrongs[key]), indent=1)
                write_all(paths[key].parent, {paths[key].name: text})
                sys.stderr.write(f"{name}, {key}: diagnosed\n")
        answers = {
            key: json.loads(path.read_text(encoding="utf-8"))
            for key, path in paths.items()
            if path.is_file()
        }
        if NOTHING in answers:
            sections.append(section(name, found, wrongs, answers))
    if sections:
        write_all(given.out.parent, {given.out.name: HEAD + "\n".join(sections)})


HEAD = """# Known wrongs concealed in real recordings

Command: `python -m reports.concealed_wrongs --recordings FOLDER --work FOLDER`

Quick form, every second recording of a set. *Told*: effects of the answer, with their intervals. *Comes on top*: the number
that tells of the wrong, in the answer with it less that in the answer without it (nought where it is not told), by the
diagnosis and by the test that needs no simulation; in brackets what was concealed. *Explains*: share of the explainable
error, out of fold. *Held out*: errors of recordings that no fit has seen, of the plain model and with what is told.
*Left*: out of fold, all recordings; and its standard deviation over mean between pushes.

"""


def section(
    name: str, found: RecordingSet, wrongs: Mapping[str, Wrong], answers: Mapping[str, Kept]
) -> str:
    """One set in Markdown."""
    rows = "".join(
        row(wrongs[key], wrongs[key].sizes(found), answers[NOTHING], answer)
        for key, answer in answers.items()
    )
    return f"""## {name}, {len(found.recordings)} recordings

| concealed | verdict | told | comes on top: diagnosis | direct test | explains, % | held out, mm | left, mm and ° |
|---|---|---|---|---|---:|---:|---:|
{rows}"""


def row(wrong: Wrong, sizes: Sizes, before: Kept, after: Kept) -> str:
    """One wrong in the table."""
    if "refused" in after:
        cause = after["refused"].partition("likely cause: ")[2].partition(";")[0]
        words = f"likely cause: {cause}" if cause else after["refused"]
        right = "" if wrong.cause and wrong.cause == cause else ", which is not right"
        return f"| {wrong.words} | refused{right} | {words} | – | – | – | – | – |\n"
    told = "; ".join(
        f"{one['name']} "
        + ", ".join(f"{key} {_between(of)}" for key, of in one["parameters"].items())
        for one in after["effects"]
    )
    of_effects = [
        {one["name"]: one["parameters"] for one in answer["effects"]} for answer in (before, after)
    ]
    of_tests = [
        {one["effect"]: one["parameters"] for one in answer["direct"]} for answer in (before, after)
    ]
    share, left, held = after["explained"], after["remainder"], after["held_out"]
    explains = "–"
    if share is not None:
        explains = "{:.0f} [{:.0f}, {:.0f}]".format(*(100.0 * share[k] for k in _SHARE))
    cells = (
        wrong.words,
        after["verdict"],
        told or "–",
        on_top(sizes, *of_effects),
        on_top(sizes, *of_tests),
        explains,
        f"{held['baseline_um'] / 1e3:.2f} → {held['extended_um'] / 1e3:.2f}",
        f"{left['um'] / 1e3:.2f}, {left['deg']:.2f}; between pushes {left['spread_between_pushes']:.2f}",
    )
    return f"| {' | '.join(cells)} |\n"


def on_top(sizes: Sizes, before: Kept, after: Kept) -> str:
    """By how much the numbers that tell of a wrong differ, with intervals and what was concealed."""
    words = []
    for effect, keys in sizes.items():
        for key, concealed in keys.items():
            if key not in after.get(effect, {}):
                continue
            change = difference(before.get(effect, {}).get(key, _NOUGHT), after[effect][key])
            words.append(f"{effect} {_between(change)} ({concealed:.3g})")
    return "; ".join(words) or "–"


def difference(before: Kept, after: Kept) -> Kept:
    """Value and interval of a difference of two numbers with independent errors."""
    value = after["value"] - before["value"]
    ends = {
        side: value
        + sign * float(np.hypot(after[side] - after["value"], before[other] - before["value"]))
        for side, other, sign in (("low", "high", -1.0), ("high", "low", 1.0))
    }
    return {"value": value, **ends}


def _between(of: Kept) -> str:
    return f"{of['value']:.3g} [{of['low']:.3g}, {of['high']:.3g}]"


_NOUGHT = {"value": 0.0, "low": 0.0, "high": 0.0}
_SHARE = ("share", "low", "high")


if __name__ == "__main__":
    main(sys.argv[1:])
