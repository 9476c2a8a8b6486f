"""Put on the path as ``sitecustomize``: notes every file that is written and every connection."""

import os
import sys

_LOG = os.environ.get("MESO_WATCHED")
_WRITES = os.O_WRONLY | os.O_RDWR | os.O_CREAT | os.O_TRUNC | os.O_APPEND
_CHANGES = (
    *("os.mkdir", "os.remove", "os.rename", "os.rmdir", "os.truncate", "os.link", "os.symlink"),
    *("os.chmod", "os.utime", "sqlite3.connect", "shutil.rmtree"),
)
_NETWORK = (
    "socket.connect",
    "socket.bind",
    "socket.getaddrinfo",
    "socket.sendto",
    "urllib.Request",
)


def _note(event: str, *what: object) -> None:
    line = "\t".join([event, *map(str, what)]) + "\n"
    os.write(_FILE, line.encode("utf-8", "surrogateescape"))


def _paths(arguments: tuple[object, ...]) -> list[str]:
    return [os.path.abspath(os.fsdecode(one)) for one in arguments if isinstance(one, str | bytes)]


def _watch(event: str, arguments: tuple[object, ...]) -> None:
    if event == "open":
        path, _, flags = arguments
        if isinstance(flags, int) and flags & _WRITES:
            _note("write", *_paths((path,)))
    elif event in _CHANGES:
        _note(event, *_paths(arguments))
    elif event in _NETWORK:
        _note(event, *arguments[1:])


if _LOG:
    _FILE = os.open(_LOG, os.O_WRONLY | os.O_APPEND)
    sys.addaudithook(_watch)
