"""The experiment by itself, with one effect or none concealed: ``python -m reports.live.experiments [--again NAME ...]``.

Continues where it was stopped: pushes that were recorded are not made again, answers that are kept are not asked again.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import sys
import time
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from meso_robust.api.explore import Explored, explored
from meso_robust.api.identify import EITHER_SIDE
from meso_robust.api.run import JOURNAL, Ran, run
from meso_robust.diagnosis.document import DiagnosisDocument
from meso_robust.files import write_all
from meso_robust.identification.experiment import Bench, standard_tests
from meso_robust.identification.experiment_document import EXPERIMENT_FILE, experiment_files
from meso_robust.live.designed import Designed, read_experiment
from meso_robust.live.exchange import Command
from meso_robust.live.journal import read_journal, replayed
from meso_robust.live.lab_file import VirtualSection
from meso_robust.live.run_document import run_document
from meso_robust.live.virtual_bench import lab_of
from meso_robust.recordings import Rectangle
from meso_robust.reporting.diagnosis_words import effect_words
from meso_robust.task import load_task
from meso_robust.tasks import MICROSCOPE
from meso_robust.toml_files import toml_of

OUT = Path(__file__).parent
RESULTS, PAGE = "experiments.json", "experiments.md"
SEED, RATE = 5, 12.0
"""Of the virtual laboratory: what it draws, and frames a second."""
NOTHING = "nothing"
CONCEALED: Mapping[str, Mapping[str, float]] = {
    NOTHING: {},
    "dry_friction": {"ratio": 0.15},
    "camera_latency": {"time_ms": 60.0},
    "camera_rotation": {"angle_deg": 0.6},
    "camera_scale": {"percent": 1.0},
    "tip_radius": {"excess_um": 6.0},
    "anisotropic_drag": {"fraction": 0.08, "direction_deg": 30.0},
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Answer:
    """What an experiment came to."""

    concealed: str
    values: dict[str, float]
    verdict: str
    """Of the diagnosis; empty if it was not reached."""
    told: list[str]
    """Names of the effects that it answers with."""
    words: list[str]
    """The same with their intervals."""
    before_um: float | None
    """Error of the plain model on recordings held out."""
    after_um: float | None
    """Likewise with the effects."""
    planned: str
    """Verdict of the plan; empty if it was not reached."""
    margin: float | None
    advice: str
    """What to do next where nothing is proved."""
    pushes_s: float
    """On the laboratory's clock."""
    processor_s: float
    """From the recordings to the plan."""
    set_right: str = ""
    """What is put right in the laboratory's file that the plan is for; empty if it is for the one that was."""

    @property
    def right(self) -> bool:
        """Whether what was concealed is told, and nothing else; or nothing where nothing was."""
        if self.concealed == NOTHING:
            return self.verdict == "consistent"
        return self.verdict in ("named", "partial") and self.told == [self.concealed]


def laid_out(name: str, folder: Path) -> None:
    """Write ``experiment.json`` and ``lab.toml`` of a case.

    Parameters
    ----------
    name
        What is concealed, of `CONCEALED`.
    folder
        Where to.
    """
    task = load_task(MICROSCOPE)
    part = Rectangle(length=1616e-6, width=837e-6)
    bench = Bench(speed=1e-6 * task.probe.speed_um_s, rates=EITHER_SIDE, trials=1)
    files = experiment_files(standard_tests(part, bench))
    effects = {} if name == NOTHING else {name: CONCEALED[name]}
    virtual = VirtualSection(seed=SEED, frame_rate_hz=RATE, effects=effects)
    lab = toml_of(lab_of(task, "-x", virtual))
    write_all(folder, {EXPERIMENT_FILE: files[EXPERIMENT_FILE], "lab.toml": lab})


def pushed(folder: Path) -> Ran:
    """The pushes of a case, made or, where its journal is whole, read again.

    Parameters
    ----------
    folder
        With what `laid_out` wrote.
    """
    experiment, journal = folder / EXPERIMENT_FILE, folder / JOURNAL
    if journal.exists():
        header, turns = read_journal(journal)
        designed = Designed(read_experiment(experiment), header.lab)
        same = header.plan_hash == hashlib.sha256(experiment.read_bytes()).hexdigest()
        if same and replayed(header, turns, designed.answer) is None:
            return Ran(
                document=run_document(header, turns, Command(**turns[-1].commands[-1]), []),
                header=header,
                turns=turns,
                task=load_task(MICROSCOPE),
                names=tuple(designed.files),
            )
    made: Ran = run(
        MICROSCOPE, experiment, lab=folder / "lab.toml", video=False, folder=folder, seed=SEED
    )
    return made


def answer_of(name: str, found: Explored, processor_s: float) -> Answer:
    """What is kept of an experiment.

    Parameters
    ----------
    name
        What was concealed.
    found
        What it came to.
    processor_s
        What that took.
    """
    said: DiagnosisDocument | None = found.diagnosed.document if found.diagnosed else None
    planned = found.planned
    proved = planned is not None and planned.positive
    return Answer(
        concealed=name,
        values=dict(CONCEALED[name]),
        verdict=said.verdict if said else "",
        told=[one.name for one in said.effects] if said else [],
        words=[effect_words(one) for one in said.effects] if said else [],
        before_um=said.held_out.baseline_um if said else None,
        after_um=said.held_out.extended_um if said else None,
        planned=planned.verdict if planned else "",
        margin=planned.certificate.margin.factor if planned and proved else None,
        advice=found.advice,
        pushes_s=found.ran.document.duration_s,
        processor_s=processor_s,
        set_right=found.set_right.words if found.set_right else "",
    )


def carried_on(names: Sequence[str], again: Sequence[str], work: Path, out: Path) -> list[Answer]:
    """Experiments, each written down as it ends.

    Parameters
    ----------
    names
        Of what is concealed.
    again
        Of those that are to be answered again.
    work, out
        For recordings and for results.
    """
    path = out / RESULTS
    kept = json.loads(path.read_text(encoding="utf-8")) if path.exists() else []
    done = {one["concealed"]: Answer(**one) for one in kept if one["concealed"] not in again}
    for name in names:
        if name in done:
            continue
        laid_out(name, work / name)
        ran = pushed(work / name)
        began = time.process_time()
        found = explored(MICROSCOPE, ran, work / name, 0)
        found.save(work / name / "results")
        done[name] = answer_of(name, found, time.process_time() - began)
        answers = [done[one] for one in CONCEALED if one in done]
        text = json.dumps([asdict(one) for one in answers], indent=1, ensure_ascii=False) + "\n"
        write_all(out, {RESULTS: text, PAGE: page(answers)})
        sys.stdout.write(f"== {name}\n{found}\n")
        sys.stdout.flush()
    return [done[one] for one in CONCEALED if one in done]


def page(answers: Sequence[Answer]) -> str:
    """The answers in Markdown.

    Parameters
    ----------
    answers
        In the order of their rows.
    """
    effects = [one for one in answers if one.concealed != NOTHING]
    right = [one for one in effects if one.right]
    proved = [one for one in answers if one.planned == "PROVED"]
    lines = [
        "# The experiment by itself in the virtual laboratory",
        "",
        "Written by `python -m reports.live.experiments`; see the [README](README.md).",
        "",
        f"Of {len(effects)} effects that were concealed, one at a time, {len(right)} are told, and nothing beside them. "
        f"{len(proved)} of {len(answers)} experiments end with a plan that is PROVED.",
        "",
        "| concealed | diagnosis | told | held-out error, µm | plan | pushes | s of a processor |",
        "|---|---|---|---|---|---:|---:|",
        *map(_row, answers),
        "",
        "Where nothing is proved:",
        "",
        *[f"- {_concealed(one)}: {one.advice}" for one in answers if one.planned != "PROVED"],
    ]
    return "\n".join(lines).rstrip() + "\n"


def _concealed(one: Answer) -> str:
    values = ", ".join(f"{key} {value:g}" for key, value in one.values.items())
    return f"`{one.concealed}` {values}" if values else one.concealed


def _row(one: Answer) -> str:
    errors = "–" if one.before_um is None else f"{one.before_um:.2f}"
    if one.told and one.after_um is not None:
        errors += f" → {one.after_um:.2f}"
    planned = one.planned or "–"
    if one.margin is not None:
        planned += f", margin {one.margin:.2f}"
    if one.set_right:
        planned += f", with {one.set_right}"
    cells = (
        _concealed(one),
        one.verdict or "–",
        "; ".join(one.words) or "–",
        errors,
        planned,
        f"{one.pushes_s:.0f} s",
        f"{one.processor_s:.0f}",
    )
    return f"| {' | '.join(cells)} |"


def main() -> int:
    """Run; exit status 1 if what was told is wrong."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", default=[*CONCEALED], metavar="NAME")
    parser.add_argument("--again", nargs="*", default=[], metavar="NAME")
    parser.add_argument("--work", type=Path, required=True, help="folder for the recordings")
    parser.add_argument("--out", type=Path, default=OUT)
    asked = parser.parse_args()
    answers = carried_on(asked.names, asked.again, asked.work, asked.out)
    wrong = [one for one in answers if one.verdict == "named" and not one.right]
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
