"""Cases that come as films: ``python -m reports.blind3.filmed --help``.

Sets of the same kinds and laws as the others, drawn with another seed, but filmed (`film`) and tracked by
``track``; then diagnosed in the quick and in the full form.
"""

from __future__ import annotations

import argparse
import json
import math
import tempfile
from collections.abc import Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, replace
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np

import meso_robust
from meso_robust.recordings import Recording, write_set
from reports.blind3.answering import diagnosed
from reports.blind3.cases import HERE, Case, digest, listed, sealed, text_hash
from reports.blind3.film import PIXEL_UM, drawn_look, film
from reports.blind3.generate import (
    LENGTH,
    RADIUS,
    SUBSTEPS,
    WIDTH,
    Change,
    Floats,
    Push,
    World,
    pushes,
    small_wrongs,
)
from reports.blind3.laws import FAMILIES, OUTSIDE
from reports.blind3.score import Scored, results_text

OUT = HERE / "filmed"
SETS, COMMITMENT = OUT / "sets", OUT / "commitment.json"
COUNT, SEED = 100, 20261127
FORMS = ("quick", "full")
TRACKERS = ("pixel_locking",)
"""What a tracker does, and no camera: it is put into what was tracked."""

Values = Mapping[str, Any]


def cases() -> list[Case]:
    """The list; it shares no seed with the others."""
    return listed(COUNT, SEED)


def world_of(case: Case, label: Values) -> tuple[World, list[Push]]:
    """What is true of a case, and its pushes, with the sizes that were measured.

    Raises
    ------
    ValueError
        The label is not of this case.
    """
    rng = np.random.default_rng(case.seed)
    plan, wrongs = pushes(rng), small_wrongs(rng)
    mu, rho = float(rng.uniform(0.2, 0.4)), float(rng.uniform(430.0, 520.0))
    if (mu, rho, asdict(wrongs)) != (label["mu"], label["rho"], label["wrongs"]):
        raise ValueError(f"case {case.id}: the label is of another case")
    made = []
    for name, size in zip(case.families, label["sizes"], strict=True):
        shape = np.random.default_rng(int(rng.integers(2**31)))
        made.append({**FAMILIES, **OUTSIDE}[name].make(size, shape))
    return World(changes=tuple(made), wrongs=wrongs, mu=mu, rho=rho), plan


def tracked(case: Case, folder: Path) -> Values:
    """Film the pushes of a case, track them, and write the set; return what is true of it."""
    with tempfile.TemporaryDirectory() as place:
        label = sealed(case, Path(place) / "unused")
        whole, plan = world_of(case, label)
        named = list(zip(case.families, whole.changes, strict=True))
        world = replace(whole, changes=tuple(one for name, one in named if name not in TRACKERS))
        later = tuple(one for name, one in named if name in TRACKERS)
        rng = np.random.default_rng([SEED, case.id])
        look, found = drawn_look(world, rng), []
        for k, push in enumerate(plan):
            path = Path(place) / f"push_{k:02d}.avi"
            _filmed(path, (world, look), push, rng)
            seen = meso_robust.track(
                path,
                length_um=LENGTH,
                width_um=WIDTH,
                tip_radius_um=RADIUS,
                pixel_um=PIXEL_UM,
                start=(None, None, math.degrees(push.start[2])),
                commands=path.with_suffix(".csv"),
            )
            if seen.recordings is not None:
                found.append(seen.recordings)
        rows = tuple(_changed(one, later) for each in found for one in each.recordings)
        write_set(folder, replace(found[0], recordings=rows))
        lost = np.isnan(np.concatenate([one.poses[:, 0] for one in rows])).mean()
        how = {"noise": look.noise, "disc": look.disc, "tracked": len(rows), "lost": float(lost)}
        return {**label, **how}


def _filmed(path: Path, scene: tuple[World, Any], push: Push, rng: np.random.Generator) -> None:
    """Write a film and beside it what the controller logged; exposures jitter, stamps do not say so."""
    wrongs, frames = scene[0].wrongs, push.times[::SUBSTEPS]
    late = 1e-3 * wrongs.jitter_ms * rng.uniform(-1.0, 1.0, len(frames))
    late[0] = 0.0
    film(path, scene, push, frames + late, rng)
    tips = push.tips[::SUBSTEPS] + wrongs.tip_log_um * rng.normal(size=(len(frames), 2))
    _log(path.with_suffix(".csv"), np.column_stack([frames, tips]))


def _changed(seen: Recording, changes: tuple[Change, ...]) -> Recording:
    """A recording after what its tracker did to it."""
    poses = seen.poses * [1e6, 1e6, 1.0]
    for change in changes:
        poses = change.see(seen.times, poses) if change.see else poses
    return replace(seen, poses=poses * [1e-6, 1e-6, 1.0]) if changes else seen


def _log(path: Path, rows: Floats) -> None:
    text = "time_s,probe1_x_um,probe1_y_um\n"
    path.write_text(text + "".join(f"{t!r},{x!r},{y!r}\n" for t, x, y in rows.tolist()), "utf-8")


def generator_hash() -> str:
    """Hash of everything that the films follow from."""
    own = [HERE / name for name in ("generate.py", "laws.py", "cases.py", "film.py", "filmed.py")]
    return text_hash([*own, *sorted((HERE.parents[1] / "meso_robust" / "plant").glob("*.py"))])


def commit(wanted: Sequence[Case], workers: int) -> None:
    """Film and track, and promise the sets with what is true of them."""
    promised: dict[str, Any] = {"generator_sha256": generator_hash(), "sets": {}}
    if COMMITMENT.exists():
        before = json.loads(COMMITMENT.read_text(encoding="utf-8"))
        if before["generator_sha256"] != promised["generator_sha256"]:
            raise SystemExit(f"{COMMITMENT}: made with another generator")
        promised = before
    open_ = [case for case in wanted if f"{case.id:03d}" not in promised["sets"]]
    with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
        for case, label in zip(open_, pool.map(_made, open_), strict=True):
            key = f"{case.id:03d}"
            promised["sets"][key] = {"sha256": digest(SETS / key), **label}
            COMMITMENT.write_text(json.dumps(promised, indent=1) + "\n", encoding="utf-8")
            print(
                key,
                case.kind,
                *case.families,
                label["measured"],
                label["tracked"],
                f"{label['lost']:.2f}",
                flush=True,
            )


def _made(case: Case) -> Values:
    return tracked(case, SETS / f"{case.id:03d}")


def labels() -> Mapping[str, Values]:
    """What was promised, by the three digits of a case."""
    found: Mapping[str, Values] = json.loads(COMMITMENT.read_text(encoding="utf-8"))["sets"]
    return found


def answers(form: str) -> list[Values]:
    """The answers of a form so far."""
    path = OUT / f"{form}.jsonl"
    return (
        [json.loads(line) for line in path.read_text("utf-8").splitlines()] if path.exists() else []
    )


def run(wanted: Sequence[Case], form: str, workers: int) -> None:
    """Diagnose those that have no answer in this form, and append a line for each.

    Raises
    ------
    ValueError
        A file is another one than was promised.
    """
    promised, done = labels(), {one["id"] for one in answers(form)}
    open_ = [case for case in wanted if case.id not in done]
    for case in open_:
        if digest(SETS / f"{case.id:03d}") != promised[f"{case.id:03d}"]["sha256"]:
            raise ValueError(f"case {case.id}: a file differs from what {COMMITMENT.name} promises")
    folders = [SETS / f"{case.id:03d}" for case in open_]
    with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
        given = pool.map(partial(diagnosed, quick=form == "quick"), folders)
        for case, answer in zip(open_, given, strict=True):
            with (OUT / f"{form}.jsonl").open("a", encoding="utf-8") as file:
                file.write(json.dumps({"id": case.id, **answer}) + "\n")
            print(case.id, form, answer["verdict"], *answer.get("effects", ()), flush=True)


def page() -> str:
    """Results of both forms, and of the tracking, in Markdown."""
    promised, by_id = labels(), {case.id: case for case in cases()}
    parts = []
    for form in FORMS:
        scored = [
            Scored(case=by_id[one["id"]], label=promised[f"{one['id']:03d}"], answer=one)
            for one in sorted(answers(form), key=lambda one: int(one["id"]))
        ]
        if scored:
            parts.append(f"The {form} form.\n\n" + results_text(scored, frozenset()))
    return "\n".join(parts)


def main(arguments: Sequence[str] | None = None) -> None:
    """Commit to sets, diagnose them, or write the page."""
    parser = argparse.ArgumentParser(prog="python -m reports.blind3.filmed", description=__doc__)
    parser.add_argument("--cases", type=int, default=COUNT, help="the first N of the list")
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--commit", action="store_true", help="film, track and promise only")
    parser.add_argument("--form", choices=FORMS, action="append", help="both by default")
    parser.add_argument("--score", action="store_true", help="write results.md only")
    given = parser.parse_args(arguments)
    wanted = cases()[: given.cases]
    if given.commit:
        commit(wanted, given.workers)
        return
    for form in () if given.score else given.form or FORMS:
        run(wanted, form, given.workers)
    (OUT / "results.md").write_text(page(), encoding="utf-8")


if __name__ == "__main__":
    main()
