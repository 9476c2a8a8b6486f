"""The page of the blind benchmark: ``python -m reports.blind.blind_report FOLDER`` regenerates it."""

from __future__ import annotations

import json
import sys
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from meso_robust.campaigns.blind.judging import EQUIVALENT, Judged, judged
from meso_robust.campaigns.blind.labels import KINDS, PLAIN, TITLES
from meso_robust.campaigns.blind.scoring import NEAR_FLOOR, scores
from meso_robust.campaigns.blind.sealing import Commitment, SealError, opened, read_results
from reports.blind.blind_figures import confusion_figure, power_figure, reliability_figure
from reports.blind.committing import benchmark
from reports.blind.corpus import EFFECTS

Values = Mapping[str, Any]


def write_report(folder: Path) -> None:
    """Open the labels, score what was run, write ``README.md``, ``results.json``, ``cases.csv``, figures.

    Raises
    ------
    SealError
        A label or a recording set is not the one committed to, or a case was run twice.
    """
    commitment, cases = opened(folder)
    results = read_results(folder)
    for index, result in results.items():
        if result["recordings"] != cases[index].recordings:
            raise SealError(f"case {index}: diagnosed on other recordings than were sealed")
    each = [judged(k, cases[k].label, result) for k, result in sorted(results.items())]
    found = scores(each, Counter(case.label["kind"] for case in cases))
    same = benchmark() == commitment.generator
    files = {
        "README.md": page(found, commitment, same),
        "results.json": json.dumps(found, indent=1) + "\n",
        "cases.csv": ledger(each),
        "power.svg": power_figure(found["naming"]["by_multiple"]),
        "reliability.svg": reliability_figure(found["calibration"]["bins"]),
        "confusion.svg": confusion_figure(found["confusion"]),
    }
    for name, text in files.items():
        (folder / name).write_text(text, encoding="utf-8")


def page(found: Values, commitment: Commitment, same: bool) -> str:
    """The whole page, Markdown; ``same``: scoring and generator are still those of the commitment."""
    parts = [
        _head(found, commitment, same),
        _targets(found),
        _naming(found),
        _power(found),
        _confusion(found),
        _hard(found),
        _located(found),
        _shown(found),
        _calibration(found),
    ]
    return "\n\n".join(parts) + "\n"


def ledger(cases: Iterable[Judged]) -> str:
    """Every case that was run, CSV: what was concealed, what was answered."""
    rows = [
        (
            case.index,
            case.kind,
            "+".join(case.names),
            f"{case.multiple:g}",
            case.verdict,
            " or ".join("+".join(sorted(names)) for names in case.answers),
            "yes" if case.as_wanted else "no",
            "yes" if case.confident_and_wrong else "no",
            f"{case.seconds:.1f}",
        )
        for case in cases
    ]
    head = "case,kind,concealed,multiple,verdict,answers,as_wanted,wrong_and_confident,time_s"
    return "\n".join([head, *(",".join(map(str, row)) for row in rows)]) + "\n"


def rate(share: Values) -> str:
    """A share with its interval, in words."""
    if share["rate"] is None:
        return "–"
    ends = f"{100 * share['low']:.0f} … {100 * share['high']:.0f} %"
    return f"{100 * share['rate']:.1f} % ({share['hits']}/{share['count']}; {ends})"


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A Markdown table."""
    lines = ["| " + " | ".join(row) + " |" for row in (head, *rows)]
    return "\n".join([lines[0], "|" + "---|" * len(head), *lines[1:]])


def _head(found: Values, commitment: Commitment, same: bool) -> str:
    planned, run = found["cases"]["planned"], found["cases"]["run"]
    total, done = sum(planned.values()), sum(run.values())
    form = "quick" if commitment.quick else "full"
    kept = "are those of" if same else "**have changed since**"
    seconds = found["seconds"]
    time = f"{seconds['median']:.0f} s, {seconds['q90']:.0f} s for one in ten" if done else "–"
    return f"""# Blind benchmark of `diagnose`

**{done} of the {total} cases of the corpus were run**, each once, by the {form} diagnosis. Median
time of a case: {time}.

{table(("concealed", "planned", "run"), [(TITLES[k], str(planned.get(k, 0)), str(run[k])) for k in KINDS])}

The sets come from a generator that shares no code with the package. Every label was committed to
by a salted SHA-256 before the first diagnosis ({commitment.date}), and every one opened here
matches its hash; seeds follow from the hash of the diagnoser, so none existed before it did. The
diagnoser is a process that gets a folder's path and nothing else. Generator and scoring {kept} the
commitment.

- diagnoser `{commitment.diagnoser}`
- Merkle root of the labels `{commitment.root}`
- not answered (failed or took too long): {rate(found["cases"]["unanswered"])}

Sizes are multiples of the just-detectable size: a signature of 5 σ once friction, drag ratio and
all start poses are fitted. Intervals are exact 95 % ones. The same command,
`python -m reports.blind.campaign`, resumes the campaign where it stopped;
`python -m reports.blind.blind_report` regenerates this page. `cases.csv` lists every case, `results.json`
has every figure, `sealed.jsonl` the labels with their salts."""


def _targets(found: Values) -> str:
    plain = found["naming"]["plain"]
    floor = found["held_out"]["named"]["over_floor"].get("median")
    shares = (
        ("false alarms on nulls", "≤", 2, found["nulls"]["alarms"]),
        (f"right name, effects of ≥ {PLAIN:g}×", "≥", 85, plain["right"]),
        ("wrong and confident, of all cases", "≤", 2, found["wrong_and_confident"]["all"]),
        ("outside the catalogue → unknown", "≥", 80, found["outside"]["unknown"]),
        (f"right stage, effects of ≥ {PLAIN:g}×", "≥", 90, found["stage"]["plain"]),
        ("unidentifiable → says so", "≥", 100, found["unidentifiable"]["says_so"]),
    )
    rows = [
        (what, f"{sign} {limit} %", rate(share), _met(sign, limit, share))
        for what, sign, limit, share in shares
    ]
    told = "–" if floor is None else f"{floor:.2f}"
    met = "–" if floor is None else ("yes" if floor <= NEAR_FLOOR else "**no**")
    rows.append(("held-out error after naming / noise floor, median", f"≤ {NEAR_FLOOR}", told, met))
    return "## Targets\n\n" + table(("", "target", "reached", "met"), rows)


def _met(sign: str, limit: float, share: Values) -> str:
    if share["rate"] is None:
        return "–"
    percent = 100 * share["rate"]
    return "yes" if (percent <= limit if sign == "≤" else percent >= limit) else "**no**"


def _naming(found: Values) -> str:
    naming = found["naming"]
    rows = [(_times(row["multiple"]), row) for row in naming["by_multiple"]]
    rows.append((f"≥ {PLAIN:g}×", naming["plain"]))
    keys = ("detected", "right", "in_set", "wrong")
    lines = [
        (size, *(rate(row[key]) for key in keys), _number(row["mean_sets"])) for size, row in rows
    ]
    head = ("size", "detected", "named rightly", "in the set", "wrong and confident", "mean sets")
    return (
        "## One effect: naming by size\n\n"
        "*In the set*: named, or among the sets that an ambiguous answer lists.\n\n"
        + table(head, lines)
        + "\n\n![Detected and rightly named against size](power.svg)"
    )


def _times(size: float) -> str:
    return f"{size:g}×" if size else "< 1×"


def _number(value: float | None) -> str:
    return "–" if value is None else f"{value:.2f}"


def _power(found: Values) -> str:
    power = found["power"]
    sizes = sorted({point["multiple"] for points in power.values() for point in points})
    lines = []
    for name in (name for name in EFFECTS if name in power):
        by_size = {point["multiple"]: point for point in power[name]}
        cells = [_point(by_size.get(size)) for size in sizes]
        lines.append((f"`{name}`", *cells, _instead(name, found["confusion"][name])))
    head = ("effect", *map(_times, sizes), "other answers, all sizes")
    return (
        "### By effect\n\nNamed rightly / detected / run.\n\n"
        + table(head, lines)
        + "\n\nNo motion tells "
        + ", ".join(f"`{one}` from `{other}`" for one, other in EQUIVALENT.items())
        + "; naming either, or both as alternatives, counts as naming the other."
    )


def _point(point: Values | None) -> str:
    return "–" if point is None else f"{point['right']}/{point['detected']}/{point['count']}"


def _instead(name: str, answers: Mapping[str, int]) -> str:
    own = EQUIVALENT.get(name, name)
    return ", ".join(f"{answer} {count}" for answer, count in answers.items() if answer != own)


def _confusion(found: Values) -> str:
    rows = [(key, rate(share)) for key, share in found["wrong_and_confident"].items()]
    return (
        "## Confusion\n\n![Answers by what was concealed](confusion.svg)\n\n"
        "*Wrong and confident*: one set of effects is named, with an effect that is not there.\n\n"
        + table(("cases", "wrong and confident"), rows)
    )


def _hard(found: Values) -> str:
    pairs, outside, hidden = found["pairs"], found["outside"], found["unidentifiable"]
    rows = [
        ("nulls: alarms", rate(found["nulls"]["alarms"])),
        ("nulls: an effect named", rate(found["nulls"]["named"])),
        ("pairs: detected", rate(pairs["detected"])),
        ("pairs: both named, nothing else", rate(pairs["both"])),
        ("pairs: one named, nothing else", rate(pairs["one"])),
        ("pairs: among the sets answered", rate(pairs["in_set"])),
        ("pairs: wrong and confident", rate(pairs["wrong"])),
        ("outside: detected", rate(outside["detected"])),
        ("outside: unknown", rate(outside["unknown"])),
        ("outside: unknown, of those detected", rate(outside["unknown_if_detected"])),
        ("outside: wrong and confident", rate(outside["wrong"])),
        ("unidentifiable: says so", rate(hidden["says_so"])),
        ("unidentifiable: wrong and confident", rate(hidden["wrong"])),
    ]
    return (
        "## Nothing, two effects, effects outside the catalogue, recordings that cannot tell\n\n"
        + table(("", "share"), rows)
        + "\n\n"
        + table(("outside the catalogue", "answers"), _listed(outside["by_name"]))
        + "\n\n"
        + table(("unidentifiable", "answers"), _listed(hidden["by_name"]))
    )


def _listed(by_name: Mapping[str, Mapping[str, int]]) -> list[tuple[str, str]]:
    return [
        (f"`{name}`", ", ".join(f"{answer} {count}" for answer, count in answers.items()))
        for name, answers in by_name.items()
    ]


def _located(found: Values) -> str:
    rows = [(key, rate(share)) for key, share in found["stage"].items()]
    return (
        "## Location\n\nStage of the likeliest effect, or of the largest span of an unknown "
        f"mismatch, of all cases that were detected (`plain`: single effects of ≥ {PLAIN:g}×).\n\n"
        + table(("cases", "right stage"), rows)
    )


def _shown(found: Values) -> str:
    rows = [(f"`{key}`", rate(share)) for key, share in found["parameters"].items()]
    lines = [
        (
            group,
            *(_number(held["over_floor"].get(key)) for key in ("median", "q90")),
            rate(held["near_floor"]),
            _number(held["removed"].get("median")),
        )
        for group, held in found["held_out"].items()
    ]
    head = ("cases", "median", "90 % quantile", f"≤ {NEAR_FLOOR}", "share of the excess removed")
    return (
        "## Parameters and held-out error\n\nHeld-out error over the noise floor after naming.\n\n"
        + table(head, lines)
        + "\n\nTruth inside the 90 % interval, of sets named rightly.\n\n"
        + table(("parameter", "covered"), rows)
    )


def _calibration(found: Values) -> str:
    told = found["calibration"]
    return (
        "## Calibration\n\n"
        f"{told['claims']} effects stated with a probability (verdicts `named` and `ambiguous`): "
        f"Brier score {_number(told['brier'])}, expected calibration error {_number(told['ece'])}."
        "\n\n![Stated probability against the share that is right](reliability.svg)"
    )


if __name__ == "__main__":
    write_report(Path(sys.argv[1] if len(sys.argv) > 1 else "reports/blind"))
