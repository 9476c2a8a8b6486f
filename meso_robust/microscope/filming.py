"""Films of a scene: a video or a folder of images, and the truth beside it."""

from __future__ import annotations

import math
import os
import tempfile
from collections.abc import Iterable, Iterator
from pathlib import Path

import cv2
import numpy as np

from meso_robust.errors import InputError
from meso_robust.files import write_all
from meso_robust.microscope.faults import NONE, AnyImage, Faults, spoiled
from meso_robust.microscope.frame import exposed
from meso_robust.microscope.looks import Scene
from meso_robust.microscope.sensor import compressed
from meso_robust.types import Floats, Image

CODECS = {".avi": "MJPG", ".mp4": "mp4v", ".mkv": "FFV1"}
"""Codec of a file name; FFV1 loses nothing. A name without ending is a folder of PNG images."""
_EVEN = 1e-3  # relative difference of spacings that counts as none
_QUALITY = 95  # of MJPG where the scene states none


def film(  # a camera, what it sees, and when
    path: Path,
    scene: Scene,
    times: Floats,
    poses: Floats,
    tips: Floats,
    rng: np.random.Generator,
    faults: Faults = NONE,
) -> Path:
    """Film a scene.

    Parameters
    ----------
    path
        ``.avi`` (MJPG, at the quality of the scene's exposure), ``.mp4`` (mpeg4), ``.mkv`` (FFV1,
        lossless), or a folder for PNG images.
    scene
        What is there.
    times
        (T,) s, of equal spacing for a video.
    poses
        (T, 3) x, y in m, θ in rad.
    tips
        (T, P, 2) tip centres in m.
    rng
        Of the noise.
    faults
        What goes wrong.

    Returns
    -------
    :
        ``truth.csv`` or, beside a video, ``<stem>_truth.csv``.

    Raises
    ------
    InputError
        If the file cannot be written.
    ValueError
        If shapes do not fit, or times are not of equal spacing for a video.
    """
    times, poses = np.asarray(times, dtype=float), np.asarray(poses, dtype=float)
    tips = np.asarray(tips, dtype=float)
    shapes = (len(times), 3), (len(times), len(scene.probes), 2)
    if (poses.shape, tips.shape) != shapes:
        raise ValueError(
            f"poses {poses.shape}, tips {tips.shape}; must be {shapes[0]} and {shapes[1]}, one for each "
            "time and probe"
        )
    if path.suffix and not np.allclose(np.diff(times), 1.0 / rate(times), rtol=_EVEN, atol=0.0):
        raise ValueError(
            "times: not of equal spacing, as a video needs; film into a folder, or "
            "state missing frames as faults"
        )
    images = spoiled(frames(scene, times, poses, tips, rng, path.suffix), faults)
    write_frames(path, images, rate(times), scene)
    kept = np.setdiff1d(np.arange(len(times)), faults.dropped)
    return write_truth(path, times[kept], poses[kept], tips[kept])


def frames(
    scene: Scene,
    times: Floats,
    poses: Floats,
    tips: Floats,
    rng: np.random.Generator,
    suffix: str = "",
) -> Iterator[Image]:
    """The frames; compressed here unless a file of this ending is itself compressed."""
    quality = scene.exposure.jpeg_quality
    for time, pose, tip in zip(times, poses, tips, strict=True):
        image = exposed(scene, pose, tip, rng, float(time))
        yield image if quality is None or suffix == ".avi" else compressed(image, quality)


def rate(times: Floats) -> float:
    """Frames a second; 30 for fewer than two frames."""
    return 30.0 if len(times) < 2 else (len(times) - 1) / float(times[-1] - times[0])


def write_frames(path: Path, images: Iterable[AnyImage], rate_hz: float, scene: Scene) -> None:
    """Write images (grey or BGR, 8 or 16 bit for PNG) as a video or into a folder, by the ending.

    Raises
    ------
    InputError
        If it cannot be written, or the ending is none of `CODECS`.
    """
    if path.suffix == "":
        _write_folder(path, images)
        return
    if path.suffix not in CODECS:
        raise InputError(
            f"{path}: ending {path.suffix}; give one of {', '.join(CODECS)}, or a folder"
        )
    _make(path.parent)
    # under a name of its own, so that a killed run leaves no half film
    with tempfile.TemporaryDirectory(dir=path.parent) as scratch:
        draft = Path(scratch) / f"film{path.suffix}"
        _write_video(draft, images, rate_hz, scene)
        os.replace(draft, path)


def _write_folder(path: Path, images: Iterable[AnyImage]) -> None:
    _make(path)
    for old in path.glob("frame_[0-9]*.png"):  # of the film that this one replaces
        old.unlink()
    for number, image in enumerate(images):
        file = path / f"frame_{number:05d}.png"
        if not cv2.imwrite(str(file), image, [cv2.IMWRITE_PNG_COMPRESSION, 1]):
            raise InputError(f"{file}: cannot be written; give a writable folder")


def _make(folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(
            f"{folder}: cannot be written ({error.strerror}); give a writable folder"
        ) from error


def _write_video(path: Path, images: Iterable[AnyImage], rate_hz: float, scene: Scene) -> None:
    codec = cv2.VideoWriter.fourcc(*CODECS[path.suffix])
    size = (scene.optics.width, scene.optics.height)
    # OpenCV's own MJPG writer takes a quality; in grey it (5.0.0) writes what FFmpeg cannot read
    own = path.suffix == ".avi"
    backend = cv2.CAP_OPENCV_MJPEG if own else cv2.CAP_FFMPEG
    writer = cv2.VideoWriter(str(path), backend, codec, rate_hz, size, True)
    if not writer.isOpened():
        raise InputError(
            f"{path}: this OpenCV cannot write {CODECS[path.suffix]}; film into a folder instead"
        )
    try:
        if own:
            writer.set(cv2.VIDEOWRITER_PROP_QUALITY, scene.exposure.jpeg_quality or _QUALITY)
        for image in images:
            writer.write(_as_bgr(path, image))
    finally:
        writer.release()


def _as_bgr(path: Path, image: AnyImage) -> Image:
    if image.dtype != np.uint8:
        raise InputError(f"{path}: 16-bit frames; a video holds 8 bits; film into a folder instead")
    grey = image.ndim == 2
    return np.asarray(cv2.cvtColor(image, cv2.COLOR_GRAY2BGR) if grey else image, dtype=np.uint8)


def write_truth(path: Path, times: Floats, poses: Floats, tips: Floats) -> Path:
    """Write what was filmed: ``frame,time_s,x_um,y_um,theta_deg`` and ``tip<k>_x_um,tip<k>_y_um``.

    What was not there is an empty cell. Returns the file.
    """
    columns = ["frame", "time_s", "x_um", "y_um", "theta_deg"]
    columns += [f"tip{k}_{axis}_um" for k in range(tips.shape[1]) for axis in "xy"]
    places = np.hstack([poses[:, :2] * 1e6, np.degrees(poses[:, 2:])])
    table = np.hstack([times[:, None], places, tips.reshape(len(times), 2 * tips.shape[1]) * 1e6])
    rows = [",".join(columns)]
    rows += [",".join([str(k), *map(_cell, row)]) for k, row in enumerate(table.tolist())]
    folder, name = (
        (path, "truth.csv") if path.suffix == "" else (path.parent, f"{path.stem}_truth.csv")
    )
    write_all(folder, {name: "\n".join(rows) + "\n"})
    return folder / name


def _cell(value: float) -> str:
    return "" if math.isnan(value) else f"{value:.9g}"
