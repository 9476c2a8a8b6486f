"""Part of the report on pushes of a triangle that stood on known points."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from meso_robust.identification.models import three_point
from meso_robust.recordings import RecordingSet
from meso_robust.recordings.importers import FORMATS
from meso_robust.recordings.importers.support_point_log import PART, support_points
from reports.identification.real.drawing import draw_supports
from reports.identification.real.fitting import BOOTSTRAP
from reports.identification.real.supports import (
    POINTS,
    Candidate,
    Recovered,
    problem_of,
    recovered,
    usable,
)
from reports.identification.real.wrenches import (
    Pairs,
    apart,
    friction_at,
    matched,
    ordered,
    pairs_of,
    points_by_forces,
)

F = npt.NDArray[np.float64]

LENGTH = 0.05 * np.sqrt(2.0)
"""By which torques are divided, m: distance of the right angle from the centre."""
DRAWS = 300  # of pushes, for the linear fits
SEARCHES = 12  # for points by forces
REFITS = 20  # of points by forces to pushes drawn again


@dataclass(frozen=True, slots=True)
class Logs:
    """Logs that were made under one arrangement: folder, beginning of the files, board, total friction.

    The total friction in N is what the laboratory measured apart from the pushes.
    """

    folder: str
    prefix: str
    board: str
    friction: float


ALL = (
    Logs("wood_30_90_30_30_30_90", "", "wood", 5.0),
    Logs("30_90_30_30_30_90", "exp_08_11_30", "hard board, 11 August, second log", 4.2),
    Logs("30_90_30_30_30_90", "exp08_11_20", "hard board, 11 August, first log", 4.2),
    Logs("30_90_30_30_30_90", "exp8_35", "hard board, 8 August", 4.2),
    Logs("30_90_30_30_30_90", "exp9_15", "hard board, 10 August", 4.2),
    Logs("30_90_30_30_30_90", "exp3_30", "hard board, 6 August, 15 mm/s", 4.2),
    Logs("patch", "", "hard board, whole face", 4.2),
)
BY_MOTION = (0, 1, 3, 6)
"""Of these also the motion alone is fitted."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Found:
    """Everything measured of some logs."""

    logs: Logs
    points: F  # known, or those of the other folders for the whole face
    known: F | None
    wrong: int
    pairs: Pairs
    friction: F
    explained: float
    redrawn: F
    forces: F
    forces_spread: F


def support_points_text(folder: Path, out: Path, draws: int, starts: int) -> str:
    """Fit everything, draw it beside the report, and tell."""
    found = [_by_forces(folder, logs) for logs in ALL]
    moved = {k: _by_motion(folder, ALL[k], draws, starts) for k in BY_MOTION}
    pictures = [_picture(out, found[k], moved[k]) for k in BY_MOTION]
    return (
        "## A triangle on known support points, pushed at one point (CMU)\n\n"
        "Legs 150 mm, 1.518 kg, a pose before and one after each push of about 10 mm, forces. Known: "
        f"{_places(_arranged(support_points(ALL[0].folder)))} mm about the centre of mass, each with a "
        "third of the weight. A push whose tip ends more than 20 mm off the part is left out, its last "
        "pose cannot be right.\n\n"
        "### By the forces, points known: friction of each and its centre\n\n"
        "Least squares of wrench and twist, linear in the friction of each point. The centre of "
        "friction belongs at (0, 0). (For the whole face the three points are a stand-in.)\n\n"
        "| logs | pushes | left out | friction N | measured apart N | centre x, y mm | explained |\n"
        "|---|---|---|---|---|---|---|\n"
        + "".join(map(_friction_row, found))
        + "\n### Points not known: recovered beside known\n\n"
        "Points in mm; *away*: root mean square distance from the known ones. By forces the loads follow "
        "from statics; by motion alone only the two poses of each push are used, with µ_t and the offset "
        "of the reference point fitted besides. *Hold*: of the six intervals of the coordinates, those "
        f"that hold the known value. Three points at random are {_at_random():.0f} mm away (median).\n\n"
        "| logs | by | points | away mm | hold |\n|---|---|---|---|---|\n"
        + "".join(map(_forces_row, found))
        + "".join(_motion_row(found[k], moved[k]) for k in BY_MOTION)
        + "\n"
        + "\n\n".join(pictures)
        + "\n\n### Other explanations by motion\n\n"
        "Minima from random starts, and the known points. *Worse*: mean loss of a push above that of the "
        "best minimum, as a share of it; an interval that reaches zero means that these pushes cannot "
        "tell the two apart. *Film*: an ellipsoidal limit surface, √ρ in place of the points.\n\n"
        "| logs | points | away mm | worse |\n|---|---|---|---|\n"
        + "".join(_other_rows(ALL[k], moved[k]) for k in BY_MOTION)
        + _verdict(found, moved)
    )


def _read(folder: Path, logs: Logs) -> RecordingSet:
    return FORMATS["support_point_log"].read(folder / logs.folder).recordings


def _by_forces(folder: Path, logs: Logs) -> Found:
    recordings = _read(folder, logs)
    _, wrong = usable(recordings, logs.prefix)
    pairs = pairs_of(recordings, LENGTH)
    rows = [
        k
        for k, file in enumerate(pairs.files)
        if file.startswith(logs.prefix) and file not in wrong
    ]
    pairs = pairs.of(np.array(rows))
    known = support_points(logs.folder)
    points = _arranged(known)
    friction, explained = friction_at(points, pairs)
    rng = np.random.default_rng(0)
    drawn = [pairs.of(rng.integers(len(rows), size=len(rows))) for _ in range(DRAWS)]
    model = three_point(recordings.part.outline)
    starts = model.draw(rng, SEARCHES)[:, POINTS].reshape(-1, 3, 2)
    best = points_by_forces(pairs, starts, PART.corners).points
    again = [points_by_forces(draw, best[None], PART.corners).points for draw in drawn[:REFITS]]
    return Found(
        logs=logs,
        points=points,
        known=known,
        wrong=len(wrong),
        pairs=pairs,
        friction=friction,
        explained=explained,
        redrawn=np.array([_total_and_centre(points, friction_at(points, d)[0]) for d in drawn]),
        forces=best,
        forces_spread=np.array(again),
    )


def _total_and_centre(points: F, friction: F) -> F:
    """(3,) total in N, and centre x, y in m."""
    return np.append(friction.sum(), friction @ points / friction.sum())


def _by_motion(folder: Path, logs: Logs, draws: int, starts: int) -> Recovered:
    recordings, _ = usable(_read(folder, logs), logs.prefix)
    known = _arranged(support_points(logs.folder))
    return recovered(problem_of(recordings), known, starts=starts, draws=draws // 2, seed=0)


def _arranged(known: F | None) -> F:
    """The known points, or those of the other folders as a stand-in for the whole face."""
    points = support_points(ALL[0].folder) if known is None else known
    assert points is not None
    return ordered(points)


def _picture(out: Path, found: Found, moved: Recovered) -> str:
    name = f"{out.stem}_{found.logs.prefix or found.logs.folder}.svg"
    title = f"{found.logs.board}, {moved.pushes} pushes"
    outline = np.array([[-0.05, -0.05], [0.10, -0.05], [-0.05, 0.10]])
    best = moved.candidates[0].points
    draw_supports(out.parent / name, title, outline, found.known, best, moved.spread, found.forces)
    return f"![Support points, {title}]({name})"


def _places(points: F) -> str:
    return ", ".join(f"({x:.0f}, {y:.0f})" for x, y in 1e3 * points)


def _span(values: F) -> str:
    low, high = np.quantile(values, BOOTSTRAP)
    return f"[{low:.1f}, {high:.1f}]"


def _friction_row(found: Found) -> str:
    total, *centre = _total_and_centre(found.points, found.friction)
    x, y = 1e3 * np.array(centre)
    return (
        f"| {found.logs.board} | {len(found.pairs.files)} | {found.wrong} | {total:.2f} "
        f"{_span(found.redrawn[:, 0])} | {found.logs.friction:.1f} | {x:.1f} "
        f"{_span(1e3 * found.redrawn[:, 1])}, {y:.1f} {_span(1e3 * found.redrawn[:, 2])} | "
        f"{100 * found.explained:.0f} % |\n"
    )


def _forces_row(found: Found) -> str:
    return _recovered_row(found, "forces", found.forces, found.forces_spread)


def _motion_row(found: Found, moved: Recovered) -> str:
    low, high = np.quantile(moved.friction, BOOTSTRAP)
    how = f"motion (µ_t {moved.candidates[0].values[0]:.2f} [{low:.2f}, {high:.2f}])"
    return _recovered_row(found, how, moved.candidates[0].points, moved.spread)


def _recovered_row(found: Found, how: str, points: F, spread: F) -> str:
    if found.known is None:
        return f"| {found.logs.board} | {how} | {_places(points)} | – | – |\n"
    away = 1e3 * apart(points, found.points)
    held = held_by(spread, found.points)
    return f"| {found.logs.board} | {how} | {_places(points)} | {away:.1f} | {held} of 6 |\n"


def held_by(spread: F, known: F) -> int:
    """How many of the six intervals of (draws, 3, 2) points hold the known (3, 2)."""
    low, high = np.quantile([matched(points, known) for points in spread], BOOTSTRAP, axis=0)
    return int(np.sum((low <= known) & (known <= high)))


def _at_random() -> float:
    """Median distance in mm of points at random from the known ones."""
    drawn = three_point(PART.corners).draw(np.random.default_rng(0), 500)[:, POINTS]
    known = _arranged(support_points(ALL[0].folder))
    return float(1e3 * np.median([apart(each.reshape(3, 2), known) for each in drawn]))


def _other_rows(logs: Logs, moved: Recovered) -> str:
    def line(name: str, away: str, worse: F) -> str:
        return f"| {logs.board} | {name} | {away} | [{worse[0]:.2f}, {worse[1]:.2f}] |\n"

    def of(one: Candidate, name: str) -> str:
        return line(name, f"{1e3 * one.away:.1f}" if logs.folder != "patch" else "–", one.worse)

    stood = "known" if logs.folder != "patch" else "those of the other logs"
    minima = "".join(of(one, _places(one.points)) for one in moved.candidates[:6])
    return minima + of(moved.known, stood) + line("film", "–", moved.film)


def _verdict(found: list[Found], moved: dict[int, Recovered]) -> str:
    """What follows, from the numbers above."""
    slow = [f for f in found if f.known is not None and "15 mm/s" not in f.logs.board]
    off = max(abs(f.friction.sum() / f.logs.friction - 1.0) for f in slow)
    centre = max(1e3 * np.hypot(*_total_and_centre(f.points, f.friction)[1:]) for f in slow)
    three = [k for k in BY_MOTION if found[k].known is not None]
    away = [1e3 * moved[k].candidates[0].away for k in three]
    by_force = [1e3 * apart(f.forces, f.points) for f in slow]
    alike = sum(one.worse[0] <= 0.0 for k in three for one in moved[k].candidates[1:])
    refused = [ALL[k].board for k in three if moved[k].known.worse[0] > 0.0]
    ellipsoid = [ALL[k].board for k in BY_MOTION if moved[k].film[0] <= 0.0]
    ends = "; ".join(
        f"{ALL[k].board} {1e3 * moved[k].misfit[0]:.1f} mm, {np.degrees(moved[k].misfit[1]):.1f}°"
        for k in BY_MOTION
    )
    return (
        "\n### What these data can and cannot show\n\n"
        f"- With the points known, the forces of the slow logs give the total friction to within "
        f"{100 * off:.0f} % of what was measured apart, and its centre to within {centre:.0f} mm.\n"
        f"- With the points unknown, the motion alone finds them to {min(away):.0f} … {max(away):.0f} mm, "
        f"the forces (slow logs) to {min(by_force):.0f} … {max(by_force):.0f} mm.\n"
        f"- {alike} other minima cannot be told from the best (in sample): three points are not unique.\n"
        f"- The known points fit worse than the best minimum, beyond chance, for: "
        f"{'; '.join(refused) or 'none'}. There the recovered points also take up what the model lacks, "
        "and intervals over pushes are not intervals about the truth.\n"
        f"- Motion alone cannot tell three points from an ellipsoidal limit surface for: "
        f"{'; '.join(ellipsoid) or 'none'}. (Three points have four parameters more.)\n"
        f"- Last poses are fitted to, root mean square: {ends}. The whole face, which is not three points, "
        "is among them: a good fit does not say that the part stands on three points.\n"
        "- µ_s cannot show in motion; by the forces only the total friction does.\n"
    )
