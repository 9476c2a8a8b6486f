"""What these recordings could not show, however true, and which effects look alike in them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from meso_robust.diagnosis.signatures import Signature
from meso_robust.diagnosis.tangent import Tangent
from meso_robust.types import Floats

SEEN = 5.0
"""σ by which an effect of relevant size must change the recordings to count as visible."""
_ALIKE = 0.99  # cosine beyond which two signatures are one


@dataclass(frozen=True, slots=True, kw_only=True)
class Visibility:
    """How well an effect shows.

    Attributes
    ----------
    effect
        Name.
    sigma
        By how much the best of its forms changes the recordings at a relevant size, beyond what a
        refit could take.
    alike
        Effects whose signature is the same.
    """

    effect: str
    sigma: float
    alike: tuple[str, ...]

    @property
    def seen(self) -> bool:
        """Whether the recordings could show it."""
        return self.sigma >= SEEN


def visibilities(at: Tangent, signatures: list[Signature]) -> tuple[Visibility, ...]:
    """Visibility of every effect in the recordings of a fit."""
    left = {id(one): one.left(at) for one in signatures}
    best: dict[str, Signature] = {}
    for one in signatures:
        name = one.trial.effect
        if name not in best or _size(left[id(one)]) > _size(left[id(best[name])]):
            best[name] = one
    spaces = {name: _space(left[id(one)]) for name, one in best.items()}
    return tuple(
        Visibility(
            effect=name,
            sigma=_size(left[id(one)]),
            alike=tuple(
                other
                for other, space in spaces.items()
                if other != name and _contains(space, spaces[name])
            ),
        )
        for name, one in best.items()
    )


def _size(left: Floats) -> float:
    """Length of the longest change."""
    return float(np.linalg.norm(left, axis=1).max(initial=0.0))


def _space(left: Floats) -> Floats:
    """(RM, k) orthonormal."""
    if not np.any(left):
        return np.zeros((left.shape[1], 0))
    ways, sizes, _ = np.linalg.svd(left.T, full_matrices=False)
    return np.asarray(ways[:, sizes > 1e-3 * sizes[0]])


def _contains(whole: Floats, part: Floats) -> bool:
    """Whether one space holds all directions of another, nearly."""
    if not part.shape[1] or whole.shape[1] < part.shape[1]:
        return False
    return bool(np.linalg.svd(whole.T @ part, compute_uv=False).min() > _ALIKE)
