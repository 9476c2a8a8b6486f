"""All direct tests of a set, one after the other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from meso_robust.recordings.checks.view import unseen
from meso_robust.recordings.direct.balance import BalanceTest, balance_test
from meso_robust.recordings.direct.clocks import ClockTest, Stream, clock_test
from meso_robust.recordings.direct.finding import Estimate, Finding
from meso_robust.recordings.direct.gap import GapTest, gap_test
from meso_robust.recordings.direct.hand import HandTest, hand_test
from meso_robust.recordings.direct.pushing import Contacts, contacts, moving
from meso_robust.recordings.direct.straight import StraightTest, straight_test
from meso_robust.recordings.direct.trends import Trend, trends
from meso_robust.recordings.noise import estimated_noise, position_repeatability
from meso_robust.recordings.rules import UM
from meso_robust.recordings.values import Recording, RecordingSet

_MS = 1e-3
_LATENCY = "camera_latency"
_LEAST_TIP = 1e-8  # m: finer than any drive, and what six decimals of um and rounding leave
_NORMAL_90 = 1.645
_LEAST_JITTER = 0.05  # of a period, below which stamps are as regular as anyone needs


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class DirectTests:
    """What the tests without a simulation say of a set; None where one could not be made.

    Attributes
    ----------
    pairs
        Tips and part while it moves.
    hand, gap, balance
        Of the part in the hand's frame, of tip and face, of moments. The gap is that with the hand's
        latency taken out.
    gap_trends, balance_trends
        What is left of the latter two against heading, speed, place, time and side.
    straight
        Noise of the tips' log and its stamps.
    clocks
        Of every stream.
    findings
        Of all tests, the largest share removed first; an effect that two of them see is that of the
        first of hand, gap, balance.
    """

    pairs: Contacts
    hand: HandTest | None
    gap: GapTest | None
    balance: BalanceTest | None
    gap_trends: tuple[Trend, ...]
    balance_trends: tuple[Trend, ...]
    straight: StraightTest | None
    clocks: tuple[ClockTest, ...]
    findings: tuple[Finding, ...]


def direct_tests(recordings: RecordingSet, streams: Sequence[Stream] = ()) -> DirectTests:
    """Judge a set by what needs no simulation.

    Parameters
    ----------
    recordings
        The set as read; a pose that is no measurement should be unseen.
    streams
        Streams with stamps of their own, where the set was made of some; by default the rows of the
        recordings.

    Returns
    -------
    DirectTests
        For any set that can be read.
    """
    recordings = replace(recordings, recordings=tuple(map(_without_repeats, recordings.recordings)))
    runs = tuple(moving(recordings, one) for one in recordings.recordings)
    hand = hand_test(recordings, runs)
    delays = [
        one.estimates[0].value for one in (hand.findings if hand else ()) if one.effect == _LATENCY
    ]
    late = _MS * delays[0] if delays else 0.0
    pairs = contacts(recordings, runs, late)
    gap = gap_test(recordings, pairs, frozenset({_LATENCY} if late else ()))
    balance = balance_test(recordings, pairs)
    clocks = tuple(test for stream in streams or _rows(recordings) if (test := clock_test(stream)))
    straight = straight_test(recordings) if recordings.position_source == "controller" else None
    found: dict[str, Finding] = {}
    for seen in (hand, gap, balance):
        for one in seen.findings if seen else ():
            found.setdefault(one.effect, one)
    findings = [
        *found.values(),
        *_of_stamps(recordings, clocks, straight),
        *_of_rest(recordings),
    ]
    findings.sort(key=lambda one: one.after / one.before if one.before else 1.0)
    return DirectTests(
        pairs=pairs,
        hand=hand,
        gap=gap,
        balance=balance,
        gap_trends=_trends(gap, pairs),
        balance_trends=trends(balance.after, pairs, balance.rows) if balance else (),
        straight=straight,
        clocks=clocks,
        findings=tuple(findings),
    )


def _trends(gap: GapTest | None, pairs: Contacts) -> tuple[Trend, ...]:
    if gap is None or not gap.after.any():
        return ()
    return trends(gap.after, pairs, np.arange(gap.after.size))


def _without_repeats(recording: Recording) -> Recording:
    """The recording without poses that repeat the one before bit by bit while a tip moves."""
    poses, probes = recording.poses, recording.probes
    same = np.zeros(len(poses), dtype=bool)
    same[1:] = np.all(np.diff(poses, axis=0) == 0.0, axis=1)
    same[1:] &= np.any(np.diff(probes, axis=0) != 0.0, axis=(1, 2))
    # many equal poses are a part at rest, or a simulation without noise
    if 2 * np.count_nonzero(same) > len(poses):
        return recording
    return unseen(recording, np.flatnonzero(same))


def _rows(recordings: RecordingSet) -> list[Stream]:
    """The rows of every recording as one stream of tips, or of poses where there are none."""
    streams = []
    for one in recordings.recordings:
        name = one.probe_names[0] if one.probe_names else "part"
        values = one.probes[:, 0] if one.probe_names else one.poses[:, :2]
        streams.append(Stream(file=one.file, name=name, times=one.times, values=values))
    return streams


def _of_rest(recordings: RecordingSet) -> list[Finding]:
    """A sway of the part while it rests: of the camera or the stage, for no tip moves it."""
    noise = estimated_noise(recordings)
    sway, scatter = noise.sway, position_repeatability(noise)
    if sway is None or scatter is None:
        return []
    error = _NORMAL_90 * float(np.hypot(*sway.error[:2]) / np.sqrt(2.0))
    estimates = [("size_um", sway.metres / UM, error / UM), ("rate_hz", sway.rate, sway.rate_error)]
    return [
        Finding(
            test="rest",
            effect="image_sway",
            estimates=tuple(
                Estimate(key=key, value=value, low=value - half, high=value + half)
                for key, value, half in estimates
            ),
            before=float(np.hypot(scatter, sway.metres)),
            after=scatter,
            p_value=sway.p_value,
        )
    ]


def _of_stamps(
    recordings: RecordingSet, clocks: Sequence[ClockTest], straight: StraightTest | None
) -> list[Finding]:
    """Stamps that jitter, and noise of the tips' log."""
    findings = []
    blamed = [
        one for one in clocks if one.stamps_at_fault and one.jitter > _LEAST_JITTER * one.period
    ]
    if blamed and 2 * len(blamed) >= len({one.file for one in clocks}):
        jitters = np.array([one.jitter / _MS for one in blamed])
        low, high = np.quantile(jitters, [0.1, 0.9]).tolist()
        findings.append(
            Finding(
                test="clock",
                effect="stamp_jitter",
                estimates=(
                    Estimate(
                        key="time_ms",
                        value=float(np.median(jitters)),
                        low=low,
                        high=high,
                    ),
                ),
                before=float(np.median([one.rough for one in blamed])),
                after=float(np.median([one.rough_regular for one in blamed])),
                p_value=float("nan"),
            )
        )
    noisy = straight and straight.even and straight.tip_sigma > _LEAST_TIP
    if recordings.sensor.tip_sigma is None and straight and noisy:
        # a median is worth 37 % of its samples, and pieces overlap by half
        error = float(_NORMAL_90 / np.sqrt(1.1 * straight.pieces)) * straight.tip_sigma
        findings.append(
            Finding(
                test="straight",
                effect="tip_log_noise",
                estimates=(
                    Estimate(
                        key="sigma_um",
                        value=straight.tip_sigma / UM,
                        low=(straight.tip_sigma - error) / UM,
                        high=(straight.tip_sigma + error) / UM,
                    ),
                ),
                before=straight.tip_sigma,
                after=straight.tip_sigma,
                p_value=float("nan"),
            )
        )
    return findings
