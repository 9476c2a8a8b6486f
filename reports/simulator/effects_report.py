"""The catalogue of effects as a page: ``python -m reports.simulator.effects_report --out FILE``."""

import argparse
from pathlib import Path

from meso_robust.simulator.catalogue import CATALOGUE, stage_of
from meso_robust.simulator.stage import Effect

HEAD = """# Effects of the simulator

Each effect acts at one stage of the chain and is off where its sizes are zero; the plain model then remains,
to the last bit. Forces are divided by the film's translational drag e_x and so are speeds: nothing else
can be seen in motion alone. θ is the part's angle, u the velocity of a place of the part over the stage.

| stage | effect | law | parameters (default) | source |
|---|---|---|---|---|
"""


def row(effect: Effect) -> str:
    """One line of the table."""
    parameters = "; ".join(
        f"`{p.key}`: {p.meaning}"
        + ("" if p.size else f" ({p.shown(p.default):g} {p.unit})".rstrip())
        for p in effect.parameters
    )
    cells = (
        stage_of(effect.name).name,
        f"`{effect.name}`",
        effect.equation,
        parameters,
        effect.source,
    )
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |\n"


def page() -> str:
    """The whole page."""
    return HEAD + "".join(row(effect) for effect in CATALOGUE.values())


def main() -> None:
    """Write the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, required=True)
    parser.parse_args().out.write_text(page(), encoding="utf-8")


if __name__ == "__main__":
    main()
