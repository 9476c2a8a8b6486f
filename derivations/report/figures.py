"""The pictures of the register, with the numbers that they show."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
from markupsafe import Markup
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure

from derivations.report import drawing
from derivations.report.jam import AT_D, AT_S, jam_map
from meso_robust._generated import one_point_sticking as sticking
from meso_robust.reporting.canvas import CERTIFIED, GOAL, GOAL_FILL, INK, MISS, MUTED, OPEN
from meso_robust.reporting.svg import style, to_svg
from meso_robust.reporting.theme import PURPLE_FILL

Floats = npt.NDArray[np.float64]

# the paper's part, in µm: half sides, fitted rho, error of sensing and of the probe
HALF_LENGTH, HALF_WIDTH = drawing.HALF_LENGTH, drawing.HALF_WIDTH
LENGTH, WIDTH = 2.0 * HALF_LENGTH, 2.0 * HALF_WIDTH
RHO = 376_900.0
MU, MU_RANGE = 0.33, (0.30, 0.36)
OFFSET = 350.0  # d2 of the example
SENSING = CONTROL = 5.0
SEPARATION = WIDTH + 2.0 * SENSING + 2.0 * CONTROL  # eq. (10) with equality
PUSH = 1100.0  # of the paper's rotation
PANEL = (5.6, 4.0)  # inches
# grid of the jam map, cell centres; h leaves out 0, where both contacts lie on one normal
JAM_MU = np.round(np.arange(0.05, 0.605, 0.01), 2)
JAM_V = np.arange(842.0, 1000.0, 4.0)
JAM_H = np.arange(395.0, -100.0, -10.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class Picture:
    """A figure with what stands beside it."""

    name: str
    """Short name: its file and the prefix of its ids."""
    title: str
    caption: str
    """LaTeX between dollar signs."""
    svg: Markup
    size: tuple[float, float]
    """Inches."""
    is_notation: bool = False

    @property
    def file(self) -> str:
        """File below the folder of the register."""
        return f"figures/{self.name}.svg"

    @property
    def standalone(self) -> str:
        """The figure as a file of its own."""
        across, up = (f"{72.0 * side:g}pt" for side in self.size)
        return str(self.svg).replace("<svg", f'<svg width="{across}" height="{up}"', 1) + "\n"


def pictures() -> tuple[Picture, ...]:
    """All pictures: first those of the notation."""
    with style(formulas=True):
        return (
            _drawn(
                "sign-one-point",
                "One tip on the long edge",
                r"$a$ along the edge, $n$ outward, $\theta$ from $x$ to $a$. The tip touches at $d_2 a "
                r"+ d_1 n$ from the centre and travels along $-x$ ($v_p < 0$). On the part: "
                r"$\lambda_n$ along $-n$, $\lambda_t$ along $+a$.",
                drawing.one_point,
            ),
            _drawn(
                "sign-two-points",
                "Both tips of the active probe",
                r"$\theta = \pi/2 + \beta$: the edge lies along the line through both tips, $\beta > 0$ "
                r"where the upper tip 1 is ahead. $d_4$ is the spacing across the push; along the "
                r"edge the tips are $d_4/\cos\beta$ apart.",
                drawing.two_points,
            ),
            _drawn(
                "sign-two-sided",
                "Moving and passive tip",
                r"D moves along $-x$, S rests on the opposite edge. From S to D: $h$ along $x$ and $V$ "
                r"across the push (printed $d_v$); $w = 2 d_1$ (printed $d_w$). $(h, V) = T a + w n$ "
                "while both touch.",
                drawing.two_sided,
            ),
            _ratio_picture(),
            _jam_picture(),
            _tilt_picture(),
        )


def _drawn(name: str, title: str, caption: str, draw: Callable[[], Figure]) -> Picture:
    svg = to_svg(draw(), name, title)
    return Picture(
        name=name, title=title, caption=caption, svg=svg, size=drawing.PANEL, is_notation=True
    )


# -- numbers --------------------------------------------------------------------------------------


def printed_limit() -> float:
    """Eq. (6) for the example, deg."""
    A, B = HALF_WIDTH * OFFSET, RHO + HALF_WIDTH**2
    return float(np.degrees(np.pi - max(np.arctan(HALF_WIDTH / OFFSET), np.arctan(A / B))))


def sticking_limits() -> tuple[float, float]:
    """Both ends of the derived sticking interval of the example, deg."""
    A, B, C = HALF_WIDTH * OFFSET, RHO + HALF_WIDTH**2, RHO + OFFSET**2
    low = np.arctan2(C - MU * A, MU * B - A)
    high = np.pi - np.arctan2(C + MU * A, A + MU * B)
    return float(np.degrees(low)), float(np.degrees(high))


def force_ratio(theta: Floats) -> Floats:
    """|lambda_n/lambda_t| of the example by the generated code; theta in deg."""
    (ratio,) = sticking.stick_ratio(np, np.radians(theta), HALF_WIDTH, OFFSET, RHO)
    return np.asarray(1.0 / np.abs(ratio))


def jam_limit(mu: npt.ArrayLike) -> Floats:
    """Derived smallest separation without a jam, µm."""
    return np.asarray(WIDTH * np.sqrt(1.0 + np.asarray(mu) ** 2))


def jam_raster() -> npt.NDArray[np.bool_]:
    """(V, mu) whether the rotation jams, on the grid of the map."""
    return jam_map(JAM_MU, JAM_V / 1e3, JAM_H / 1e3, WIDTH / 1e3, RHO / 1e6)


def tilt(push: Floats, separation: float = SEPARATION) -> Floats:
    """Tilt against the horizontal, deg, after a push from the upright part, both tips touching."""
    h = WIDTH - push
    lean = np.arcsin(WIDTH / np.hypot(h, separation))
    return np.asarray(180.0 - np.degrees(np.arctan2(separation, h) + lean))


def printed_tilt() -> float:
    """theta_t of eq. (11), deg."""
    lean = np.arcsin(SEPARATION / np.hypot(WIDTH, LENGTH))
    return float(np.degrees(lean - np.arctan(WIDTH / LENGTH)))


def push_to_printed_tilt() -> float:
    """Push, µm, at which the tilt is theta_t: the line across both tips has turned to its height."""
    t = np.radians(printed_tilt())
    return float(WIDTH + (SEPARATION * np.cos(t) - WIDTH) / np.sin(t))


# -- pictures -------------------------------------------------------------------------------------


def _ratio_picture() -> Picture:
    (low, high), printed = sticking_limits(), printed_limit()
    caption = (
        rf"Half sides {HALF_LENGTH:g} and {HALF_WIDTH:g} µm, $\rho$ = {RHO / 1e6:g} mm², "
        rf"$d_2$ = {OFFSET:g} µm, $\mu$ = {MU:g}. Sticking needs the curve above $1/\mu$ (and "
        rf"$\lambda_n > 0$): the shaded interval, {low:.2f}° to {high:.2f}°. Beyond the pole "
        rf"$\lambda_t = 0$ the ratio falls again, so sticking ends {printed - high:.1f}° before the "
        f"printed limit {printed:.1f}° of Lemma 1."
    )
    title = "How long one point sticks: eq. (6)"
    return _picture("sticking-interval", title, caption, _ratio_figure(low, high, printed))


def _ratio_figure(low: float, high: float, printed: float) -> Figure:
    figure, axes = _panel(r"$\theta$ in deg", r"$|\lambda_n/\lambda_t|$")
    theta = np.arange(60.0, 165.01, 0.1)
    axes.axvspan(round(low, 3), round(high, 3), fc=GOAL_FILL, ec="none", zorder=0)
    axes.plot(np.round(theta, 3), np.round(force_ratio(theta), 4), color=INK, lw=1.6, zorder=4)
    axes.axhline(round(1.0 / MU, 4), color=MUTED, lw=1.0, ls=(0, (4, 3)))
    axes.axvline(round(high, 3), color=GOAL, lw=1.6)
    axes.axvline(round(low, 3), color=GOAL, lw=1.6)
    axes.axvline(round(printed, 3), color=MISS, lw=1.6, ls=(0, (5, 2)))
    axes.set_xlim(60.0, 165.0)
    _log_scale(axes, (0.1, 100.0), (0.1, 1.0, 10.0, 100.0))
    _say(axes, 61.5, 1.15 / MU, rf"$1/\mu$ = {1.0 / MU:.2f}", MUTED)
    _say(axes, 0.5 * (low + high), 0.14, "sticks", GOAL, ha="center")
    _say(axes, high - 1.0, 40.0, f"{high:.2f}°", GOAL, ha="right")
    _say(axes, low - 1.0, 40.0, f"{low:.2f}°", GOAL, ha="right")
    _say(axes, printed + 1.0, 40.0, f"printed (6)\n{printed:.1f}°", MISS)
    return figure


def _jam_picture() -> Picture:
    below, above = (WIDTH * edge for edge in (JAM_MU[0], JAM_MU[-1]))
    caption = (
        rf"Each cell: whether, somewhere while D passes S ($h$ from {JAM_H[0]:g} to ${JAM_H[-1]:g}$ "
        rf"µm, part centred between the tips), no contact mode has a solution; all "
        rf"{len(AT_D) * len(AT_S)} modes tried by linear solves. Line: the derived limit $d_w "
        rf"\sqrt{{1 + \mu^2}}$, {float(jam_limit(MU)):.1f} µm at $\mu$ = {MU:g}. Eq. (10) gives "
        rf"{SEPARATION:g} µm, the printed remark $d_w\tan\sigma = \mu d_w$ only {below:.0f} to "
        f"{above:.0f} µm."
    )
    return _picture("jam-map", "Where the rotation jams: eq. (10)", caption, _jam_figure())


def _jam_figure() -> Figure:
    figure, axes = _panel(r"$\mu$", r"$d_v$ in µm")
    axes.grid(visible=False)
    axes.set_facecolor(GOAL_FILL)
    runs = _runs(jam_raster())
    axes.add_collection(
        PolyCollection(runs, facecolors=PURPLE_FILL, edgecolors="none", antialiased=False)
    )
    mu = np.linspace(0.045, 0.605, 113)
    axes.plot(np.round(mu, 4), np.round(jam_limit(mu), 3), color=INK, lw=1.2, zorder=5)
    axes.axhline(SEPARATION, color=MISS, lw=1.4, ls=(0, (5, 2)), zorder=4)
    for end in MU_RANGE:
        axes.axvline(end, color=OPEN, lw=1.0, ls=(0, (1, 2)), zorder=4)
    axes.set_xlim(0.045, 0.605)
    axes.set_ylim(840.0, 1000.0)
    _say(axes, sum(MU_RANGE) / 2, 990.0, r"$\mu$ of the paper", MUTED, ha="center")
    _say(axes, 0.20, 930.0, "some contact mode\nhas a solution throughout", GOAL, ha="center")
    _say(axes, 0.51, 885.0, "none has one\nsomewhere: jam", MISS, ha="center")
    _say(axes, 0.545, 972.0, "derived limit", INK, ha="right")
    _say(axes, 0.055, SEPARATION + 3.5, f"(10) printed: {SEPARATION:g}", MISS)
    arrow = {"arrowstyle": "-|>", "color": MISS, "lw": 1.2, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", xy=(0.375, 840.5), xytext=(0.375, 851.5), arrowprops=arrow, zorder=6)
    _say(axes, 0.385, 846.0, r"remark: $d_w\tan\sigma$, far below", MISS)
    return figure


def _runs(jams: npt.NDArray[np.bool_]) -> list[list[tuple[float, float]]]:
    """One rectangle for each run of set cells in a column of the jam map."""
    wide, tall = JAM_MU[1] - JAM_MU[0], JAM_V[1] - JAM_V[0]
    found = []
    for mu, column in zip(JAM_MU, jams.T, strict=True):
        steps = np.flatnonzero(np.diff(np.concatenate([[False], column, [False]]).astype(int)))
        # a little wider than its cell, so that no seam shows between columns
        left, right = round(float(mu - wide / 2), 4), round(float(mu + 0.55 * wide), 4)
        for first, beyond in steps.reshape(-1, 2):
            low, high = JAM_V[0] + tall * (first - 0.5), JAM_V[0] + tall * (beyond - 0.5)
            found.append([(left, low), (right, low), (right, high), (left, high)])
    return found


def _tilt_picture() -> Picture:
    wanted, at = printed_tilt(), push_to_printed_tilt()
    reported = float(tilt(np.array([PUSH]))[0])
    caption = (
        rf"Tilt $\pi - \theta$ with $d_v$ = {SEPARATION:g} µm while both tips touch, $\theta = "
        rf"\mathrm{{atan2}}(V, h) + \sin^{{-1}}(w/\sqrt{{h^2 + V^2}})$, the push counted from the "
        rf"upright part ($h = w$). $\theta_t$ = {wanted:.2f}° of eq. (11) takes {at / 1e3:.2f} mm; "
        f"after the reported {PUSH:g} µm the part is still {reported:.1f}° off. Geometry only: at "
        "this separation the quasi-static motion jams before (figure above)."
    )
    title = "How far the rotation gets: eq. (11)"
    return _picture("tilt-by-push", title, caption, _tilt_figure(wanted, at, reported))


def _tilt_figure(wanted: float, at: float, reported: float) -> Figure:
    figure, axes = _panel("push in µm", "tilt in deg")
    push = np.arange(0.0, 3000.1, 10.0)
    axes.plot(push, np.round(tilt(push), 4), color=INK, lw=1.6, zorder=4)
    axes.axhline(round(wanted, 4), color=MISS, lw=1.4, ls=(0, (5, 2)))
    axes.plot([round(at, 2)], [round(wanted, 4)], marker="o", ms=5.5, color=MISS, zorder=6)
    axes.plot([PUSH], [round(reported, 4)], marker="o", ms=5.5, color=CERTIFIED, zorder=6)
    axes.set_xlim(0.0, 3000.0)
    _log_scale(axes, (0.4, 120.0), (1.0, 3.0, 10.0, 30.0, 90.0))
    _say(axes, 60.0, wanted * 1.13, rf"$\theta_t$ of (11): {wanted:.2f}°", MISS)
    _say(axes, at, wanted * 1.22, f"{at / 1e3:.2f} mm", MISS, ha="center")
    _say(axes, PUSH + 70.0, reported * 1.12, f"{reported:.1f}° after {PUSH:g} µm", CERTIFIED)
    return figure


def _log_scale(axes: Axes, limits: tuple[float, float], ticks: tuple[float, ...]) -> None:
    axes.set_yscale("log")
    axes.set_ylim(limits)
    axes.set_yticks(ticks, [f"{tick:g}" for tick in ticks])
    axes.minorticks_off()


def _panel(across: str, up: str) -> tuple[Figure, Axes]:
    figure = Figure(figsize=PANEL)
    axes = figure.add_axes((0.105, 0.115, 0.86, 0.86))
    axes.set_xlabel(across, labelpad=2)
    axes.set_ylabel(up, labelpad=2)
    return figure, axes


def _say(axes: Axes, x: float, y: float, text: str, colour: str, ha: str = "left") -> None:
    box = {"fc": "white", "ec": "none", "alpha": 0.8, "pad": 1.0}
    look: dict[str, Any] = {"color": colour, "fontsize": 9.0, "va": "center", "ha": ha, "bbox": box}
    axes.text(round(x, 4), round(y, 4), text, zorder=8, **look)


def _picture(name: str, title: str, caption: str, figure: Figure) -> Picture:
    svg = to_svg(figure, name, title)
    return Picture(name=name, title=title, caption=caption, svg=svg, size=PANEL)
