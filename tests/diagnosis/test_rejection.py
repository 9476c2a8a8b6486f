"""Every ground is told in words of its own, with the numbers that it has."""

from __future__ import annotations

import pytest

from meso_robust.diagnosis.rejection import Ground, Rejection


@pytest.mark.parametrize("ground", Ground)
def test_every_ground_has_words_that_tell_its_data(ground: Ground) -> None:
    words = Rejection(
        ground=ground, names=("backlash",), amount=17.0, limit=1.25, invariance="speed"
    ).words
    assert words
    assert "{" not in words
    told = {
        Ground.NO_GAIN: (),
        Ground.MISMATCH_LEFT: ("backlash",),
        Ground.SAME_MOTION: ("backlash",),
        Ground.OUTSCORED: ("backlash", "17 nats"),
        Ground.SLIGHT_MEMBER: ("17 nats",),
        Ground.SUBSET_SUFFICES: ("backlash",),
        Ground.HELD_OUT_WORSE: ("17.0 nats",),
        Ground.IDLE_MEMBER: ("backlash",),
        Ground.ABOVE_FLOOR: ("17.00 σ", "1.25 σ"),
        Ground.IMPROBABLE: ("17 %",),
        Ground.FAR_BEHIND: ("17 nats", "backlash"),
        Ground.INVARIANCE: ("speed", "backlash"),
    }[ground]
    assert all(part in words for part in told), words


def test_no_two_grounds_read_alike() -> None:
    words = [Rejection(ground=ground, names=("backlash",)).words for ground in Ground]
    assert len(set(words)) == len(words)
