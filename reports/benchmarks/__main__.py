"""Speed of the simulator beside its peers: ``python -m reports.benchmarks [--peers] [--out FILE]``.

Prints Markdown tables. It is no test: it asserts nothing about time. The peers (MuJoCo, pymunk,
QuantEcon) are installed by ``make benchmark``.
"""

import argparse
import os
import platform
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from reports.benchmarks import complementarity, events, processes, side_by_side, steps

_PACKAGES = ("meso-robust", "numba", "numpy", "scipy")
_PEERS = ("mujoco", "pymunk", "quantecon")


def _processor() -> str:
    """Name of the processor, where the system tells it."""
    source = Path("/proc/cpuinfo")
    lines = source.read_text(encoding="utf-8").splitlines() if source.exists() else []
    names = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.machine()


def _version(name: str) -> str:
    """Name and version of a package."""
    try:
        return f"{name} {version(name)}"
    except PackageNotFoundError:
        return f"{name} not installed"


def head(peers: bool) -> list[str]:
    """First lines of the report: machine, versions, and how to read the numbers."""
    names = _PACKAGES + (_PEERS if peers else ())
    versions = ", ".join(_version(name) for name in names)
    return [
        "# Speed of the simulator",
        "",
        f"{_processor()}, {os.cpu_count()} cores, {platform.system()}, "
        f"Python {platform.python_version()}; {versions}.",
        "",
        "Best of several runs, one thread unless said, random numbers of seed 0. CPU time is what the "
        "process itself used, wall clock includes what else ran on the machine; targets are held "
        "against CPU time, which is itself longer where another process shares the core. Made by `make benchmark`.",
        "",
    ]


def main() -> None:
    """Print the report, and write it to a file if one is named."""
    parser = argparse.ArgumentParser(prog="python -m reports.benchmarks", description=__doc__)
    parser.add_argument("--peers", action="store_true", help="time the peers as well")
    parser.add_argument("--out", type=Path, help="file to write the report to")
    chosen = parser.parse_args()
    lines = head(chosen.peers)
    lines += steps.section()
    lines += events.section()
    lines += side_by_side.section(chosen.peers)
    lines += complementarity.section(chosen.peers)
    lines += processes.threads()
    lines += processes.compiling()
    report = "\n".join(lines)
    print(report)
    if chosen.out is not None:
        chosen.out.parent.mkdir(parents=True, exist_ok=True)
        chosen.out.write_text(report, encoding="utf-8")


if __name__ == "__main__":
    main()
