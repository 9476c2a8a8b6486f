"""Frames of a video file, a TIFF stack or a folder of images: grey, 8 bit, each with its instant.

Whatever a file promises and does not hold is an error with a name, found before anything is written
at the latest: a truncated video is told from a short one by the number of frames it promises.
"""

from __future__ import annotations

import csv
import io
import math
import os
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from fractions import Fraction
from itertools import pairwise
from pathlib import Path
from typing import Literal, TypeAlias

import cv2
import numpy as np
import numpy.typing as npt

from meso_robust.errors import InputError
from meso_robust.reading import foreign_table, text_of
from meso_robust.tracking import stack
from meso_robust.tracking.pixels import MOST_PIXELS, Grey, decoded, quiet_opencv
from meso_robust.tracking.stack import Stack, open_stack, page_count, read_pages
from meso_robust.types import Image

FirstField: TypeAlias = Literal["top", "bottom"]
SUFFIXES = {".png", ".tif", ".tiff", ".jpg", ".jpeg", ".bmp", ".pgm"}
"""Endings of the files that count as images of a folder."""
TIMES_FILE = "times.csv"
"""Beside the images: ``file,time_s``, one line an image."""
_MOST_RATE = 1e6  # Hz; of the recording format
_HEAD = 4096  # bytes, in which a Matroska file's segment begins
_EBML, _SEGMENT = b"\x1a\x45\xdf\xa3", b"\x18\x53\x80\x67"  # its element identifiers
_STAMP = re.compile(r"(?<![0-9.])([0-9]+(?:\.[0-9]+)?)(s|ms|us|µs|ns)(?![A-Za-z0-9])")
_SECONDS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "µs": 1e-6, "ns": 1e-9}
_DATE = re.compile(
    r"(?<![0-9])(\d{4})-?(\d\d)-?(\d\d)[T_ -]?(\d\d)[-:.]?(\d\d)[-:.]?(\d\d)(?:[._,-](\d{1,9}))?(?![0-9])"
)
_SIXTEEN_BIT = b"Y1\x00\x10"  # OpenCV's code of 16-bit grey video


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Frame:
    """One image.

    Attributes
    ----------
    index
        Place in the file or folder, from 0.
    time
        Instant in s.
    image
        (H, W) grey values.
    """

    index: int
    time: float
    image: Image


@dataclass(frozen=True, slots=True, kw_only=True)
class Frames:
    """What `open_frames` found; iterating reads the images one by one, each time from the start.

    Attributes
    ----------
    path
        The file or folder.
    rate
        Frames a second, Hz.
    size
        Width and height in pixels.
    promised
        Number of frames that the file or folder promises; None if a file does not say.
    notes
        What a user should know of how pixels and instants were taken.
    allow_truncated
        Whether the frames of a truncated video are used.
    pixel
        Side of a pixel in m, as the file says it; None if it does not.
    """

    path: Path
    rate: float
    size: tuple[int, int]
    promised: int | None
    notes: tuple[str, ...]
    allow_truncated: bool
    _read: Callable[[], Iterator[Frame]] = field(repr=False)
    pixel: float | None = None

    def __iter__(self) -> Iterator[Frame]:
        """Read the frames.

        Raises
        ------
        InputError
            A frame is missing, cannot be decoded, or differs in size or kind from the first.
        """
        return self._read()


def open_frames(
    path: Path,
    rate: float | None = None,
    allow_truncated: bool = False,
    interlaced: FirstField | None = None,
) -> Frames:
    """Open a video file, a TIFF stack, or a folder of images or stacks in their natural order.

    Parameters
    ----------
    path
        The file or folder.
    rate
        Frames a second in Hz, instead of what the file says; needed for images without a
        ``times.csv`` or time stamps of their own (OME-TIFF, ImageJ).
    allow_truncated
        Use the frames before the break of a truncated video. The last one read is left out: it may
        be damaged.
    interlaced
        Which lines of an interlaced camera's frame were exposed first, "top" (the first line and every
        second one from it) or "bottom"; each frame then gives two, half a period apart.

    Raises
    ------
    InputError
        There is no such file, it is no video, it holds no frames, a clock is missing or wrong.
    """
    if rate is not None and not 0.0 < rate <= _MOST_RATE:
        raise InputError(f"frame rate {rate} Hz: must be positive; give the camera's frame rate")
    if not path.exists():
        raise InputError(f"{path}: no such file; give a video or a folder of images")
    frames = _opened(path, rate, allow_truncated)
    return frames if interlaced is None else _split(frames, interlaced)


def _opened(path: Path, rate: float | None, allow_truncated: bool) -> Frames:
    if path.is_dir():
        return _folder(path, rate, allow_truncated)
    if not path.is_file():  # of a pipe or a device nobody knows the end
        raise InputError(f"{path}: is not a plain file; give a video or a folder of images")
    if path.suffix.lower() in stack.SUFFIXES and _several(path):
        return _stacks(path, [path], rate, allow_truncated)
    return _video(path, rate, allow_truncated)


# ------------------------------------------------------------------------------- interlacing


def _split(frames: Frames, first: FirstField) -> Frames:
    """The two fields of every frame as frames of full height, one after the other."""
    if frames.size[1] % 2:
        raise InputError(
            f"{frames.path}: frames of {frames.size[1]} lines; must be an even number to be interlaced; "
            "leave out --interlaced"
        )
    half = 0.5 / frames.rate
    order = (0, 1) if first == "top" else (1, 0)

    def read() -> Iterator[Frame]:
        before = -math.inf
        for frame in frames:
            if not frame.time > before:
                raise InputError(
                    f"{frames.path}: frame {frame.index} at {frame.time:g} s comes before the second field "
                    f"of the frame before, at {before:g} s; give --frame-rate-hz"
                )
            for k, parity in enumerate(order):
                before = frame.time + k * half
                image = _whole_field(frame.image, parity)
                yield Frame(index=2 * frame.index + k, time=before, image=image)

    note = f"interlaced, {first} field first: every frame is taken as two, half a period apart"
    return replace(
        frames,
        rate=2.0 * frames.rate,
        promised=None if frames.promised is None else 2 * frames.promised,
        notes=(*frames.notes, note),
        _read=read,
    )


def _whole_field(image: Image, parity: int) -> Image:
    """A field where its lines are in the frame, those between them interpolated by cubics.

    A line keeps its place: the fields are half a line of theirs apart, and so they stay.
    """
    lines = np.pad(image[parity::2].astype(np.int32), ((2, 2), (0, 0)), "edge")
    count = image.shape[0] // 2
    # of the middle between two lines; the first of them is the one before line 0
    between = (9 * (lines[1:-2] + lines[2:-1]) - lines[:-3] - lines[3:] + 8) >> 4
    whole = np.empty_like(image)
    whole[parity::2] = image[parity::2]
    start = 1 - parity
    whole[1 - parity :: 2] = np.clip(between[start : start + count], 0, 255).astype(np.uint8)
    return whole


# ------------------------------------------------------------------------------ video files


def _video(path: Path, rate: float | None, allow_truncated: bool) -> Frames:
    capture = _capture(path)
    stated = capture.get(cv2.CAP_PROP_FPS)
    count = capture.get(cv2.CAP_PROP_FRAME_COUNT)
    deep = _code(capture, cv2.CAP_PROP_CODEC_PIXEL_FORMAT) == _SIXTEEN_BIT
    size = tuple(
        int(capture.get(key)) for key in (cv2.CAP_PROP_FRAME_WIDTH, cv2.CAP_PROP_FRAME_HEIGHT)
    )
    capture.release()
    if math.prod(size) > MOST_PIXELS:
        raise InputError(
            f"{path}: frames of {size[0]} x {size[1]} pixels; must have at most {MOST_PIXELS:,}; "
            "scale the video down"
        )
    if not (math.isfinite(stated) and 0.0 < stated <= _MOST_RATE):
        if rate is None:
            raise InputError(f"{path}: states no frame rate; give --frame-rate-hz")
        stated = rate
    _check_segment(path, allow_truncated)
    counts = math.isfinite(count) and count > 0 and _counts_frames(path)
    promised = int(count) if counts else None
    notes = ["16-bit grey values are scaled to 8 bits"] if deep else []
    if rate is not None and rate != stated:
        notes.append(f"the clock runs at the given {rate:g} Hz, not at the file's {stated:g} Hz")

    def read() -> Iterator[Frame]:
        return _whole(path, promised, allow_truncated, _stamped(path, stated / (rate or stated)))

    return Frames(
        path=path,
        rate=rate or stated,
        size=(size[0], size[1]),
        promised=promised,
        notes=tuple(notes),
        allow_truncated=allow_truncated,
        _read=read,
    )


def _head(path: Path) -> bytes:
    with path.open("rb") as file:
        return file.read(_HEAD)


def _counts_frames(path: Path) -> bool:
    """Whether the container says how many frames it has; of others FFmpeg guesses by rate and duration."""
    head = _head(path)
    return head[:4] == b"RIFF" or head[4:8] == b"ftyp"


def _check_segment(path: Path, allow_truncated: bool) -> None:
    """Refuse a Matroska file that is shorter than its one segment (RFC 9559, section 5.1)."""
    head = _head(path)
    at = head.find(_SEGMENT)
    if not head.startswith(_EBML) or at < 0 or at + 12 > len(head):
        return
    start = at + len(_SEGMENT)
    length = 9 - head[start].bit_length()  # of the size: the first bit that is set tells it
    if not 1 <= length <= 8:
        return
    size = int.from_bytes(head[start : start + length], "big") & ((1 << 7 * length) - 1)
    unknown = size == (1 << 7 * length) - 1  # of a stream
    there = path.stat().st_size - start - length
    if not unknown and there < size and not allow_truncated:
        raise InputError(
            f"{path}: truncated, {there} of {size} declared bytes are there; copy it again, or use the "
            "frames before the break with --allow-truncated"
        )


def _capture(path: Path) -> cv2.VideoCapture:
    os.environ.setdefault("OPENCV_FFMPEG_LOGLEVEL", "-8")  # FFmpeg prints of its own, too
    with quiet_opencv():
        # by name: another back end would take digits in the name for a numbered sequence
        capture = cv2.VideoCapture(str(path), cv2.CAP_FFMPEG)
    if path.suffix.lower() in SUFFIXES:
        raise InputError(f"{path}: is a single image; give a stack, or the folder of the images")
    if path.stat().st_size == 0:
        raise InputError(f"{path}: is an empty file, zero frames; record it again")
    # FFmpeg would show a text file as a screen of text
    if not capture.isOpened() or _code(capture, cv2.CAP_PROP_FOURCC) == b"ansi":
        raise InputError(
            f"{path}: cannot be decoded as a video, or its end is missing; copy it again, "
            "or convert it to AVI with MJPG"
        )
    return capture


def _code(capture: cv2.VideoCapture, key: int) -> bytes:
    return (int(capture.get(key)) & 0xFFFFFFFF).to_bytes(4, "little")


def _stamped(path: Path, slower: float) -> Iterator[Frame]:
    """Frames with the instants of the file times ``slower``."""
    capture, last, index = _capture(path), -math.inf, 0
    try:
        while True:
            good, image = capture.read()
            if not good:
                return
            time = slower * capture.get(cv2.CAP_PROP_POS_MSEC) / 1000.0
            if not time > last:
                raise InputError(
                    f"{path}: frame {index} has the time stamp {time:g} s, not after {last:g} s; "
                    "write the video again, or give its images with a times.csv"
                )
            yield Frame(index=index, time=time, image=_grey8(np.asarray(image)))
            last, index = time, index + 1
    finally:
        capture.release()


def _grey8(image: npt.NDArray[np.generic]) -> Image:
    if image.ndim == 3:
        image = cv2.cvtColor(np.asarray(image, dtype=np.uint8), cv2.COLOR_BGR2GRAY)
    return np.ascontiguousarray(image, dtype=np.uint8)


def _whole(
    path: Path, promised: int | None, allow_truncated: bool, frames: Iterator[Frame]
) -> Iterator[Frame]:
    """Hold one frame back until it is sure that it is not the broken end of a truncated file."""
    held, read = None, 0
    for frame in frames:
        if held is not None:
            yield held
        held, read = frame, read + 1
    if held is None:
        raise InputError(f"{path}: zero frames could be read; record it again")
    if promised is None or read >= promised:
        yield held
    elif not allow_truncated:
        raise InputError(
            f"{path}: truncated, {read} of {promised} declared frames could be read; copy it "
            "again, or use the frames before the break with --allow-truncated"
        )


# ------------------------------------------------------------------------ folders of images


def _folder(path: Path, rate: float | None, allow_truncated: bool) -> Frames:
    files = sorted(
        (file for file in path.iterdir() if file.suffix.lower() in SUFFIXES), key=_natural
    )
    if not files:
        raise InputError(
            f"{path}: zero frames, no file ends in {', '.join(sorted(SUFFIXES))}; give a folder "
            "of images"
        )
    stamped = rate is None and not (path / TIMES_FILE).exists() and _tells_time(files[0])
    several = next((file.name for file in files if _several(file)), None)
    if (several or stamped) and all(file.suffix.lower() in stack.SUFFIXES for file in files):
        return _stacks(path, files, rate, allow_truncated)
    if several:
        raise InputError(
            f"{path}: {several} has several pages, beside images of other kinds; must be stacks only "
            "or images only; put them into folders of their own"
        )
    if rate is None and not (path / TIMES_FILE).exists():
        stamps = {file: _named_time(file.stem) for file in files}
        files = sorted(files, key=lambda file: (stamps[file] or 0, _natural(file)))
    first = decoded(files[0])
    grey = Grey.of(files[0], first)
    height, width = first.shape[:2]
    times, found = _clock(path, files, rate)

    def read() -> Iterator[Frame]:
        for index, (file, time) in enumerate(zip(files, times, strict=True)):
            image = decoded(file)
            if image.shape[:2] != (height, width):
                raise InputError(
                    f"{file}: {image.shape[1]} x {image.shape[0]} pixels, but {files[0].name} has "
                    f"{width} x {height}; all images of a folder must be of one size"
                )
            yield Frame(index=index, time=time, image=grey.eight_bits(file, image))

    return Frames(
        path=path,
        rate=found,
        size=(width, height),
        promised=len(files),
        notes=grey.notes,
        allow_truncated=False,
        _read=read,
    )


def _several(file: Path) -> bool:
    """Whether an image file has more than one page, or says so; what is no TIFF has one."""
    if file.suffix.lower() not in stack.SUFFIXES:
        return False
    try:
        return page_count(file) > 1 or bool(open_stack(file).broken)
    except InputError:  # the decoder of single images tells of it
        return False


def _tells_time(file: Path) -> bool:
    """Whether a TIFF file has time stamps."""
    try:
        return bool(open_stack(file).metadata.times)
    except InputError:
        return False


# ------------------------------------------------------------------------------ TIFF stacks


def _stacks(path: Path, files: list[Path], rate: float | None, allow_truncated: bool) -> Frames:
    stacks = [open_stack(file) for file in files]
    for one in stacks:
        _check_stack(one, stacks[0], allow_truncated and one is stacks[-1])
    if (path / TIMES_FILE).exists():
        raise InputError(
            f"{path / TIMES_FILE}: has one time per file, but the files here have several pages; give "
            "--frame-rate-hz, or time stamps in OME-TIFF"
        )
    grey = Grey.of(files[0], next(read_pages(stacks[0])), stacks[0].metadata.bits)
    times, found, clock_notes = _stack_clock(path, stacks, rate)

    def read() -> Iterator[Frame]:
        images = ((one.path, image) for one in stacks for image in read_pages(one))
        for index, (file, image) in enumerate(images):
            yield Frame(index=index, time=times[index], image=grey.eight_bits(file, image))

    sides = {one.metadata.pixel for one in stacks}
    notes = [*grey.notes, *clock_notes]
    notes += dict.fromkeys(note for one in stacks for note in one.metadata.notes)
    notes += [f"{one.path.name}: truncated, {one.broken}" for one in stacks if one.broken]
    if len(stacks) > 1 and any(one.pages > 1 for one in stacks):
        notes.append(
            f"{len(stacks)} stacks are taken as one film, in the order of their names; if they are "
            "separate recordings, give them one at a time"
        )
    if len(sides) > 1:
        notes.append("the stacks state different pixel sizes: not used")
    return Frames(
        path=path,
        rate=found,
        size=stacks[0].size,
        promised=len(times),
        notes=tuple(notes),
        allow_truncated=allow_truncated,
        _read=read,
        pixel=sides.pop() if len(sides) == 1 else None,
    )


def _check_stack(one: Stack, first: Stack, may_break: bool) -> None:
    if one.size != first.size:
        raise InputError(
            f"{one.path}: {one.size[0]} x {one.size[1]} pixels, but {first.path.name} has "
            f"{first.size[0]} x {first.size[1]}; all stacks of a folder must be of one size"
        )
    if one.pages == 0 or (one.broken and not may_break):
        raise InputError(
            f"{one.path}: truncated, {one.broken}; copy it again, or use the pages before the "
            "break in the last file with --allow-truncated"
        )


def _stack_clock(
    path: Path, stacks: list[Stack], rate: float | None
) -> tuple[list[float], float, list[str]]:
    """Instants of the pages, frames a second, and what a user should know of them."""
    stamped = [one for one in stacks if one.metadata.times]
    if rate is not None:
        other = [f"the clock runs at the given {rate:g} Hz, not by the stamps of the pages"]
        return (
            [k / rate for k in range(sum(one.pages for one in stacks))],
            rate,
            other * bool(stamped),
        )
    if len(stamped) < len(stacks):
        unstamped = next(one.path for one in stacks if not one.metadata.times)
        raise InputError(f"{unstamped}: its pages have no time stamps; give --frame-rate-hz")
    times: list[float] = []
    for one in stacks:
        own = one.metadata.times[: one.pages]
        late = next((k for k, (a, b) in enumerate(pairwise(own), 2) if not b > a), None)
        if late is not None:
            raise InputError(
                f"{one.path}: page {late} at {own[late - 1]:g} s is not after the page before; "
                "give --frame-rate-hz"
            )
        if times and not own[0] > times[-1]:
            raise InputError(
                f"{one.path}: begins at {own[0]:g} s, not after {times[-1]:g} s, where the stack "
                "before it ends: separate recordings; give the stacks one at a time"
            )
        times += own
    if len(times) < 2:
        raise InputError(f"{path}: one image gives no frame rate; give --frame-rate-hz")
    return times, float(1.0 / np.median(np.diff(times))), []


# ------------------------------------------------------------------------ order and clock


def _natural(path: Path) -> tuple[list[str | int], str]:
    """Key of the order in which frame_2 comes before frame_10."""
    parts: list[str | int] = [
        int(part) if part.isdigit() else part for part in re.split(r"([0-9]+)", path.name.lower())
    ]
    return parts, path.name


def _clock(path: Path, files: list[Path], rate: float | None) -> tuple[list[float], float]:
    """Instants of the images and frames a second."""
    table = path / TIMES_FILE
    if not table.exists():
        if rate is not None:
            return [k / rate for k in range(len(files))], rate
        return _named_times(path, files)
    stated = _read_times(table)
    missing = [file.name for file in files if file.name not in stated]
    if missing:
        raise InputError(f"{table}: has no line for {missing[0]}; add one; each image needs a line")
    times = [stated[file.name] for file in files]
    steps = np.diff(times)
    if np.any(steps <= 0.0):
        late = int(np.flatnonzero(steps <= 0.0)[0]) + 1
        raise InputError(
            f"{table}: {files[late].name} at {times[late]} s is not after {files[late - 1].name}; "
            "correct the times, or rename the images"
        )
    if rate is None and not steps.size:
        raise InputError(f"{table}: one image gives no frame rate; give --frame-rate-hz")
    return times, rate or float(1.0 / np.median(steps))


def _named_times(path: Path, files: list[Path]) -> tuple[list[float], float]:
    """Instants that the names of the images state, from the first, and frames a second."""
    known = [stamp for file in files if (stamp := _named_time(file.stem)) is not None]
    if len(known) < len(files) or len(files) < 2:
        raise InputError(
            f"{path}: images have no clock; give --frame-rate-hz, add {TIMES_FILE} (file,time_s), or put "
            "the instant into every name, as in image_0012.5ms.png or 20260131_120000.125.png"
        )
    twice = next((k for k, (a, b) in enumerate(pairwise(known), 1) if a == b), None)
    if twice is not None:
        raise InputError(
            f"{files[twice]}: its name states the instant of {files[twice - 1].name}; rename the images, or "
            f"add {TIMES_FILE}"
        )
    times = [float(stamp - known[0]) for stamp in known]
    return times, float(1.0 / np.median(np.diff(times)))


def _named_time(stem: str) -> Fraction | None:
    """Instant in s in the name of an image; None if it has none."""
    found = _STAMP.findall(stem)
    if found:
        number, unit = found[-1]
        return Fraction(number) * Fraction(str(_SECONDS[unit]))
    date = _DATE.search(stem)
    if date is None:
        return None
    try:
        year, month, *clock = (int(text) for text in date.groups()[:6])
        day = datetime(year, month, clock[0], clock[1], clock[2], clock[3], tzinfo=UTC)
    except ValueError:
        return None
    return int(day.timestamp()) + Fraction(f"0.{date[7] or 0}")


def _read_times(table: Path) -> dict[str, float]:
    advice = "correct it, or leave it out and give --frame-rate-hz"
    text = text_of(table, advice, "a CSV file")
    try:
        rows = list(csv.reader(io.StringIO(text, newline=""), strict=True))
    except csv.Error as error:
        raise InputError(f"{table}: is not a CSV file in UTF-8 ({error}); {advice}") from error
    if not rows or rows[0] != ["file", "time_s"]:
        raise InputError(
            f"{table}: must begin with the line file,time_s; "
            f"{foreign_table(rows[0] if rows else [], 2) or 'correct its header'}"
        )
    times: dict[str, float] = {}
    for line, row in enumerate(rows[1:], start=2):
        value = _seconds(row)
        if value is None or row[0] in times:
            raise InputError(
                f"{table}, line {line}: {','.join(row)!r}; must be the name of an image, once, and "
                f"a finite number of seconds; {foreign_table(row, 2) or 'correct the line'}"
            )
        times[row[0]] = value
    return times


def _seconds(row: list[str]) -> float | None:
    """Instant in a line of the clock; None if it has none."""
    try:
        value = float(row[1]) if len(row) == 2 else math.nan
    except ValueError:
        return None
    return value if math.isfinite(value) else None
