"""``meso-robust derive``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from meso_robust.cli.console import Reporter, negative, refuse
from meso_robust.files import write_all

if TYPE_CHECKING:
    from derivations._derivation import Derivation


def derive(
    check: Annotated[
        bool, typer.Option("--check", help="Write nothing; fail if anything on disk differs.")
    ] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print the verdicts as JSON.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Print only the result.")] = False,
) -> None:
    """Derive and prove or refute every claim that the paper prints; regenerate the code made from them."""
    from derivations import generate, report

    if not (generate.ROOT / "pyproject.toml").exists():
        refuse("derive: runs in a checkout of the project only, where the derivations are kept")
    with Reporter(quiet or as_json).doing("deriving and proving"):
        derivations, files = _derived(keep=not check)
    stale = generate.on_disk() - set(files)
    differing = stale | _differing(files)
    if not report.PAGE.exists():
        differing.discard(report.PAGE)  # a fresh checkout has none, and need not
    if not check:
        _write(files)
        for path in stale:
            path.unlink()
    if as_json:
        print(files[report.FOLDER / "register.json"], end="")
    elif not quiet:
        for claim in (claim for d in derivations for claim in d.claims):
            print(f"{claim.verdict.words:32} {claim.key}: {claim.title} [{claim.place}]")
    if check and differing:
        names = ", ".join(sorted(str(path.relative_to(generate.ROOT)) for path in differing))
        negative(
            f"derive --check: differs from what is derived: {names}; run `meso-robust derive` "
            "and look at the change before committing it"
        )


def _derived(*, keep: bool) -> tuple[tuple[Derivation, ...], dict[Path, str]]:
    """All derivations and the files they give; with ``keep`` the generated code is written."""
    from derivations import generate, report
    from derivations._statement import DerivationError

    try:
        derivations = generate.derive_all()
        files = generate.code(derivations)
        if keep:
            _write(files)  # the report's figures are drawn with the new code
        return derivations, files | report.render(derivations)
    except ModuleNotFoundError as error:
        refuse(f"derive: needs {error.name}; install the project with its extra `derive`")
    except DerivationError as error:
        negative(f"derive: a step does not hold: {error}")


def _differing(files: dict[Path, str]) -> set[Path]:
    return {
        path
        for path, text in files.items()
        if not path.exists() or path.read_text(encoding="utf-8") != text
    }


def _write(files: dict[Path, str]) -> None:
    """Write what differs, each file whole or not at all."""
    for path in sorted(_differing(files)):
        write_all(path.parent, {path.name: files[path]})
