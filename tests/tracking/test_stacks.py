"""TIFF and OME-TIFF stacks: every page is a frame, with the clock and the pixels that the file states."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt
import pytest
import tifffile

from meso_robust.errors import InputError
from meso_robust.tracking.frames import Frames, open_frames
from tests.tracking.test_frames import IMAGES, refused

STACK = np.stack(IMAGES)  # 12 pages of 48 x 64
STAMPS = [0.0, 0.1, 0.2, 0.35, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.25]  # not evenly


def ome(path: Path, images: npt.NDArray[Any] = STACK, **stated: Any) -> Path:
    tifffile.imwrite(path, images, ome=True, metadata={"axes": "TYX", **stated})
    return path


def planes(stamps: list[float], unit: str = "s") -> dict[str, Any]:
    return {"Plane": {"DeltaT": stamps, "DeltaTUnit": [unit] * len(stamps)}}


def grey(frames: Frames) -> npt.NDArray[np.uint8]:
    return np.stack([frame.image for frame in frames])


def clock(frames: Frames) -> list[float]:
    return [frame.time for frame in frames]


@pytest.mark.parametrize("how", ["series", "page by page", "deflate", "bigtiff"])
def test_every_page_is_a_frame(tmp_path: Path, how: str) -> None:
    path = tmp_path / "push.tif"
    if how == "page by page":
        with tifffile.TiffWriter(path) as writer:
            for image in IMAGES:
                writer.write(image, contiguous=False)
    else:
        packed: Any = "zlib" if how == "deflate" else None
        tifffile.imwrite(path, STACK, compression=packed, bigtiff=how == "bigtiff")

    frames = open_frames(path, rate=10.0)

    assert (frames.size, frames.promised) == ((64, 48), 12)
    assert np.array_equal(grey(frames), STACK)
    assert np.array_equal(grey(frames), STACK)  # and once more from the start
    assert clock(frames) == pytest.approx(np.arange(12) / 10.0)


def test_pages_that_another_program_packed_with_lzw_are_read(tmp_path: Path) -> None:
    path = tmp_path / "push.tif"
    assert cv2.imwritemulti(str(path), IMAGES, [cv2.IMWRITE_TIFF_COMPRESSION, 5])

    assert np.array_equal(grey(open_frames(path, rate=10.0)), STACK)


def test_sixteen_bits_are_read_whole_and_scaled_by_their_depth(tmp_path: Path) -> None:
    deep = STACK.astype(np.uint16) * 16
    deep[0, 0, 0] = 4095
    tifffile.imwrite(tmp_path / "push.tif", deep)

    frames = open_frames(tmp_path / "push.tif", rate=10.0)

    assert np.abs(grey(frames)[1:] - np.round(deep[1:] / 4095.0 * 255.0)).max() <= 0.5
    assert "12-bit" in frames.notes[0]


def test_colours_keep_their_order(tmp_path: Path) -> None:
    colours = np.zeros((3, 48, 64, 3), np.uint8)
    colours[..., 0] = 200  # red, which weighs 0.299
    tifffile.imwrite(tmp_path / "push.tif", colours, photometric="rgb")

    images = grey(open_frames(tmp_path / "push.tif", rate=10.0))

    assert set(images.ravel().tolist()) == {round(0.299 * 200)}


@pytest.mark.parametrize(("unit", "factor"), [("s", 1.0), ("ms", 1e3), ("µs", 1e6)])
def test_clock_and_pixels_are_those_that_were_written(
    tmp_path: Path, unit: str, factor: float
) -> None:
    side: dict[str, Any] = {
        "PhysicalSizeX": 650.0,
        "PhysicalSizeXUnit": "nm",
        "PhysicalSizeY": 0.65,
    }
    path = ome(
        tmp_path / "push.ome.tif", **side, **planes([factor * stamp for stamp in STAMPS], unit)
    )

    frames = open_frames(path)

    assert clock(frames) == pytest.approx(STAMPS)
    assert frames.rate == pytest.approx(10.0)
    assert frames.pixel == pytest.approx(0.65e-6)


def test_step_in_time_is_the_clock_where_no_page_has_a_stamp(tmp_path: Path) -> None:
    path = ome(tmp_path / "push.ome.tif", TimeIncrement=40.0, TimeIncrementUnit="ms")

    assert clock(open_frames(path)) == pytest.approx(np.arange(12) / 25.0)


def test_imagej_states_clock_and_pixels_in_its_own_way(tmp_path: Path) -> None:
    tifffile.imwrite(
        tmp_path / "push.tif",
        STACK,
        imagej=True,
        resolution=(1 / 1.3, 1 / 1.3),
        metadata={"axes": "TYX", "finterval": 0.2, "unit": "um"},
    )

    frames = open_frames(tmp_path / "push.tif")

    assert clock(frames) == pytest.approx(np.arange(12) / 5.0)
    assert frames.pixel == pytest.approx(1.3e-6)


def test_given_rate_stands_over_stamps_and_is_noted(tmp_path: Path) -> None:
    frames = open_frames(ome(tmp_path / "push.ome.tif", **planes(STAMPS)), rate=50.0)

    assert clock(frames) == pytest.approx(np.arange(12) / 50.0)
    assert any("given 50 Hz" in note for note in frames.notes)


def test_folder_of_stacks_is_one_film_of_all_pages_and_says_so(tmp_path: Path) -> None:
    for k in range(2):
        tifffile.imwrite(tmp_path / f"push_{k}.tif", np.roll(STACK, k, axis=0))

    frames = open_frames(tmp_path, rate=10.0)

    assert frames.promised == 24
    assert np.array_equal(grey(frames), np.concatenate([STACK, np.roll(STACK, 1, axis=0)]))
    assert any("one at a time" in note for note in frames.notes)


def test_stacks_whose_clocks_restart_are_not_one_film(tmp_path: Path) -> None:
    for k in range(2):
        ome(tmp_path / f"push_{k}.ome.tif", **planes(STAMPS))

    with pytest.raises(InputError, match=r"push_1.*separate recordings.*one at a time"):
        open_frames(tmp_path)


def test_stacks_whose_clocks_go_on_are_one_film(tmp_path: Path) -> None:
    for k in range(2):
        ome(tmp_path / f"push_{k}.ome.tif", **planes([1.5 * k + stamp for stamp in STAMPS]))

    assert clock(open_frames(tmp_path)) == pytest.approx(
        [*STAMPS, *(1.5 + stamp for stamp in STAMPS)]
    )


def test_single_pages_with_stamps_have_a_clock(tmp_path: Path) -> None:
    for k in range(3):
        ome(tmp_path / f"frame_{k}.ome.tif", STACK[k : k + 1], **planes([STAMPS[k + 1]]))

    frames = open_frames(tmp_path)

    assert clock(frames) == pytest.approx(STAMPS[1:4])
    assert np.array_equal(grey(frames), STACK[:3])


def test_stack_without_a_clock_asks_for_the_rate(tmp_path: Path) -> None:
    tifffile.imwrite(tmp_path / "push.tif", STACK)

    with pytest.raises(InputError, match="no time stamps; give --frame-rate-hz"):
        open_frames(tmp_path / "push.tif")


def test_single_image_is_still_no_film(tmp_path: Path) -> None:
    tifffile.imwrite(tmp_path / "push.tif", STACK[0])

    with pytest.raises(InputError, match="is a single image; give a stack"):
        open_frames(tmp_path / "push.tif", rate=10.0)


@pytest.mark.parametrize("contiguous", [True, False])
def test_torn_stack_is_told_from_a_short_one(tmp_path: Path, contiguous: bool) -> None:
    whole, torn = tmp_path / "whole.tif", tmp_path / "torn.tif"
    with tifffile.TiffWriter(whole) as writer:
        if contiguous:
            writer.write(STACK)
        else:
            for image in IMAGES:
                writer.write(image, contiguous=False)
    torn.write_bytes(whole.read_bytes()[: whole.stat().st_size // 2])

    with pytest.raises(InputError, match=r"torn\.tif: truncated"):
        open_frames(torn, rate=10.0)
    if not contiguous:
        frames = open_frames(torn, rate=10.0, allow_truncated=True)
        images = grey(frames)
        assert 4 <= len(images) < 12
        assert np.array_equal(images, STACK[: len(images)])
        assert any("truncated" in note for note in frames.notes)


def test_ome_that_promises_more_pages_than_there_are_is_truncated(tmp_path: Path) -> None:
    path = ome(tmp_path / "push.ome.tif", **planes(STAMPS))
    text = path.read_bytes()
    path.write_bytes(
        text.replace(b'SizeT="12"', b'SizeT="19"').replace(b'PlaneCount="12"', b'PlaneCount="19"')
    )

    with pytest.raises(InputError, match="12 of 19 promised pages"):
        open_frames(path, rate=10.0)


@pytest.mark.parametrize(
    ("axes", "shape", "words"),
    [("CYX", (2, 48, 64), "2 channels"), ("ZYX", (4, 48, 64), "4 focal planes")],
)
def test_what_is_no_series_in_time_is_refused_by_name(
    tmp_path: Path, axes: str, shape: tuple[int, ...], words: str
) -> None:
    path = ome(tmp_path / "push.ome.tif", np.zeros(shape, np.uint8), axes=axes)

    with pytest.raises(InputError, match=f"push.ome.tif: holds {words}; must be one"):
        open_frames(path, rate=10.0)


@pytest.mark.parametrize(
    ("xml", "words"),
    [
        ('<!DOCTYPE x [<!ENTITY a "b">]><OME>&a;</OME>', "document type"),
        ("<OME><Image>", "damaged"),
        ("<OME></OME>", "0 image series"),
        ('<OME><Image><Pixels SizeT="-3"/></Image></OME>', "SizeT = '-3'"),
        ('<OME><Image><Pixels PhysicalSizeX="inf" SizeT="2"/></Image></OME>', "PhysicalSizeX"),
    ],
)
def test_metadata_of_strangers_is_checked(tmp_path: Path, xml: str, words: str) -> None:
    path = tmp_path / "push.tif"
    whole = f'<?xml version="1.0" encoding="UTF-8"?>{xml}'
    tifffile.imwrite(path, STACK[:2], description=whole, metadata=None)
    with tifffile.TiffFile(path) as file:
        is_ome = file.is_ome

    if is_ome:
        with pytest.raises(InputError, match=words):
            open_frames(path, rate=10.0)
    else:  # what does not end as OME-XML does is a description like any other
        assert words == "damaged"
        assert len(list(open_frames(path, rate=10.0))) == 2


def test_other_files_that_the_metadata_name_are_not_opened(tmp_path: Path) -> None:
    xml = (
        '<?xml version="1.0"?><OME UUID="urn:uuid:1"><Image><Pixels SizeT="2" SizeC="1" SizeZ="1">'
        '<TiffData IFD="0" FirstT="0" PlaneCount="1"><UUID FileName="push.tif">urn:uuid:1</UUID>'
        '</TiffData><TiffData IFD="0" FirstT="1" PlaneCount="1">'
        '<UUID FileName="../other.tif">urn:uuid:2</UUID></TiffData></Pixels></Image></OME>'
    )
    tifffile.imwrite(tmp_path / "push.tif", STACK[:1], description=xml, metadata=None)

    with pytest.raises(InputError, match="is a single image"):  # the one page that is its own
        open_frames(tmp_path / "push.tif", rate=10.0)


def test_pages_of_two_sizes_are_refused(tmp_path: Path) -> None:
    with tifffile.TiffWriter(tmp_path / "push.tif") as writer:
        writer.write(STACK[0], metadata=None)
        writer.write(STACK[1, :40], metadata=None)

    with pytest.raises(InputError, match="page 2 is"):
        open_frames(tmp_path / "push.tif", rate=10.0)


def test_stacks_beside_single_images_are_refused(tmp_path: Path) -> None:
    tifffile.imwrite(tmp_path / "push.tif", STACK)
    assert cv2.imwrite(str(tmp_path / "frame.png"), IMAGES[0])

    with pytest.raises(InputError, match=r"push\.tif has several pages, beside images"):
        open_frames(tmp_path, rate=10.0)


def test_page_that_cannot_be_decoded_is_named(tmp_path: Path) -> None:
    path = tmp_path / "push.tif"
    tifffile.imwrite(path, STACK, compression="zlib")
    with tifffile.TiffFile(path) as file:
        at = file.pages[7].aspage().dataoffsets[0]
    data = bytearray(path.read_bytes())
    data[at : at + 8] = b"\xff" * 8
    path.write_bytes(bytes(data))

    assert "cannot be decoded" in refused(open_frames(path, rate=10.0))
