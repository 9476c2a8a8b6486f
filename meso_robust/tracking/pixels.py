"""Image files to 8-bit grey: what is converted, what is scaled, what is refused."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

from meso_robust.errors import InputError
from meso_robust.reading import MIB, bytes_of

Pixels = npt.NDArray[Any]

LARGEST_IMAGE = 256 * MIB
"""Bytes of an image file."""
MOST_PIXELS = 2**26
"""Of an image or of a frame of a video, such as 8192 x 8192; more would fill the memory."""

# what a whole file ends with, up to a few bytes of padding; decoders fill the rest of a torn one in
_ENDS = {b"\x89PNG": b"IEND", b"\xff\xd8\xff": b"\xff\xd9"}
_PADDING = 64
_DEPTHS = (10, 12, 14, 16)
_HOT = 1e-4  # share of an image's pixels that may be hot: brighter than the camera's depth allows


@contextmanager
def quiet_opencv() -> Iterator[None]:
    """OpenCV without prints of its own: what matters is said by our errors."""
    log = getattr(cv2.utils, "logging", cv2)  # where the two functions are since 4.13, and before
    level = log.getLogLevel()
    log.setLogLevel(0)
    try:
        yield
    finally:
        log.setLogLevel(level)


def decoded(path: Path) -> Pixels:
    """(H, W) or (H, W, C) pixels of an image file as they are stored.

    Raises
    ------
    InputError
        The file cannot be read, is torn, or is no image.
    """
    data = bytes_of(path, "give an image", LARGEST_IMAGE)
    for start, end in _ENDS.items():
        if data.startswith(start) and end not in data[-_PADDING:]:
            raise InputError(f"{path}: truncated image; copy it again or leave it out")
    image = _opened(path, data) if data else None
    if image is None:
        raise InputError(f"{path}: cannot be decoded as an image; leave it out")
    return image


def _opened(path: Path, data: bytes) -> Pixels | None:
    # OpenCV asks for the limit once, before its first image: a small file can hold a very large one
    os.environ.setdefault("OPENCV_IO_MAX_IMAGE_PIXELS", str(MOST_PIXELS))
    try:
        return cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED)
    except cv2.error as error:
        raise InputError(
            f"{path}: cannot be decoded, or has more than {MOST_PIXELS:,} pixels; give a smaller image"
        ) from error


@dataclass(frozen=True, slots=True, kw_only=True)
class Grey:
    """How the images of a folder become grey with 8 bits, the same for all.

    Attributes
    ----------
    kind
        Type of the pixels, "uint8" or "uint16".
    channels
        1 or 3.
    bits
        Depth that is scaled to 8 bits.
    stated
        Whether the file states it.
    """

    kind: str
    channels: int
    bits: int
    stated: bool = False

    @classmethod
    def of(cls, path: Path, image: Pixels, stated_bits: int | None = None) -> Grey:
        """What the first image of a folder demands, and the depth that the file states, if it does.

        Raises
        ------
        InputError
            Its pixels are neither 8-bit or 16-bit grey nor 8-bit colour.
        """
        kind, channels = image.dtype.name, 1 if image.ndim == 2 else image.shape[2]
        if (kind, channels) not in (("uint8", 1), ("uint8", 3), ("uint16", 1)):
            raise InputError(
                f"{path}: pixels of type {kind} with {channels} channel(s); must be 8-bit grey, "
                "16-bit grey or 8-bit colour without transparency; convert the images"
            )
        if kind == "uint8":
            return cls(kind=kind, channels=channels, bits=8)
        if stated_bits is not None and 8 < stated_bits <= 16:
            return cls(kind=kind, channels=channels, bits=stated_bits, stated=True)
        return cls(
            kind=kind,
            channels=channels,
            bits=next(depth for depth in _DEPTHS if _share_beyond(image, depth) <= _HOT),
        )

    @property
    def notes(self) -> tuple[str, ...]:
        """What a user should know of the conversion."""
        if self.bits > 8:
            source = (
                "as the file states" if self.stated else "from the first image without hot pixels"
            )
            return (
                f"16-bit grey values are taken as {self.bits}-bit ones, {source}, and scaled to 8 bits",
            )
        return ("colours are converted to grey",) if self.channels == 3 else ()

    def eight_bits(self, path: Path, image: Pixels) -> npt.NDArray[np.uint8]:
        """(H, W) grey values with 8 bits.

        Raises
        ------
        InputError
            The image is not of the kind of the first one, or brighter than its depth allows.
        """
        channels = 1 if image.ndim == 2 else image.shape[2]
        if (image.dtype.name, channels) != (self.kind, self.channels):
            raise InputError(
                f"{path}: pixels of type {image.dtype.name} with {channels} channel(s), but the "
                f"first image has {self.kind} with {self.channels}; convert the images"
            )
        if self.channels == 3:
            return np.asarray(cv2.cvtColor(image, cv2.COLOR_BGR2GRAY), dtype=np.uint8)
        if self.bits == 8:
            return np.ascontiguousarray(image, dtype=np.uint8)
        beyond = _share_beyond(image, self.bits)
        if beyond > _HOT:
            raise InputError(
                f"{path}: grey values up to {int(image.max())} in {100 * beyond:.2g} % of the pixels, but "
                f"the first image was taken to be {self.bits}-bit; convert the images to 8 bits"
            )
        # rounding, not cutting: half a grey value of bias would be left otherwise
        scaled = image.astype(np.float32) * (255.0 / (2**self.bits - 1))
        return np.minimum(np.rint(scaled), 255.0).astype(np.uint8)


def _share_beyond(image: Pixels, bits: int) -> float:
    """Share of the pixels that a camera of so many bits cannot mean, one being always allowed."""
    count = int(np.count_nonzero(image >= 2**bits)) if bits < 16 else 0
    return 0.0 if count <= 1 else count / image.size
