"""A video to look at: the frames with what the tracker saw in them."""

from __future__ import annotations

import math
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import IO, TYPE_CHECKING, NamedTuple

import cv2
import numpy as np
import numpy.typing as npt

from meso_robust.errors import InputError
from meso_robust.tracking.calibration import Calibration
from meso_robust.tracking.reading_ahead import read_ahead
from meso_robust.types import Floats

if TYPE_CHECKING:
    from meso_robust.tracking.track import Track

Colours = npt.NDArray[np.uint8]

MAGNIFIED = 50.0
"""Factor of the drawn ellipses on one standard deviation: without it they would be invisible."""
_WIDEST = 800  # px of a still
_MOST_REFUSED = 4  # runs of lost frames of which the first is shown
_FINE = 4  # bits of a pixel in OpenCV's drawing
_GREEN, _ORANGE, _RED, _BLUE = (80, 200, 60), (30, 150, 240), (60, 60, 230), (235, 160, 40)


def drawn_overlay(
    folder: Path,
    track: Track,
    outline: Floats,
    tip_radius: float,
    calibration: Calibration,
    each: Callable[[], object] = lambda: None,
) -> IO[bytes]:
    """Draw the frames of a track as an AVI (MJPG) with outlines, tips, ellipses and words.

    The file has no name while it is drawn, so that a run that is killed leaves nothing of it.

    Parameters
    ----------
    folder
        On the disk that holds the file.
    track
        What was seen.
    outline
        (V, 2) corners of the part in m, body frame.
    tip_radius
        In m.
    calibration
        Of the camera.
    each
        Called after every frame.

    Raises
    ------
    InputError
        The video cannot be written.
    """
    code = cv2.VideoWriter.fourcc(*"MJPG")
    with tempfile.TemporaryDirectory(dir=folder, prefix=".", suffix=".part") as hidden:
        path = Path(hidden) / "overlay.avi"
        writer = cv2.VideoWriter(
            str(path), cv2.CAP_FFMPEG, code, track.frames.rate, track.frames.size
        )
        if not writer.isOpened():
            raise InputError(f"{folder}: the overlay cannot be written; give --no-overlay")
        film = path.open("rb")  # keeps what the writer writes when the name is gone
    try:
        for frame, k in zip(read_ahead(track.frames), range(len(track.times)), strict=False):
            picture = np.asarray(cv2.cvtColor(frame.image, cv2.COLOR_GRAY2BGR), np.uint8)
            _draw(picture, track, k, outline, tip_radius, calibration)
            writer.write(picture)
            each()
    except BaseException:
        film.close()
        raise
    finally:
        writer.release()
    return film


class Still(NamedTuple):
    """A frame with what was seen in it, and why it is shown."""

    frame: int
    why: str
    jpeg: bytes


def stills(
    track: Track, outline: Floats, tip_radius: float, calibration: Calibration
) -> list[Still]:
    """The frames of a track that are worth a look: first, last, least certain, and refused ones.

    Parameters
    ----------
    track, outline, tip_radius, calibration
        As for :func:`drawn_overlay`.

    Returns
    -------
    list of Still
        In the order of the frames.

    Raises
    ------
    InputError
        The video cannot be read again.
    """
    wanted = _worth_a_look(track)
    found = []
    for k, frame in enumerate(read_ahead(track.frames)):
        if k in wanted:
            picture = np.asarray(cv2.cvtColor(frame.image, cv2.COLOR_GRAY2BGR), np.uint8)
            _draw(picture, track, k, outline, tip_radius, calibration)
            wide = picture.shape[1]
            if wide > _WIDEST:
                size = (_WIDEST, round(picture.shape[0] * _WIDEST / wide))
                picture = np.asarray(cv2.resize(picture, size, interpolation=cv2.INTER_AREA))
            jpeg = cv2.imencode(".jpg", picture, (cv2.IMWRITE_JPEG_QUALITY, 80))[1]
            found.append(Still(k, wanted[k], jpeg.tobytes()))
        if k >= max(wanted):
            break
    return found


def _worth_a_look(track: Track) -> dict[int, str]:
    """Frames with the reason why each is shown; the first that applies counts."""
    count = len(track.times)
    wanted = {0: "first", count - 1: "last"}
    seen = np.flatnonzero(track.found)
    if seen.size:
        spread = np.trace(track.covariances[seen, :2, :2], axis1=1, axis2=2)
        wanted.setdefault(int(seen[np.argmax(spread)]), "least certain")
    begun = [k for k in range(count) if not track.found[k] and (k == 0 or track.found[k - 1])]
    for k in begun[:_MOST_REFUSED]:
        wanted[k] = f"{wanted[k]}, refused" if k in wanted else "refused"
    return dict(sorted(wanted.items()))


def _draw(
    picture: Colours,
    track: Track,
    k: int,
    outline: Floats,
    tip_radius: float,
    calibration: Calibration,
) -> None:
    colour = _GREEN if track.states[k] == "found" else _ORANGE
    if track.found[k]:
        x, y, theta = track.poses[k]
        c, s = math.cos(theta), math.sin(theta)
        border = _dense(outline) @ np.array([[c, s], [-s, c]]) + (x, y)
        _closed(picture, calibration.to_pixels(border), colour)
        _closed(
            picture, _ellipse(track.poses[k, :2], track.covariances[k, :2, :2], calibration), colour
        )
        axis = np.array(
            [[x, y], [x + 0.25 * c * np.ptp(outline[:, 0]), y + 0.25 * s * np.ptp(outline[:, 0])]]
        )
        _line(picture, calibration.to_pixels(axis), colour)
    for p, name in enumerate(track.names):
        tip = track.tips[k, p]
        if np.isfinite(tip[0]):
            angle = np.linspace(0.0, 2.0 * math.pi, 25)[:-1]
            ring = tip + tip_radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
            _closed(picture, calibration.to_pixels(ring), _BLUE)
            _closed(picture, _ellipse(tip, track.tip_covariances[k, p], calibration), _BLUE)
            u, v = np.rint(calibration.to_pixels(tip)).astype(int).tolist()
            _text(picture, name, (u + 8, v - 8), _BLUE)
    _words(picture, track, k, colour)


def _words(picture: Colours, track: Track, k: int, colour: tuple[int, int, int]) -> None:
    line = f"frame {k}  {track.times[k]:.3f} s  {track.states[k]}"
    _text(picture, line, (8, 18), colour if track.found[k] else _RED)
    reasons = [track.reasons[k], *track.tip_reasons[k]]
    for row, reason in enumerate(filter(None, reasons)):
        _text(picture, reason, (8, 36 + 16 * row), _RED)
    height = picture.shape[0]
    _text(picture, f"ellipses: 1 sigma x {MAGNIFIED:g}", (8, height - 8), (200, 200, 200))


def _text(picture: Colours, words: str, at: tuple[int, int], colour: tuple[int, int, int]) -> None:
    plain = words.encode("ascii", "replace").decode()
    cv2.putText(picture, plain, at, cv2.FONT_HERSHEY_SIMPLEX, 0.42, colour, 1, cv2.LINE_AA)


def _dense(outline: Floats) -> Floats:
    """The outline with points between its corners, so that the lens may bend its image."""
    share = (np.arange(8) / 8.0)[None, :, None]
    after = np.roll(outline, -1, axis=0)
    return ((1.0 - share) * outline[:, None] + share * after[:, None]).reshape(-1, 2)


def _ellipse(centre: Floats, covariance: Floats, calibration: Calibration) -> Floats:
    values, vectors = np.linalg.eigh(covariance)
    axes = vectors * np.sqrt(np.maximum(values, 0.0))
    angle = np.linspace(0.0, 2.0 * math.pi, 37)[:-1]
    ring = np.stack([np.cos(angle), np.sin(angle)], axis=1) @ axes.T
    return calibration.to_pixels(centre + MAGNIFIED * ring)


def _fixed(points: Floats) -> npt.NDArray[np.int32]:
    return np.rint(points * 2**_FINE).astype(np.int32).reshape(-1, 1, 2)


def _closed(picture: Colours, points: Floats, colour: tuple[int, int, int]) -> None:
    cv2.polylines(picture, [_fixed(points)], True, colour, 1, cv2.LINE_AA, _FINE)


def _line(picture: Colours, points: Floats, colour: tuple[int, int, int]) -> None:
    cv2.polylines(picture, [_fixed(points)], False, colour, 1, cv2.LINE_AA, _FINE)
