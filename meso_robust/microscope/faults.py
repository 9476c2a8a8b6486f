"""What goes wrong with recordings of a microscope, on purpose, for tests."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt

AnyImage = npt.NDArray[np.uint8] | npt.NDArray[np.uint16]
_TINT = (0.80, 0.95, 1.05)  # blue, green, red of warm light on copper
_CLOTH = 0.15  # brightness of what covers the view, relative to white


@dataclass(frozen=True, slots=True, kw_only=True)
class Faults:
    """Faults of a film. Frames are counted as filmed, before any is dropped.

    Attributes
    ----------
    dropped
        Frames that are missing: in the film and in the truth.
    frozen
        Frames that show the one before once more; the truth goes on.
    covered
        Frames in which something dark hides all of the view.
    colour
        8 bit BGR instead of grey.
    sixteen_bit
        16 bit grey (0 to 65535), which only a folder of images can hold.
    """

    dropped: tuple[int, ...] = ()
    frozen: tuple[int, ...] = ()
    covered: tuple[int, ...] = ()
    colour: bool = False
    sixteen_bit: bool = False


NONE = Faults()


def spoiled(images: Iterable[npt.NDArray[np.uint8]], faults: Faults) -> Iterator[AnyImage]:
    """The images with faults."""
    shown = None
    for number, image in enumerate(images):
        seen = covered(image) if number in faults.covered else image
        shown = seen if shown is None or number not in faults.frozen else shown
        if number not in faults.dropped:
            yield _in_format(shown, faults)


def covered(image: npt.NDArray[np.uint8]) -> npt.NDArray[np.uint8]:
    """An image in which a dark thing, out of focus, hides everything."""
    v, u = np.mgrid[0.0 : 1.0 : image.shape[0] * 1j, 0.0 : 1.0 : image.shape[1] * 1j]
    return np.asarray(255.0 * _CLOTH * (1.0 + 0.3 * u - 0.2 * v), dtype=np.uint8)


def coloured(image: npt.NDArray[np.uint8]) -> npt.NDArray[np.uint8]:
    """(height, width, 3) BGR of a grey image in the warm light of copper."""
    channels = [cv2.convertScaleAbs(image, alpha=tint) for tint in _TINT]
    return np.asarray(cv2.merge(channels), dtype=np.uint8)


def deep(image: npt.NDArray[np.uint8]) -> npt.NDArray[np.uint16]:
    """The image in 16 bit, white at 65535."""
    return image.astype(np.uint16) * np.uint16(257)


def truncate(path: Path, share: float) -> None:
    """Cut a file to this share of its bytes, as a full disk or a pulled cable does."""
    content = path.read_bytes()
    path.write_bytes(content[: int(share * len(content))])


def _in_format(image: npt.NDArray[np.uint8], faults: Faults) -> AnyImage:
    if faults.sixteen_bit:
        return deep(image)
    return coloured(image) if faults.colour else image
