"""Every name that the planner's chains bear is one that is listed, with words of its own."""

from __future__ import annotations

from meso_robust.certificates.words import id_of, words
from meso_robust.primitives.names import every_obligation
from tests.polygons import planned
from tests.strategies import paper_chain


def test_names_of_proved_obligations_are_listed() -> None:
    listed = {name.key: name for name in every_obligation()}
    chains = (paper_chain(), planned("hexagon")[2], planned("L-shape")[2])
    for step in (step for chain in chains for step in chain.steps):
        for one in step.obligations:
            assert listed[one.name.key] == one.name
            assert id_of(one.name.id.value) is one.name.id
            assert "{" not in words(one.name)
