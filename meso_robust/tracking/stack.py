"""TIFF and OME-TIFF files page by page: how many there are, what they say, their pixels.

Pages without compression are read by tifffile, from their own place in the file. The others are
decoded by OpenCV, which unpacks strip by strip and so never more than the image holds.
"""

from __future__ import annotations

import logging
import math
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
import tifffile

from meso_robust.errors import InputError
from meso_robust.tracking.pixels import MOST_PIXELS, Pixels, quiet_opencv
from meso_robust.tracking.stack_metadata import Metadata, imagej, ome

SUFFIXES = {".tif", ".tiff"}
MOST_PAGES = 1_000_000
"""Pages of one file."""
_BATCH = 2**25  # pixels that are decoded at a time
_UNPACKED, _DEFLATE = 1, (8, 32946)  # TIFF's codes of compressions
_BLACK_IS_ZERO, _RGB = 1, 2  # TIFF's codes of what pixels mean

# what tifffile has to say of a damaged file is said by our errors
logging.getLogger("tifffile").addHandler(logging.NullHandler())


@dataclass(frozen=True, slots=True, kw_only=True)
class Stack:
    """A TIFF file.

    Attributes
    ----------
    path
        The file.
    pages
        Pages that are there whole.
    size
        Width and height in pixels.
    broken
        What is missing of a truncated file, in words; empty if it is whole.
    metadata
        What the file says beside its pixels.
    """

    path: Path
    pages: int
    size: tuple[int, int]
    broken: str
    metadata: Metadata


def page_count(path: Path) -> int:
    """Pages in a TIFF file's list, whole or not.

    Raises
    ------
    InputError
        It is no TIFF file, or has too many.
    """
    with _opened(path) as file:
        return _counted(path, file)


def open_stack(path: Path, clock: bool = True) -> Stack:
    """Look through a TIFF file without decoding it.

    Parameters
    ----------
    path
        The file.
    clock
        Whether what it says of time and size is wanted; otherwise it is not looked at.

    Raises
    ------
    InputError
        It is no TIFF file, its pages differ, or they are not one series in time.
    """
    with _opened(path) as file:
        count, length = _counted(path, file), path.stat().st_size
        first = _checked(path, file.pages[0])
        whole = count
        for k in range(count):
            page = file.pages[k].aspage()
            if (page.shape, page.dtype) != (first.shape, first.dtype):
                raise InputError(
                    f"{path}: page {k + 1} is {page.shape} of {page.dtype}, but the first is "
                    f"{first.shape} of {first.dtype}; must be of one kind; save them as one series"
                )
            ends = map(sum, zip(page.dataoffsets, page.databytecounts, strict=True))
            if any(end > length for end in ends):
                whole = k
                break
        metadata = _metadata(path, file, count) if clock else Metadata()
        return Stack(
            path=path,
            pages=whole,
            size=(first.shape[1], first.shape[0]),
            broken=_missing(whole, count, metadata.promised or _described(file), _goes_on(file)),
            metadata=metadata,
        )


def read_pages(stack: Stack) -> Iterator[Pixels]:
    """(H, W) or (H, W, 3) pixels of the whole pages; colours in OpenCV's order.

    Raises
    ------
    InputError
        A page cannot be decoded.
    """
    with _opened(stack.path) as file:
        packing = int(file.pages[0].aspage().compression)
        if packing != _UNPACKED:
            yield from _unpacked(stack, file if packing in _DEFLATE else None)
            return
        for k in range(stack.pages):
            try:
                image = file.pages[k].asarray()
            except (ValueError, OSError, RuntimeError, tifffile.TiffFileError) as error:
                raise _undecoded(stack.path, k) from error
            yield image if image.ndim == 2 else np.ascontiguousarray(image[:, :, ::-1])


def _unpacked(stack: Stack, deflated: tifffile.TiffFile | None) -> Iterator[Pixels]:
    """Pages that are compressed, some at a time: OpenCV walks from the first to each batch."""
    batch = max(1, min(256, _BATCH // math.prod(stack.size)))
    for start in range(0, stack.pages, batch):
        count = min(batch, stack.pages - start)
        with quiet_opencv():
            try:
                good, images = cv2.imreadmulti(
                    str(stack.path), start, count, flags=cv2.IMREAD_UNCHANGED
                )
            except cv2.error as error:
                raise _undecoded(stack.path, start) from error
        if not good or len(images) != count:
            raise _undecoded(stack.path, start + len(images))
        for k, image in enumerate(images, start):
            if deflated is not None:
                _check_sums(stack, deflated, k)
            yield image


def _check_sums(stack: Stack, file: tifffile.TiffFile, k: int) -> None:
    """Refuse a page whose sums do not fit: OpenCV would leave the rest of it as it comes."""
    page, most = file.pages[k].aspage(), 8 * math.prod(stack.size)
    for at, count in zip(page.dataoffsets, page.databytecounts, strict=True):
        file.filehandle.seek(at)
        unpacking = zlib.decompressobj()
        try:
            unpacking.decompress(file.filehandle.read(count), most)
        except zlib.error as error:
            raise _undecoded(stack.path, k) from error
        if not unpacking.eof:
            raise _undecoded(stack.path, k)


def _undecoded(path: Path, page: int) -> InputError:
    return InputError(
        f"{path}: page {page + 1} cannot be decoded; save the stack without compression or with "
        "LZW or Deflate, or copy it again"
    )


@contextmanager
def _opened(path: Path) -> Iterator[tifffile.TiffFile]:
    try:
        # one file only: what OME-XML names beside it is not ours to open
        file = tifffile.TiffFile(path, _multifile=False)
    except (ValueError, OSError, tifffile.TiffFileError) as error:
        raise InputError(f"{path}: cannot be read as a TIFF file; leave it out") from error
    try:
        yield file
    finally:
        file.close()


def _counted(path: Path, file: tifffile.TiffFile) -> int:
    try:
        count = len(file.pages)
    except (ValueError, OSError, IndexError, tifffile.TiffFileError) as error:
        raise InputError(f"{path}: its list of pages is damaged; copy it again") from error
    if not 0 < count <= MOST_PAGES:
        raise InputError(f"{path}: {count} pages; must be 1 to {MOST_PAGES:,}; split it")
    return count


def _checked(path: Path, page: tifffile.TiffPage | tifffile.TiffFrame) -> tifffile.TiffPage:
    """The first page, of a kind that can be read."""
    first = page.aspage()
    height, width = (*first.shape, 0, 0)[:2]
    if not 0 < height * width <= MOST_PIXELS:
        raise InputError(
            f"{path}: pages of {width} x {height} pixels; must have at most {MOST_PIXELS:,}; "
            "scale the images down"
        )
    grey = first.photometric == _BLACK_IS_ZERO and len(first.shape) == 2
    colour = first.photometric == _RGB and first.shape[2:] == (3,)
    if not (grey or colour):
        raise InputError(
            f"{path}: pages of shape {first.shape} with photometric interpretation "
            f"{int(first.photometric)}; must be grey with black as zero, or RGB; convert the images"
        )
    return first


def _metadata(path: Path, file: tifffile.TiffFile, count: int) -> Metadata:
    first = file.pages[0].aspage()
    if file.is_ome:
        return ome(path, first.description, count)
    if file.is_imagej:
        density = [first.tags.valueof(name, (0, 1)) for name in ("XResolution", "YResolution")]
        x, y = (above / below if below else 0.0 for above, below in density)
        return imagej(path, file.imagej_metadata or {}, (x, y))
    return Metadata()


def _described(file: tifffile.TiffFile) -> int | None:
    """Pages that a file of tifffile's own says it has."""
    shapes = file.shaped_metadata
    if not shapes or file.pages[0].aspage().is_ome:
        return None
    shape = tuple(shapes[0].get("shape", ()))
    page = file.pages[0].aspage().shape
    return math.prod(shape[: -len(page)]) if shape[-len(page) :] == page else None


def _goes_on(file: tifffile.TiffFile) -> bool:
    """Whether the last page that could be found names one after it."""
    form, handle = file.tiff, file.filehandle
    handle.seek(file.pages[-1].offset)
    tags = int.from_bytes(handle.read(form.tagnosize), "big" if form.byteorder == ">" else "little")
    handle.seek(tags * form.tagsize, 1)
    return any(handle.read(form.offsetsize))


def _missing(whole: int, count: int, promised: int | None, goes_on: bool) -> str:
    if promised is not None and promised > whole:
        return f"{whole} of {promised} promised pages are there whole"
    if whole < count:
        return f"{whole} of {count} promised pages are there whole"
    return f"the list of pages breaks off after page {count}" if goes_on else ""
