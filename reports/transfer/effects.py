"""Which effects of the catalogue a plan is proved with again: ``python -m reports.transfer.effects``.

Sizes are those of the blind benchmark's cases in which an effect is four times as large as what
recordings can just show. A fitted model has an interval: here a quarter of the size, what they can just
show, to either side. Nothing is simulated; a verdict is that of the search and of the certificate.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from pathlib import Path

from meso_robust.errors import NotApplicableError
from meso_robust.files import write_all
from meso_robust.identification.document import ModelDocument
from meso_robust.simulator.catalogue import CATALOGUE
from meso_robust.task import Task
from meso_robust.transfer.lines import Ground
from meso_robust.transfer.promise import recertified
from tests.transfer.models import model

HERE = Path(__file__).parent
SEALED = HERE.parent / "blind" / "second_trial" / "sealed.jsonl"
FITTED = {"rho_um2": (374_000.0, 379_000.0), "mu": (0.325, 0.335)}
"""Of the paper's part, as closely as a dozen recordings give them."""
MULTIPLE, INTERVAL = 4.0, 0.25
BEYOND_UM = -2600.0
NEARLY = 0.2  # sizes are cut off at what makes sense: so many multiples may be missing
MARKS = "<!-- table: made by the program -->\n", "<!-- end of table -->\n"


def cases() -> dict[str, Mapping[str, float]]:
    """Parameters of each effect at the multiple wanted that has a case, by name and in the catalogue's units."""
    found: dict[str, Mapping[str, float]] = {}
    for line in SEALED.read_text(encoding="utf-8").splitlines()[1:]:
        label = json.loads(line)["label"]
        if label["kind"] == "effect" and abs(label["truth"]["multiples"][0] - MULTIPLE) < NEARLY:
            (parameters,) = label["truth"]["parameters"]
            found.setdefault(label["names"][0], parameters)
    # where the post stands is the laboratory's: here beyond the goal, clear of the plan's way
    found["unmodelled_wall"] = {**found["unmodelled_wall"], "x_um": BEYOND_UM}
    return {name: found[name] for name in CATALOGUE if name in found}


def fitted(effect: str, parameters: Mapping[str, float]) -> ModelDocument:
    """A model that recordings could give: sizes with an interval, what goes with them held."""
    sizes = {one.key for one in CATALOGUE[effect].parameters if one.size}
    spread = INTERVAL * max(abs(parameters[key]) for key in sizes)
    ranges, held = {}, {}
    for key, value in parameters.items():
        if key in sizes:
            ranges[f"{effect}.{key}"] = value - spread, value + spread
        else:
            held[f"{effect}.{key}"] = value
    return model(ranges, base=FITTED, held=held)


def rows(task: Task) -> Iterator[tuple[str, str, str, str]]:
    """Effect, its size, the verdict, and what it changes in the task or which premise it breaks."""
    for effect, parameters in cases().items():
        shown = ", ".join(f"`{key}` {value:.3g}" for key, value in parameters.items())
        try:
            found = recertified(task, fitted(effect, parameters))
        except NotApplicableError as error:
            yield effect, shown, "UNKNOWN", str(error)
            continue
        (standing,) = [one for one in found.standings if one.name == effect]
        if found.proved:
            changed = [one for one in found.changed.changes if effect in one.because]
            said = "; ".join(f"`{one.key}` {one.before} → {one.after}" for one in changed)
            yield effect, shown, "PROVED", said or standing.said
        elif standing.survives:
            yield effect, shown, found.wide.verdict.word, f"absorbed, not proved: {standing.said}"
        else:
            broken = standing.premise
            name = f"`{broken}`" if broken and not isinstance(broken, Ground) else "no premise"
            yield effect, shown, "UNKNOWN", f"{name}: {standing.said}"


def table(task: Task) -> str:
    """The table, and how many effects are proved with."""
    found = list(rows(task))
    proved = sum(verdict == "PROVED" for _, _, verdict, _ in found)
    lines = [
        f"**{proved} of {len(found)} effects end PROVED again** ({task.name}, {task.tips}).",
        "",
        "| effect | size | verdict | what becomes of it |",
        "|---|---|---|---|",
        *(f"| `{name}` | {size} | {verdict} | {said} |" for name, size, verdict, said in found),
        "",
    ]
    return "\n".join(lines)


def main() -> None:
    """Write the table into the page."""
    page = (HERE / "README.md").read_text(encoding="utf-8")
    before, rest = page.split(MARKS[0])
    after = rest.split(MARKS[1])[1]
    write_all(
        HERE,
        {"README.md": before + MARKS[0] + "\n" + table(Task.paper()) + "\n" + MARKS[1] + after},
    )


if __name__ == "__main__":
    main()
