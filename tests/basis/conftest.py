"""The proofs of the named boxes, made once."""

from __future__ import annotations

import pytest

from meso_robust.basis import BasisProof, prove_basis
from tests.basis.examples import Example, examples


@pytest.fixture(scope="session")
def proofs() -> dict[str, tuple[Example, BasisProof, BasisProof]]:
    """Each example with the proofs of its box and of its widened box."""
    return {
        e.name: (
            e,
            prove_basis(e.part, e.contacts, e.support, e.modes, e.box),
            prove_basis(e.part, e.contacts, e.support, e.modes, e.wide_box),
        )
        for e in examples()
    }
