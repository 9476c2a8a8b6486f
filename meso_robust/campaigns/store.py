"""The store of a campaign: an SQLite file with one row a finished chunk.

A row is written in a transaction of its own, so a campaign that is killed at any moment has every
chunk either whole or not at all; the key of a row makes it impossible to count a chunk twice.
"""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import astuple, dataclass
from pathlib import Path

from meso_robust.campaigns.encoding import canonical, digest, first_difference, result_of
from meso_robust.campaigns.kind import Result, Values
from meso_robust.errors import InputError

NAME = "campaign.sqlite"
APPLICATION = 0x6D65736F  # "meso", so that other SQLite files are told apart
VERSION = 1

_TABLES = """
CREATE TABLE about (key TEXT PRIMARY KEY, value TEXT NOT NULL);
CREATE TABLE result (
    part TEXT NOT NULL, chunk INTEGER NOT NULL, result TEXT NOT NULL, digest TEXT NOT NULL,
    seconds REAL NOT NULL, worker TEXT NOT NULL, PRIMARY KEY (part, chunk)
) WITHOUT ROWID;
CREATE TABLE trouble (
    at TEXT NOT NULL, part TEXT NOT NULL, chunk INTEGER NOT NULL, attempt INTEGER NOT NULL,
    what TEXT NOT NULL, given_up INTEGER NOT NULL
);
CREATE TABLE session (
    id INTEGER PRIMARY KEY, began TEXT NOT NULL, ended TEXT, crew TEXT NOT NULL,
    machine TEXT NOT NULL, runs INTEGER NOT NULL DEFAULT 0, seconds REAL NOT NULL DEFAULT 0
);
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Trouble:
    """A chunk that was not done at an attempt."""

    at: str
    """Date and time, UTC."""
    part: str
    chunk: int
    attempt: int
    """From 1."""
    what: str
    given_up: bool
    """Whether this session does not try it again."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Session:
    """A time during which someone worked on the campaign."""

    began: str
    ended: str | None
    """None if it was killed."""
    crew: str
    machine: str
    runs: int
    seconds: float
    """From its begin to its last result."""


class Store:
    """An open store; at most one process has it open.

    Raises
    ------
    InputError
        By every method: the file is in use, damaged, full, no store, or of another campaign, version
        or code.
    """

    def __init__(self, path: Path, campaign: Values, code: str) -> None:
        """Open a store, or make one.

        Parameters
        ----------
        path
            The file; made if it is not there.
        campaign
            The campaign as JSON values.
        code
            Of the package, from ``provenance.code``.
        """
        self.path = path
        with self._told():
            self._db = sqlite3.connect(path, isolation_level=None, timeout=0.5)
            try:
                self._open(campaign, code)
            except BaseException:
                self._db.close()
                raise

    def _open(self, campaign: Values, code: str) -> None:
        self._db.execute("PRAGMA locking_mode = EXCLUSIVE")
        if self._pragma("application_id") == 0 and self._pragma("schema_version") == 0:
            self._make(campaign, code)
        self._check_file()
        self._check_about(campaign, code)
        self._db.execute("PRAGMA synchronous = FULL")
        self._db.execute("PRAGMA journal_mode = WAL")

    def _make(self, campaign: Values, code: str) -> None:
        about = {"campaign": canonical(campaign), "code": code}
        rows = "".join(
            f"INSERT INTO about VALUES ('{key}', '{value.replace(chr(39), 2 * chr(39))}');"
            for key, value in about.items()
        )
        marks = f"PRAGMA application_id = {APPLICATION}; PRAGMA user_version = {VERSION};"
        self._db.executescript(f"BEGIN EXCLUSIVE; {_TABLES} {rows} {marks} COMMIT;")

    def _pragma(self, name: str) -> int:
        return int(self._db.execute(f"PRAGMA {name}").fetchone()[0])

    def _check_file(self) -> None:
        if self._pragma("application_id") != APPLICATION:
            raise InputError(
                f"{self.path}: is not a campaign store; give another folder with --out"
            )
        if self._pragma("user_version") != VERSION:
            raise InputError(
                f"{self.path}: store of version {self._pragma('user_version')}; this program writes "
                f"version {VERSION}; use the program that made it, or another folder with --out"
            )
        found = self._db.execute("PRAGMA quick_check").fetchone()[0]
        if found != "ok":
            raise sqlite3.DatabaseError(found)

    def _check_about(self, campaign: Values, code: str) -> None:
        about = dict(self._db.execute("SELECT key, value FROM about"))
        try:
            kept = json.loads(about["campaign"])
        except (KeyError, ValueError) as error:
            raise sqlite3.DatabaseError("its description cannot be read") from error
        if about["campaign"] != canonical(campaign):
            key = first_difference(kept, json.loads(canonical(campaign)))
            raise InputError(
                f"{self.path}: holds another campaign (first difference at {key}); results of "
                "different campaigns are never combined; give another folder with --out, or the "
                "original campaign file"
            )
        if about.get("code", "") != code:
            raise InputError(
                f"{self.path}: was started by different code ({about.get('code', '')[:12]}, now {code[:12]}: the "
                "package or a package it computes with has changed); results of different code are "
                "never combined; give another folder with --out, or install the original code"
            )

    @contextmanager
    def _told(self) -> Iterator[None]:
        """Whatever SQLite says, as a message to the user."""
        try:
            yield
        except sqlite3.Error as error:
            raise InputError(f"{self.path}: {_advice(error)}") from error

    def add(self, part: str, chunk: int, text: str, seconds: float, worker: str) -> bool:
        """Keep the result of a chunk; returns when it is on the disk.

        Parameters
        ----------
        part, chunk
            Name and index.
        text
            The result, canonical.
        seconds, worker
            How long it took, and where.

        Returns
        -------
        bool
            Whether it is new. A chunk that is already stored is not counted again.

        Raises
        ------
        RuntimeError
            The chunk is already stored with another result: it is not a pure function of its seed.
        """
        sealed = digest(f"{part}\0{chunk}\0{text}")
        row = (part, chunk, text, sealed, seconds, worker)
        with self._told():
            added = self._db.execute("INSERT OR IGNORE INTO result VALUES (?, ?, ?, ?, ?, ?)", row)
            if added.rowcount == 1:
                return True
            query = "SELECT digest FROM result WHERE part = ? AND chunk = ?"
            known = self._db.execute(query, (part, chunk)).fetchone()[0]
        if known != sealed:
            raise RuntimeError(f"part {part!r}, chunk {chunk}: done twice with different results")
        return False

    def done(self, part: str) -> set[int]:
        """Chunks of a part that are kept."""
        with self._told():
            query = "SELECT chunk FROM result WHERE part = ?"
            return {row[0] for row in self._db.execute(query, (part,))}

    def results(self, part: str) -> Iterator[tuple[int, Result]]:
        """Chunks and their results in the order of the chunks, each held against its digest."""
        with self._told():
            query = "SELECT chunk, result, digest FROM result WHERE part = ? ORDER BY chunk"
            for chunk, text, sealed in self._db.execute(query, (part,)):
                if digest(f"{part}\0{chunk}\0{text}") != sealed:
                    raise InputError(
                        f"{self.path}: part {part!r}, chunk {chunk}: damaged, its digest differs; "
                        "restore the file from a backup, or start over in another folder (--out)"
                    )
                yield chunk, result_of(text)

    def seconds(self, part: str) -> float:
        """Time of all kept chunks of a part, summed over the workers."""
        with self._told():
            query = "SELECT COALESCE(SUM(seconds), 0) FROM result WHERE part = ?"
            return float(self._db.execute(query, (part,)).fetchone()[0])

    def note(self, trouble: Trouble) -> None:
        """Keep that a chunk was not done."""
        with self._told():
            self._db.execute("INSERT INTO trouble VALUES (?, ?, ?, ?, ?, ?)", astuple(trouble))

    def troubles(self) -> tuple[Trouble, ...]:
        """All that was noted, in time."""
        names = ("at", "part", "chunk", "attempt", "what", "given_up")
        with self._told():
            rows = self._db.execute(f"SELECT {', '.join(names)} FROM trouble ORDER BY rowid")
            found = [dict(zip(names, row, strict=True)) for row in rows]
        return tuple(Trouble(**{**one, "given_up": bool(one["given_up"])}) for one in found)

    def begin(self, session: Session) -> int:
        """Note the begin of a session; its number."""
        with self._told():
            added = self._db.execute(
                "INSERT INTO session (began, crew, machine) VALUES (?, ?, ?)",
                (session.began, session.crew, session.machine),
            )
            return int(added.lastrowid or 0)

    def progress(self, session: int, runs: int, seconds: float, ended: str | None = None) -> None:
        """Note what a session has done so far."""
        with self._told():
            self._db.execute(
                "UPDATE session SET runs = ?, seconds = ?, ended = ? WHERE id = ?",
                (runs, seconds, ended, session),
            )

    def sessions(self) -> tuple[Session, ...]:
        """All sessions, the first one first."""
        names = ("began", "ended", "crew", "machine", "runs", "seconds")
        with self._told():
            rows = self._db.execute(f"SELECT {', '.join(names)} FROM session ORDER BY id")
            return tuple(Session(**dict(zip(names, row, strict=True))) for row in rows)

    def close(self) -> None:
        """Bring everything into the one file and let go of it."""
        self._db.close()


def _advice(error: sqlite3.Error) -> str:
    """What SQLite says, and what to do."""
    # the lowest byte is the primary code; an error that is raised here has none
    code = getattr(error, "sqlite_errorcode", sqlite3.SQLITE_ERROR) & 0xFF
    if code in (sqlite3.SQLITE_BUSY, sqlite3.SQLITE_LOCKED):
        return "is in use by another campaign that runs; wait for it, or give another --out"
    if code in (sqlite3.SQLITE_FULL, sqlite3.SQLITE_IOERR):
        return (
            f"cannot be written ({error}); nothing that was done is lost: free some space and give "
            "the same command with --resume"
        )
    if code in (sqlite3.SQLITE_CANTOPEN, sqlite3.SQLITE_READONLY):
        return f"cannot be opened for writing ({error}); give another folder with --out"
    return (
        f"is damaged or not a campaign store ({error}); restore it from a backup, or start over in "
        "another folder (--out)"
    )
