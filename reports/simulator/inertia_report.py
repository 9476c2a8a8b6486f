"""The report on inertia: ``python -m reports.simulator.inertia_report --out reports/simulator``."""

import argparse
from pathlib import Path

import matplotlib as mpl
import numpy as np
import numpy.typing as npt
from matplotlib.figure import Figure

from reports.simulator.inertia import TIMES, differences, time_constant

F = npt.NDArray[np.float64]

PIXEL = 5.26e-6  # m, of the paper's camera

TEXT = """# Inertia is negligible at this scale

The paper's part, 1616 × 837 × 40 µm of beryllium copper on an oil of 0.1 Pa s in a film of 10 µm, has a
mass over drag of **{own_us:.0f} µs**: that is how long it takes to stop. With inertia its path in a 600 µm push
at 75 µm/s, at six places of the long edge, differs from the quasi-static path by at most **{own_nm:.2f} nm** at
any corner of the part; a pixel of the camera is 5260 nm. The difference grows in proportion to mass over
drag; it would reach a pixel at about {pixel_s:.1f} s, some {times:.0e} times the part's.

![Difference of the paths over mass over drag](inertia.svg)

| mass over drag | largest difference of the paths |
|---|---|
{rows}

Command: `python -m reports.simulator.inertia_report --out reports/simulator`
"""


def figure(times: F, away: F, own: float, own_away: float) -> Figure:
    """Difference of the paths over mass over drag, with the paper's part and a pixel marked."""
    chart = Figure(figsize=(6.4, 4.0), layout="constrained")
    axes = chart.add_subplot()
    axes.loglog(times, away / 1e-6, "-", color="#0072b2", label="with and without inertia")
    axes.loglog([own], [own_away / 1e-6], "o", color="#d55e00", label="the paper's part")
    axes.axhline(PIXEL / 1e-6, color="0.5", linestyle="--", label="a pixel, 5.26 µm")
    axes.set_xlabel("mass over drag of the film, s")
    axes.set_ylabel("largest difference of the paths, µm")
    axes.grid(visible=True, which="major", color="0.9")
    axes.legend(frameon=False)
    return chart


def main() -> None:
    """Write the page and its figure."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, required=True)
    out = parser.parse_args().out
    out.mkdir(parents=True, exist_ok=True)
    own = time_constant()
    away = differences(TIMES)
    own_away = float(differences(np.array([own]))[0])
    reached = float(np.interp(np.log(PIXEL), np.log(away), np.log(TIMES)))
    rows = [
        (own, own_away, " (the paper's part)"),
        *((t, a, "") for t, a in zip(TIMES, away, strict=True)),
    ]
    lines = [f"| {t:.3g} s{note} | {a / 1e-9:.3g} nm |" for t, a, note in sorted(rows)]
    page = TEXT.format(
        own_us=own / 1e-6,
        own_nm=own_away / 1e-9,
        pixel_s=np.exp(reached),
        times=np.exp(reached) / own,
        rows="\n".join(lines),
    )
    (out / "inertia.md").write_text(page, encoding="utf-8")
    with mpl.rc_context({"svg.hashsalt": "inertia", "svg.fonttype": "none"}):
        figure(TIMES, away, own, own_away).savefig(out / "inertia.svg", metadata={"Date": None})


if __name__ == "__main__":
    main()
