"""The example database: failing examples that were found once are tried again every time."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from hypothesis.database import DirectoryBasedExampleDatabase

from meso_robust.campaigns.kind import MOST_FAILURES, Failure, Part, Result, Values
from meso_robust.campaigns.property.law import Property
from meso_robust.campaigns.property.registry import PROPERTIES
from meso_robust.campaigns.property.search import Searched, key_of, replayed


def failure_of(of: Property, found: Searched) -> Failure | None:
    """A breach as a failure of the campaign."""
    if found.breach is None:
        return None
    return Failure(
        what=found.breach.what,
        detail=f"{of.name}: {found.breach.detail}; example: {found.example}",
        files=found.breach.files,
    )


def entries_of(results: Iterable[Values]) -> list[list[str]]:
    """Key and value, hexadecimal, of all failing examples in ``values`` of results, each once."""
    found = {(str(key), str(value)) for values in results for key, value in values["entries"]}
    return [list(entry) for entry in sorted(found)]


def keep(folder: Path, values: Values) -> None:
    """Save the failing examples of a chunk's (or a part's) values; doing it twice changes nothing.

    Raises
    ------
    OSError
        The folder cannot be written to.
    """
    database = DirectoryBasedExampleDatabase(folder)
    for key, value in values["entries"]:
        database.save(bytes.fromhex(key), bytes.fromhex(value))
        if bytes.fromhex(value) not in set(database.fetch(bytes.fromhex(key))):
            raise OSError(f"{folder}: a failing example could not be written to it")


def replay(part: Part, folder: Path) -> Result:
    """Try every kept example of the part's properties again; nothing is drawn, nothing removed.

    Returns
    -------
    Result
        ``runs`` counts the examples that were tried, ``failed`` those that still break their property.
        ``values["replayed"]`` has both for each property that has any.
    """
    runs, failures, counts = 0, [], {}
    database = DirectoryBasedExampleDatabase(folder)
    for name in part.asked["properties"]:
        of = PROPERTIES[name]
        found = [replayed(of, entry) for entry in sorted(database.fetch(key_of(of)))]
        failed = [failure for one in found if (failure := failure_of(of, one)) is not None]
        tried = sum(one.examples > 0 for one in found)
        if tried:
            counts[name] = [tried, len(failed)]
        runs += tried
        failures += failed
    return Result(
        runs=runs,
        failed=len(failures),
        failures=tuple(failures[:MOST_FAILURES]),
        values={"replayed": counts},
    )
