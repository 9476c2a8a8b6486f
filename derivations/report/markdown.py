"""The register as Markdown with LaTeX between dollar signs: what the page says, without its looks."""

from __future__ import annotations

from collections.abc import Iterator

from derivations.report import notation
from derivations.report.figures import Picture
from derivations.report.formulas import plain_markdown, to_markdown
from derivations.report.page import headline
from derivations.report.register import MARKS, Chapter, Entry, Found, tally
from derivations.report.witnesses import values


def markdown(register: tuple[Chapter, ...], drawn: tuple[Picture, ...]) -> str:
    """The whole text; arguments as of :func:`derivations.report.page.page`."""
    blocks = [
        "# Register of claims",
        f"**{headline(register)}.** {notation.ABOUT_REGISTER}",
        _table(
            ("", "verdict", "claims", "meaning"),
            [
                (MARKS[verdict], verdict.words, str(count), verdict.value)
                for verdict, count in tally(register).items()
            ],
        ),
        "## Overview",
        _table(("place", "statement", "verdict"), _overview(register)),
        "## Notation and signs",
        to_markdown(notation.FRAME, "notation"),
        *_pictures(drawn, is_notation=True),
        _table(
            ("letters", "meaning"),
            [
                (to_markdown(letters, "notation"), to_markdown(meaning, "notation"))
                for letters, meaning in notation.SYMBOLS
            ],
        ),
        "## Pictures",
        *_pictures(drawn, is_notation=False),
        "## How to check",
        "\n".join(f"- **{route}**: {meaning}" for route, meaning in notation.ROUTES),
        notation.RERUN,
        notation.REMAKE,
        *(block for chapter in register for block in _chapter(chapter)),
    ]
    return "\n\n".join(blocks) + "\n"


def _table(head: tuple[str, ...], rows: list[tuple[str, ...]]) -> str:
    lines = [head, ("---",) * len(head), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def _overview(register: tuple[Chapter, ...]) -> list[tuple[str, ...]]:
    return [
        (
            to_markdown(entry.claim.place, entry.claim.key),
            f"[{to_markdown(entry.claim.title, entry.claim.key)}](#{entry.claim.key})",
            _verdict(entry),
        )
        for chapter in register
        for entry in chapter.entries
    ]


def _verdict(entry: Entry) -> str:
    return f"{MARKS[entry.claim.verdict]} **{entry.claim.verdict.words}**"


def _pictures(drawn: tuple[Picture, ...], is_notation: bool) -> Iterator[str]:
    for picture in drawn:
        if picture.is_notation == is_notation:
            yield f"![{plain_markdown(picture.title)}]({picture.file})"
            yield f"{to_markdown(picture.title, picture.name)}. " + to_markdown(
                picture.caption, picture.name
            )


def _chapter(chapter: Chapter) -> Iterator[str]:
    yield f"## {to_markdown(chapter.title, chapter.name)}"
    yield f"`{chapter.source}`"
    for entry in chapter.entries:
        yield from _entry(entry)


def _entry(entry: Entry) -> Iterator[str]:
    claim = entry.claim

    def shown(text: str) -> str:
        return to_markdown(text, claim.key)

    yield f'<a id="{claim.key}"></a>'
    yield f"### {shown(claim.title)}"
    yield f"{_verdict(entry)} · {shown(claim.place)} · `{claim.key}`"
    if claim.printed:
        yield f"**As printed:** {shown(claim.printed)}"
    yield f"**As derived:** {shown(claim.derived)}"
    if entry.hypotheses:
        added = dict.fromkeys(claim.added, " **(added: the print lacks it)**")
        yield "**Hypotheses:**"
        yield "\n".join(f"- {shown(text)}{added.get(text, '')}" for text in entry.hypotheses)
    if claim.steps:
        yield "**Derivation:**"
        yield "\n".join(f"{k}. {shown(step)}" for k, step in enumerate(claim.steps, start=1))
    for about, members in entry.groups:
        yield f"**Findings on {about}:**"
        yield "\n".join(_found(found, claim.key) for found in members)


def _found(found: Found, key: str) -> str:
    holds = "✓ holds" if found.finding.holds else "✗ fails"
    lines = [
        f"- {holds}: {to_markdown(found.finding.what, key)}",
        f"  - {found.route}: {_how(found, key)}",
    ]
    if found.proof:
        lines.append(f"  - [{found.proof}]({found.proof}) must answer `{found.answer}`")
    if found.finding.witness:
        lines.append(f"  - at {'; '.join(_value(found, key))}")
    return "\n".join(lines)


def _how(found: Found, key: str) -> str:
    shown = found.certificate
    if shown is None:
        return to_markdown(found.how, key)
    given = (f"{name} $=$ {meaning}" for name, meaning in shown.given)
    return to_markdown(f"{shown.equation} with all positive: {'; '.join(given)}", key)


def _value(found: Found, key: str) -> Iterator[str]:
    for value in values(found.finding.witness):
        numbers = [f"= {plain_markdown(value.exact)}"] if value.exact else []
        numbers += [f"≈ {value.decimal}"] if value.decimal else []
        yield f"{to_markdown(value.name, key)} {' '.join(numbers)}"
