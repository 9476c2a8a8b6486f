"""Whatever stands in a file, an importer reads it or says why not."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest
from hypothesis import given, settings, strategies as st

from meso_robust.errors import InputError
from meso_robust.recordings import RecordingSet
from meso_robust.recordings.importers import FORMATS, Importer
from tests.recordings.importers import written

NUMBERS = st.one_of(
    st.integers(-3, 2**70),
    st.floats(),
    st.sampled_from([written.START, written.START + 0.01, 0, -1.5, 1e300, 10**400]),
)
CELLS = st.one_of(NUMBERS, st.text(max_size=4))


def lines_of(separator: str, widths: list[int]) -> st.SearchStrategy[bytes]:
    """Text of lines whose lengths are often right."""
    row = st.sampled_from(widths).flatmap(lambda n: st.lists(CELLS, min_size=n, max_size=n))
    rows = st.lists(row.map(lambda cells: separator.join(map(str, cells))), max_size=9)
    return rows.map(lambda lines: "\n".join(lines).encode("utf-8", "replace"))


def streams() -> st.SearchStrategy[bytes]:
    """JSON whose keys and shapes are often right."""
    rows = st.lists(st.lists(NUMBERS, min_size=3, max_size=4), max_size=4)
    keys = st.sampled_from(["object_pose", "tip_pose", "ft_wrench"])
    return st.dictionaries(keys, rows, min_size=2).map(lambda values: json.dumps(values).encode())


CASES = {
    "mcube_json": (written.MCUBE_NAME.format(shape="rect1"), streams()),
    "two_finger_log": ("tri_0/log.txt", lines_of(",", [8, 8, 7])),
    "support_point_log": ("patch/exp.txt", lines_of(" ", [1, 7, 3, 8])),
}


def attempt(importer: Importer, name: str, content: bytes) -> None:
    """Recognise and read a file; it may only be read, or refused with its name."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / name
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(content)
        importer.recognises(path)
        told = folder
        try:
            assert isinstance(importer.read(path).recordings, RecordingSet)
        except InputError as error:
            told = str(error)
        assert folder in told


@pytest.mark.parametrize("form", FORMATS)
def test_a_file_is_read_or_refused(form: str) -> None:
    name, contents = CASES[form]
    check: Callable[[], None] = settings(max_examples=25, deadline=None)(
        given(st.one_of(contents, st.binary(max_size=40)))(
            lambda content: attempt(FORMATS[form], name, content)
        )
    )
    check()
