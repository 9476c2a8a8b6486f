"""Films, their truth and their faults."""

from __future__ import annotations

import csv
import dataclasses
from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt
import pytest

from meso_robust.errors import InputError
from meso_robust.microscope import Faults, Part, Probe, Scene, film, rectangle, render, truncate
from tests.microscope.plain import FLAT, PIXEL, QUIET, small, still

Floats = npt.NDArray[np.float64]
Image = npt.NDArray[np.uint8]
COUNT = 6
TIMES = np.arange(COUNT) / 30.0
POSES = np.stack([PIXEL * np.arange(COUNT), np.zeros(COUNT), 0.1 * np.arange(COUNT)], axis=1)
TIPS = np.full((COUNT, 1, 2), -200e-6)
SCENE = Scene(
    part=Part(outline=rectangle(200e-6, 120e-6), metal=FLAT),
    probes=(Probe(direction=3.0),),
    oil=still(0.3),
    optics=small(),
    exposure=dataclasses.replace(QUIET, level=200.0, read_noise=1.0),
)


def rng() -> np.random.Generator:
    return np.random.default_rng(5)


def frames() -> list[Image]:
    """What the film must show."""
    source = rng()
    return [
        render(SCENE, pose, tips, source, float(t))
        for t, pose, tips in zip(TIMES, POSES, TIPS, strict=True)
    ]


def shown(path: Path) -> list[Image]:
    """Frames of a video, in grey."""
    video = cv2.VideoCapture(str(path))
    images: list[Image] = []
    while True:
        good, image = video.read()
        if not good:
            return images
        images.append(np.asarray(cv2.cvtColor(image, cv2.COLOR_BGR2GRAY), dtype=np.uint8))


def pngs(folder: Path) -> list[npt.NDArray[np.generic]]:
    return [
        np.asarray(cv2.imread(str(file), cv2.IMREAD_UNCHANGED))
        for file in sorted(folder.glob("*.png"))
    ]


def rows(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def made(path: Path, faults: Faults | None = None) -> Path:
    return film(path, SCENE, TIMES, POSES, TIPS, rng(), faults or Faults())


def test_ffv1_and_png_show_what_was_rendered(tmp_path: Path) -> None:
    made(tmp_path / "a.mkv")
    made(tmp_path / "b")
    for images in (shown(tmp_path / "a.mkv"), pngs(tmp_path / "b")):
        assert len(images) == COUNT
        assert all((x == y).all() for x, y in zip(images, frames(), strict=True))


@pytest.mark.parametrize("name", ["a.avi", "a.mp4"])
def test_lossy_films_show_nearly_that(name: str, tmp_path: Path) -> None:
    made(tmp_path / name)
    images = shown(tmp_path / name)
    assert len(images) == COUNT
    for image, true in zip(images, frames(), strict=True):
        assert np.abs(image.astype(float) - true).mean() < 3.0
    assert cv2.VideoCapture(str(tmp_path / name)).get(cv2.CAP_PROP_FPS) == pytest.approx(30.0)


def test_the_truth_is_beside_the_film(tmp_path: Path) -> None:
    tips = TIPS.copy()
    tips[2] = np.nan
    truth = film(tmp_path / "a.avi", SCENE, TIMES, POSES, tips, rng())
    assert truth == tmp_path / "a_truth.csv"
    table = rows(truth)
    assert [row["tip0_x_um"] == "" for row in table] == [k == 2 for k in range(COUNT)]
    read = np.array([[float(row[k]) for k in ("time_s", "x_um", "theta_deg")] for row in table])
    assert read == pytest.approx(
        np.stack([TIMES, 1e6 * POSES[:, 0], np.degrees(POSES[:, 2])], axis=1)
    )
    assert sorted(file.name for file in tmp_path.iterdir()) == ["a.avi", "a_truth.csv"]


def test_faulty_frames(tmp_path: Path) -> None:
    truth = made(tmp_path / "a", Faults(dropped=(1,), frozen=(3,), covered=(5,)))
    images, true = pngs(tmp_path / "a"), frames()
    assert [row["time_s"] for row in rows(truth)] == [f"{TIMES[k]:.9g}" for k in (0, 2, 3, 4, 5)]
    for image, k in zip(images[:4], (0, 2, 2, 4), strict=True):
        assert (image == true[k]).all()
    assert images[4].max() < 60  # nothing of the white part is left


def test_formats_that_a_reader_may_meet(tmp_path: Path) -> None:
    made(tmp_path / "deep", Faults(sixteen_bit=True))
    deep, true = pngs(tmp_path / "deep")[0], frames()[0]
    assert deep.dtype == np.uint16
    assert (deep == 257 * true.astype(int)).all()
    made(tmp_path / "colour", Faults(colour=True))
    colour = pngs(tmp_path / "colour")[0]
    assert colour.shape == (80, 96, 3)
    blue, red = colour[..., 0].mean(), colour[..., 2].mean()
    assert blue < true.mean() < red


def test_a_truncated_film_has_fewer_frames(tmp_path: Path) -> None:
    made(tmp_path / "a.avi")
    truncate(tmp_path / "a.avi", 0.6)
    assert len(shown(tmp_path / "a.avi")) < COUNT


def test_a_film_without_frames(tmp_path: Path) -> None:
    nothing = (np.zeros(0), np.zeros((0, 3)), np.zeros((0, 1, 2)))
    for name in ("a.avi", "a.mkv", "folder"):
        truth = film(tmp_path / name, SCENE, *nothing, rng())
        assert (tmp_path / name).exists()
        assert rows(truth) == []
    assert shown(tmp_path / "a.avi") == []


def test_what_cannot_be_filmed_leaves_nothing(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="16-bit"):
        made(tmp_path / "a.avi", Faults(sixteen_bit=True))
    with pytest.raises(InputError, match="ending"):
        made(tmp_path / "a.gif")
    with pytest.raises(ValueError, match="poses"):
        film(tmp_path / "a.avi", SCENE, TIMES, POSES[:2], TIPS, rng())
    with pytest.raises(ValueError, match="equal"):
        film(tmp_path / "a.avi", SCENE, TIMES**2, POSES, TIPS, rng())
    (tmp_path / "file").touch()
    with pytest.raises(InputError, match="written"):
        made(tmp_path / "file" / "a.avi")
    with pytest.raises(InputError, match="written"):
        made(tmp_path / "file")
    assert [file.name for file in tmp_path.iterdir()] == ["file"]


def test_a_shorter_film_leaves_no_frame_of_a_longer_one(tmp_path: Path) -> None:
    made(tmp_path / "a")
    made(tmp_path / "a", Faults(dropped=(0, 1)))
    assert len(pngs(tmp_path / "a")) == COUNT - 2
