"""Files of users: where the limits lie, to the byte and to the level."""

from __future__ import annotations

import gzip
import os
from pathlib import Path

import cv2
import numpy as np
import pytest

from meso_robust import files, reading
from meso_robust.errors import InputError
from meso_robust.recordings.importers import files as importing
from meso_robust.tracking import frames, pixels


def lists(deep: int) -> str:
    return "[" * deep + "]" * deep


@pytest.mark.parametrize("source", ["json", "toml"])
def test_lists_and_sections_are_nested_just_as_deep_as_told(source: str) -> None:
    def read(deep: int) -> object:
        if source == "json":
            return reading.json_values(lists(deep), "f")
        return reading.toml_values(f"a = {lists(deep - 1)}", "f")  # the file is a section itself

    assert read(reading.DEEPEST)
    with pytest.raises(InputError, match=f"nested more than {reading.DEEPEST} deep"):
        read(reading.DEEPEST + 1)


def test_a_file_is_read_up_to_its_limit_and_no_further(tmp_path: Path) -> None:
    file = tmp_path / "f"
    file.write_bytes(b"x" * reading.MIB)
    assert len(reading.bytes_of(file, "give less", reading.MIB)) == reading.MIB

    file.write_bytes(b"x" * (reading.MIB + 1))
    with pytest.raises(InputError, match=r"f: is larger than 1 MiB, .*; give less"):
        reading.bytes_of(file, "give less", reading.MIB)


def test_a_device_is_not_read(tmp_path: Path) -> None:
    for path in (Path("/dev/zero"), Path("/dev/null")):
        # said once: no message within a message
        with pytest.raises(
            InputError, match=r"^[^:]+: cannot be read \(not a plain file\); [^:]+$"
        ):
            reading.bytes_of(path, "give a file")
    with pytest.raises(InputError, match="Is a directory"):
        reading.bytes_of(tmp_path, "give a file")


def test_a_small_file_that_unpacks_to_a_large_one_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(importing, "LARGEST_DATA", reading.MIB)
    file = tmp_path / "log.txt.gz"
    file.write_bytes(gzip.compress(b"0" * reading.MIB))
    assert len(importing.text_of(file)) == reading.MIB

    file.write_bytes(gzip.compress(b"0" * (reading.MIB + 1)))
    with pytest.raises(InputError, match=r"log.txt.gz: holds more than 1 MiB"):
        importing.text_of(file)


def test_a_video_with_too_many_pixels_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "push.avi"
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"MJPG"), 30.0, (64, 48), False)
    writer.write(np.full((48, 64), 70, np.uint8))
    writer.release()
    monkeypatch.setattr(frames, "MOST_PIXELS", 64 * 48)
    assert frames.open_frames(path).size == (64, 48)

    monkeypatch.setattr(frames, "MOST_PIXELS", 64 * 48 - 1)
    with pytest.raises(InputError, match="frames of 64 x 48 pixels; must have at most"):
        frames.open_frames(path)


def test_an_image_that_the_decoder_refuses_is_a_fault_of_the_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*_: object) -> None:
        raise cv2.error("pixels <= CV_IO_MAX_IMAGE_PIXELS")

    path = tmp_path / "grid.png"
    cv2.imwrite(str(path), np.zeros((4, 4), np.uint8))
    monkeypatch.setattr("meso_robust.tracking.pixels.cv2.imdecode", refuse)

    with pytest.raises(
        InputError, match=r"grid.png: cannot be decoded, or has more than 67,108,864"
    ):
        pixels.decoded(path)
    assert os.environ["OPENCV_IO_MAX_IMAGE_PIXELS"] == str(2**26)


def test_what_cannot_be_written_whole_leaves_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(source: str, target: object) -> None:
        raise OSError(28, "No space left on device")

    (tmp_path / "a.json").write_text("earlier", encoding="utf-8")
    monkeypatch.setattr("meso_robust.files.os.replace", full)
    with pytest.raises(InputError, match=r"cannot be written \(No space left on device\)"):
        files.write_all(tmp_path, {"a.json": "1", "b.json": "2"})

    assert [path.name for path in tmp_path.iterdir()] == ["a.json"]
    assert (tmp_path / "a.json").read_text(encoding="utf-8") == "earlier"


@pytest.mark.parametrize("error", [KeyboardInterrupt(), MemoryError()])
def test_an_interrupted_write_leaves_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, error: BaseException
) -> None:
    def interrupted(*_: object) -> None:
        raise error

    monkeypatch.setattr("meso_robust.files.os.chmod", interrupted)
    with pytest.raises(type(error)):
        files.write_all(tmp_path, {"a.json": "1", "b.json": "2"})

    assert list(tmp_path.iterdir()) == []
