"""What OME-XML and ImageJ say of the pages of a TIFF file: instants and the size of a pixel.

The schema of OME-XML: https://www.openmicroscopy.org/Schemas/OME/2016-06. A file is data from a stranger:
no document type and no entities are read, and files that it names beside itself are not opened.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

from meso_robust.errors import InputError
from meso_robust.reading import LARGEST_DATA, MIB, shown

_SECONDS = {"s": 1.0, "ms": 1e-3, "µs": 1e-6, "us": 1e-6, "ns": 1e-9, "min": 60.0}
_METRES = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "µm": 1e-6, "um": 1e-6, "nm": 1e-9, "Å": 1e-10}
_METRES |= {"micron": 1e-6, "microns": 1e-6, "\\u00B5m": 1e-6, "inch": 0.0254}
_SQUARE = 1e-3  # by which the sides of a pixel may differ and still be one number

_RESAVE = "save one channel of one place as a series in time"


@dataclass(frozen=True, slots=True, kw_only=True)
class Metadata:
    """What a TIFF file says beside its pixels.

    Attributes
    ----------
    promised
        Number of pages that it says it has; None if it does not say.
    times
        Instants of its pages in s; empty if it does not say.
    pixel
        Side of a pixel in m; None if it does not say, or its sides differ.
    notes
        What a user should know.
    bits
        Depth of its grey values; None if it does not say.
    """

    promised: int | None = None
    times: tuple[float, ...] = ()
    pixel: float | None = None
    notes: tuple[str, ...] = ()
    bits: int | None = None


def ome(path: Path, xml: str, pages: int) -> Metadata:
    """What the OME-XML of a file says of its pages.

    Raises
    ------
    InputError
        It is damaged, or the pages are not one series in time.
    """
    pixels, own = _pixels(path, xml)
    frames = _count(path, pixels, "SizeT")
    for size, what in (("SizeZ", "focal planes"), ("SizeC", "channels")):
        count = _count(path, pixels, size)
        if size == "SizeC":  # a colour image is one channel with three samples
            count = max(1, len(list(_named(pixels, "Channel"))))
        if count > 1:
            raise InputError(f"{path}: holds {count} {what}; must be one; {_RESAVE}")
    at, listed = _instants_by_page(path, pixels, own, pages)
    sides = [_scaled(path, pixels, f"PhysicalSize{axis}", _METRES, "µm") for axis in "XY"]
    side, notes = _one_side(sides)
    times = _times(path, pixels, at, pages)
    exposures = [
        exposure
        for plane in _named(pixels, "Plane")
        if (exposure := _scaled(path, plane, "ExposureTime", _SECONDS, "s"))
    ]
    if exposures:
        low, high = 1e3 * min(exposures), 1e3 * max(exposures)
        span = f"{low:g}" if low == high else f"{low:g} to {high:g}"
        notes += (f"the file states exposures of {span} ms; instants are its stamps, as they are",)
    return Metadata(
        promised=listed or frames,
        times=times,
        pixel=side,
        notes=notes,
        bits=_count(path, pixels, "SignificantBits", 0) or None,
    )


def imagej(path: Path, values: Mapping[str, object], per_unit: tuple[float, float]) -> Metadata:
    """What ImageJ's lines say; ``per_unit``: pixels a unit of length along x and y."""
    counts = {name: values.get(name, 1) for name in ("channels", "slices", "frames", "images")}
    if not all(isinstance(count, int) and count > 0 for count in counts.values()):
        raise InputError(f"{path}: ImageJ's counts {shown(counts)}; must be positive; {_RESAVE}")
    several = [name for name in ("slices", "frames") if counts[name] != 1]
    if counts["channels"] != 1 or len(several) > 1:  # ImageJ calls any stack one of slices
        text = ", ".join(f"{counts[name]} {name}" for name in ("channels", "slices", "frames"))
        raise InputError(f"{path}: holds {text}; must be one series; {_RESAVE}")
    step, unit = values.get("finterval"), _METRES.get(str(values.get("unit", "")))
    images = int(str(counts["images"]))
    clock = isinstance(step, int | float) and 0.0 < step < math.inf
    times = tuple(float(str(step)) * k for k in range(images)) if clock else ()
    sides = [unit / each if unit and each > 0.0 else None for each in per_unit]
    side, notes = _one_side(sides)
    return Metadata(promised=images, times=times, pixel=side, notes=notes)


def _one_side(sides: list[float | None]) -> tuple[float | None, tuple[str, ...]]:
    x, y = sides
    if x is None or y is None:
        return None, ()
    if abs(x - y) > _SQUARE * max(x, y):
        return None, (f"the file's pixels are {1e6 * x:g} x {1e6 * y:g} um: not used, not square",)
    return x, ()


def _pixels(path: Path, xml: str) -> tuple[ElementTree.Element, str | None]:
    """The one ``Pixels`` element, and the identifier of this file among several."""
    if len(xml) > LARGEST_DATA:
        raise InputError(f"{path}: OME-XML beyond {LARGEST_DATA // MIB} MiB; {_RESAVE}")
    if "<!" in xml.replace("<!--", ""):
        raise InputError(f"{path}: OME-XML with a document type; must have none; {_RESAVE}")
    try:
        root = ElementTree.fromstring(xml)
    except ElementTree.ParseError as error:
        raise InputError(f"{path}: OME-XML is damaged ({error}); {_RESAVE}") from error
    found = [pixels for image in _named(root, "Image") for pixels in _named(image, "Pixels")]
    if len(found) != 1:
        raise InputError(f"{path}: holds {len(found)} image series; must be one; {_RESAVE}")
    return found[0], root.get("UUID")


def _named(element: ElementTree.Element, name: str) -> Iterator[ElementTree.Element]:
    return (child for child in element if child.tag.rpartition("}")[2] == name)


def _count(path: Path, element: ElementTree.Element, name: str, default: int = 1) -> int:
    text = element.get(name, str(default))
    if not (text.isascii() and text.isdecimal() and len(text) < 10):
        raise InputError(f"{path}: OME-XML: {name} = {shown(text)}; must be a count; {_RESAVE}")
    return int(text)


def _scaled(
    path: Path, element: ElementTree.Element, name: str, units: Mapping[str, float], unit: str
) -> float | None:
    """A number in SI; None if it is not stated, or in a unit that is no measure."""
    text, unit = element.get(name), element.get(f"{name}Unit", unit)
    if text is None or unit not in units:
        return None
    try:
        value = float(text) * units[unit]
    except ValueError:
        value = math.nan
    if not (0.0 <= value < math.inf):
        raise InputError(
            f"{path}: OME-XML: {name} = {shown(text)}; must be finite and not negative; {_RESAVE}"
        )
    return value


def _instants_by_page(
    path: Path, pixels: ElementTree.Element, own: str | None, pages: int
) -> tuple[dict[int, int], int]:
    """Place in time of each page by the file's own list, and the number of pages in that list.

    A list may tell of other files of the same film too; their pages are passed over.
    """
    at: dict[int, int] = {}
    listed = 0
    for data in _named(pixels, "TiffData"):
        files = [(one.text or "").strip() for one in _named(data, "UUID")]
        if own is not None and any(name != own for name in files):
            continue
        if not {"IFD", "PlaneCount"} & set(data.attrib):
            continue  # all pages, in their order
        first, time = _count(path, data, "IFD", 0), _count(path, data, "FirstT", 0)
        count = _count(path, data, "PlaneCount", 1 if "IFD" in data.attrib else pages)
        at |= {first + k: time + k for k in range(min(count, pages))}
        listed += count
    return at or {k: k for k in range(pages)}, listed


def _times(
    path: Path, pixels: ElementTree.Element, at: Mapping[int, int], pages: int
) -> tuple[float, ...]:
    """Instants of the pages by their planes' stamps, or else by the step from plane to plane."""
    stamps = {
        _count(path, plane, "TheT", 0): stamp
        for plane in _named(pixels, "Plane")
        if (stamp := _scaled(path, plane, "DeltaT", _SECONDS, "s")) is not None
    }
    places = [at.get(k) for k in range(pages)]
    found = [None if place is None else stamps.get(place) for place in places]
    known = [stamp for stamp in found if stamp is not None]
    if len(known) == pages:
        return tuple(known)
    step = _scaled(path, pixels, "TimeIncrement", _SECONDS, "s")
    if not known and step:
        return tuple(step * place for place in places if place is not None)
    if known:
        raise InputError(
            f"{path}: OME-XML gives the instants of {len(known)} of {pages} pages; must be all or "
            "none; give --frame-rate-hz"
        )
    return ()
