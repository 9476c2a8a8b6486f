"""``meso-robust derive``."""

from __future__ import annotations

import json
import sys
from typing import Annotated

import typer

from meso_robust.cli.console import NEGATIVE, Reporter, negative, refuse


def derive(
    check: Annotated[
        bool, typer.Option("--check", help="Write nothing; fail if anything on disk differs.")
    ] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print the verdicts as JSON.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Say nothing but the result.")] = False,
) -> None:
    """Regenerate the derivations and the code that comes from them; print the verdicts."""
    from derivations._derivation import DerivationError
    from derivations.generate import ROOT, derive_all, render

    if not (ROOT / "pyproject.toml").exists():
        refuse("derive: runs in a checkout of the project only, where the derivations are kept")
    try:
        with Reporter(quiet).doing("deriving"):
            derivations = derive_all()
    except DerivationError as error:
        negative(f"derive: a step does not hold: {error}")
    files = render(derivations)
    differing = [
        path
        for path, text in files.items()
        if not path.exists() or path.read_text(encoding="utf-8") != text
    ]
    if not check:
        for path in differing:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(files[path], encoding="utf-8")
    statements = [(d, s) for d in derivations for s in d.statements]
    if as_json:
        rows = [
            {
                "place": s.place,
                "derived": s.text,
                "verdict": s.status.name,
                "derivation": f"derivations/{d.name}.py",
            }
            for d, s in statements
        ]
        print(json.dumps(rows, indent=2))
    elif not quiet:
        for _, s in statements:
            print(f"{s.status.name:10} {s.place}: {s.text}")
    if check and differing:
        names = ", ".join(str(path.relative_to(ROOT)) for path in differing)
        print(
            f"meso-robust: derive --check: differs from what is derived: {names}; "
            "run `meso-robust derive` and commit",
            file=sys.stderr,
        )
        raise typer.Exit(NEGATIVE)
