"""Results of the long steps on disk, so that an interrupted diagnosis can resume."""

from __future__ import annotations

import hashlib
import re
import zipfile
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

import numpy as np

from meso_robust.copies import shared
from meso_robust.identification.problem import Fits, Fitted
from meso_robust.types import Floats

_OWN = re.compile(r"[0-9a-f]{32}(\.part)?\.npz")


@dataclass(frozen=True, slots=True)
class Store:
    """Arrays by name, of one diagnosis only.

    Attributes
    ----------
    folder
        Where they are kept; None to keep nothing.
    identity
        Of recordings, options and version: results of another diagnosis are never taken up.
    ready
        What was made ahead, until it is asked for.
    """

    folder: Path | None
    identity: str
    ready: dict[str, Mapping[str, Floats]] = field(default_factory=dict, compare=False)

    def kept(self, name: str, make: Callable[[], Mapping[str, Floats]]) -> Mapping[str, Floats]:
        """The arrays of a name: from disk, or made and put there.

        A file that cannot be read, as one of a killed run, is made again.
        """
        if name in self.ready:
            return self.ready.pop(name)
        if self.folder is None:
            return make()
        key = hashlib.sha256(f"{self.identity}\n{name}".encode()).hexdigest()[:32]
        path = self.folder / f"{key}.npz"
        try:
            with path.open("rb") as file, np.load(file, allow_pickle=False) as found:
                return {entry: found[entry] for entry in found.files}
        except (OSError, ValueError, EOFError, zipfile.BadZipFile):
            pass
        made = make()
        self.folder.mkdir(parents=True, exist_ok=True)
        unfinished = path.with_suffix(".part.npz")
        np.savez(unfinished, allow_pickle=False, **made)
        unfinished.replace(path)
        return made

    def ahead(self, makes: Mapping[str, Callable[[], Mapping[str, Floats]]]) -> None:
        """Make arrays that are asked for next, with the help of copies of this process where these are allowed.

        What cannot be made is left, and fails where it is asked for.
        """

        def made(name: str) -> Mapping[str, Floats] | None:
            with suppress(ValueError, np.linalg.LinAlgError):
                return self.kept(name, makes[name])
            return None

        if len(makes) > 1:
            found = zip(makes, shared(made, makes), strict=True)
            self.ready.update({name: of for name, of in found if of is not None})

    def clear(self) -> None:
        """Remove what was kept, of any diagnosis, and the folder unless it holds something else."""
        if self.folder is None or not self.folder.is_dir():
            return
        with suppress(OSError):
            for path in self.folder.iterdir():
                if _OWN.fullmatch(path.name):
                    path.unlink()
            self.folder.rmdir()


NOWHERE = Store(None, "")
"""Keeps nothing."""


def kept_fit(store: Store, name: str, make: Callable[[], Fitted]) -> Fitted:
    """A fit of a name: from disk, or made and put there."""
    return _unpacked(store.kept(name, partial(_packed_of, make)))


def fits_ahead(store: Store, makes: Mapping[str, Callable[[], Fitted]]) -> None:
    """Make fits by name that are asked for next, as `Store.ahead`."""
    store.ahead({name: partial(_packed_of, make) for name, make in makes.items()})


def _packed_of(make: Callable[[], Fitted]) -> dict[str, Floats]:
    return _packed(make())


def _packed(found: Fitted) -> dict[str, Floats]:
    fits = found.fits
    return {
        "values": fits.values,
        "starts": fits.starts,
        "offsets": fits.offsets,
        "chi2": fits.chi2,
        "residuals": fits.residuals,
        "outcomes": fits.outcomes.astype(float),
        "information": found.information,
        "gradients": found.gradients,
        "jacobian": np.asarray(found.jacobian),
        "converged": found.converged.astype(float),
        "iterations": np.array([float(found.iterations)]),
    }


def _unpacked(of: Mapping[str, Floats]) -> Fitted:
    fits = Fits(
        values=of["values"],
        starts=of["starts"],
        offsets=of["offsets"],
        chi2=of["chi2"],
        residuals=of["residuals"],
        outcomes=of["outcomes"].astype(np.int8),
    )
    return Fitted(
        fits=fits,
        information=of["information"],
        gradients=of["gradients"],
        jacobian=of["jacobian"],
        converged=of["converged"] != 0.0,
        iterations=int(of["iterations"][0]),
    )
