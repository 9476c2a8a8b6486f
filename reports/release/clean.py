"""Wheel and sdist, each installed with its dependencies into a clean environment, and used there.

``python -m reports.release.clean [FOLDER]`` (``make package``); takes minutes, needs the package index.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).parents[2]


def told(*words: str | Path, cwd: Path, status: int = 0) -> str:
    """Run a command that must end with a status; say how long it took."""
    before = time.monotonic()
    done = subprocess.run(words, cwd=cwd, capture_output=True, text=True, check=False)
    shown = " ".join(str(word) for word in words[1:])
    print(f"  {time.monotonic() - before:6.1f} s  status {done.returncode}  {shown}", flush=True)
    if done.returncode != status:
        sys.exit(f"expected status {status}:\n{done.stdout}{done.stderr}")
    return done.stdout


def used(package: Path, folder: Path) -> None:
    """Install a package and do the main job with it."""
    print(package.name, flush=True)
    uv = (sys.executable, "-m", "uv", "--quiet")
    venv = folder / "venv"
    told(*uv, "venv", "--clear", f"--python={sys.executable}", venv, cwd=folder)
    python, verb = venv / "bin" / "python", venv / "bin" / "meso-robust"
    told(*uv, "pip", "install", f"--python={python}", package, cwd=folder)
    version = told(verb, "--version", cwd=folder)
    if "not a checkout" not in version or str(venv) not in version:
        sys.exit(f"runs another package than the one installed:\n{version}")
    told(verb, "schema", "task", cwd=folder)
    told(verb, "plan", "--samples", "100", "--out", "plan", cwd=folder)
    told(verb, "check", "plan/certificate.json", cwd=folder)
    told(verb, "derive", "--check", cwd=folder, status=2)  # it needs a checkout, and says so


def main() -> None:
    """Build both and use each."""
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else tempfile.mkdtemp()).resolve()
    try:
        told(
            sys.executable, "-m", "uv", "--quiet", "build", f"--out-dir={folder}", ROOT, cwd=folder
        )
        for pattern in ("*.whl", "*.tar.gz"):
            used(next(folder.glob(pattern)), folder)
    finally:
        if len(sys.argv) == 1:
            shutil.rmtree(folder)


if __name__ == "__main__":
    main()
