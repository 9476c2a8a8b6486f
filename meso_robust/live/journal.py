"""The journal of a run: every reading and what was commanded on it, so that it can be replayed exactly.

JSON lines. The first states task, plan and laboratory; every other one a turn of the loop. A line is written
before its commands are carried out, so that a killed run has done nothing that its journal does not hold.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import IO, Any

from meso_robust.errors import InputError
from meso_robust.live.conductor import Conductor, Decide, Phase
from meso_robust.live.exchange import Command, Reading, reading_of
from meso_robust.live.lab_file import Lab, parse_lab
from meso_robust.live.sight import Trust
from meso_robust.reading import text_of

SCHEMA = "meso-robust/journal/1"


@dataclass(frozen=True, slots=True, kw_only=True)
class Header:
    """What a run was given."""

    task_hash: str
    plan_hash: str
    lab: Lab
    trust: Trust
    confirm: bool
    dry: bool
    version: str
    started: str
    """Date and time, for the reader."""

    def document(self) -> dict[str, Any]:
        """As the first line keeps it."""
        rest = {"lab": self.lab.model_dump(mode="json", by_alias=True), "trust": asdict(self.trust)}
        plain = ("task_hash", "plan_hash", "confirm", "dry", "version", "started")
        return {"schema": SCHEMA, **{name: getattr(self, name) for name in plain}, **rest}


@dataclass(frozen=True, slots=True, kw_only=True)
class Turn:
    """A turn of the loop."""

    reading: Reading
    phase: str
    """After the commands."""
    commands: tuple[dict[str, Any], ...]
    sensed: tuple[float, float, float] | None
    """The pose that the controller was given in this turn; um and deg."""
    move: dict[str, Any] | None
    """What it answered, if that is a move."""

    @property
    def said(self) -> str:
        """Everything that follows from the readings, as the journal has it."""
        values = {
            "phase": self.phase,
            "commands": list(self.commands),
            "sensed": self.sensed,
            "move": self.move,
        }
        return json.dumps(values, allow_nan=False)


def turn_of(conductor: Conductor, reading: Reading) -> tuple[Turn, tuple[Command, ...]]:
    """One turn of the loop.

    Parameters
    ----------
    conductor
        It goes on.
    reading
        What was read.

    Returns
    -------
    tuple
        What the journal keeps, and the commands.
    """
    before = conductor.move
    commands = conductor.step(reading)
    decided = conductor.move is not before
    move = dict(conductor.move) if decided and conductor.move is not None else None
    turn = Turn(
        reading=reading,
        phase=conductor.phase.value,
        commands=tuple(command.document() for command in commands),
        sensed=conductor.sensed if decided else None,
        move=move,
    )
    return turn, commands


class Journal:
    """Writes a journal; with no file, it only keeps the turns."""

    def __init__(self, path: Path | None, header: Header) -> None:
        self.header, self.turns = header, list[Turn]()
        self._file: IO[str] | None = None
        if path is not None:
            path.parent.mkdir(parents=True, exist_ok=True)
            self._file = path.open("w", encoding="utf-8")
            self._line(header.document())

    def add(self, turn: Turn) -> None:
        """Write a turn, before its commands are carried out."""
        self.turns.append(turn)
        self._line({"reading": turn.reading.document(), **json.loads(turn.said)})

    def _line(self, values: dict[str, Any]) -> None:
        if self._file is not None:
            self._file.write(json.dumps(values, allow_nan=False) + "\n")
            self._file.flush()

    def close(self) -> None:
        """End the file."""
        if self._file is not None:
            self._file.close()


def read_journal(path: Path) -> tuple[Header, list[Turn]]:
    """Read a journal; a last line that a killed run left half is left out.

    Parameters
    ----------
    path
        The file.

    Returns
    -------
    tuple
        What the run was given, and its turns.

    Raises
    ------
    InputError
        It cannot be read, or is no journal.
    """
    advice = "give its journal.jsonl"
    lines = text_of(path, advice, "a journal").split("\n")
    try:
        first = json.loads(lines[0])
        if first.get("schema") != SCHEMA:
            raise ValueError(f"schema = {first.get('schema')!r}")
        plain = ("task_hash", "plan_hash", "confirm", "dry", "version", "started")
        header = Header(
            **{name: first[name] for name in plain},
            lab=parse_lab(first["lab"], str(path)),
            trust=Trust(**first["trust"]),
        )
        return header, list(_turns(lines[1:-1]))  # what follows the last newline is no whole line
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise InputError(f"{path}: is no journal of meso-robust run ({error}); {advice}") from error


def _turns(lines: Sequence[str]) -> Iterator[Turn]:
    for line in lines:
        values = json.loads(line)
        sensed = values["sensed"]
        yield Turn(
            reading=reading_of(values["reading"]),
            phase=values["phase"],
            commands=tuple(values["commands"]),
            sensed=None if sensed is None else (sensed[0], sensed[1], sensed[2]),
            move=values["move"],
        )


def replayed(header: Header, turns: Sequence[Turn], decide: Decide) -> int | None:
    """Run the loop again on the readings of a journal.

    Parameters
    ----------
    header, turns
        As read.
    decide
        The controller for the same task and plan, from its beginning.

    Returns
    -------
    int or None
        The first turn, from 1, in which it decides or commands anything else; None if there is none.
    """
    conductor = Conductor(header.lab, decide, header.trust, confirm=header.confirm, dry=header.dry)
    for k, turn in enumerate(turns):
        again, _ = turn_of(conductor, turn.reading)
        if again.said != turn.said:
            return k + 1
    return None


def ended(turns: Sequence[Turn]) -> bool:
    """Whether a run came to its end.

    Parameters
    ----------
    turns
        Of its journal.

    Returns
    -------
    bool
        False of one that was killed.
    """
    return bool(turns) and turns[-1].phase == Phase.ENDED.value
