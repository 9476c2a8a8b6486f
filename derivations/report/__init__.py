"""The register of claims as files for readers: a page, Markdown, JSON, pictures and stored proofs."""

from __future__ import annotations

from pathlib import Path

from derivations._derivation import Derivation

FOLDER = Path(__file__).resolve().parents[2] / "reports" / "derivations"
PAGE = FOLDER / "index.html"
"""Not kept with the sources, as everything on it is in the other files too."""


def render(derivations: tuple[Derivation, ...]) -> dict[Path, str]:
    """File contents by path, all below ``reports/derivations``: the same bytes every time.

    Parameters
    ----------
    derivations
        What the derivation files return, in the order in which the register shows them.

    Returns
    -------
    dict[Path, str]
        Pages, stored proofs and pictures.

    Raises
    ------
    DerivationError
        If a text cannot be typeset, or a key is missing, malformed or not unique.
    """
    # imported here: drawing brings in the package, which itself needs the generated code to exist
    from derivations.report.figures import pictures
    from derivations.report.markdown import markdown
    from derivations.report.page import page
    from derivations.report.register import as_json, chapters, proof_files

    register, drawn = chapters(derivations), pictures()
    files = {
        PAGE.name: page(register, drawn),
        "README.md": markdown(register, drawn),
        "register.json": as_json(register),
        **proof_files(register),
        **{picture.file: picture.standalone for picture in drawn},
    }
    return {FOLDER / name: text for name, text in files.items()}
