"""The hash by which results name the recordings that they are of."""

from __future__ import annotations

import hashlib

import numpy as np

from meso_robust.recordings.values import RecordingSet


def set_hash(recordings: RecordingSet) -> str:
    """SHA-256 of the values of a recording set.

    Parameters
    ----------
    recordings
        Values in SI, as read: files that differ in layout only have one hash.

    Returns
    -------
    str
        64 hexadecimal digits.
    """
    digest = hashlib.sha256()
    sensor = recordings.sensor
    sigmas = (sensor.position_sigma, sensor.orientation_sigma)
    head = (recordings.tip_radius, recordings.position_source, sensor.frame_rate, sigmas)
    digest.update(repr(head).encode())
    digest.update(np.ascontiguousarray(recordings.part.outline).tobytes())
    # absent from sets that were hashed before there were such keys
    if sensor.tip_sigma is not None:
        digest.update(repr(sensor.tip_sigma).encode())
    if sensor.tip_offset is not None:
        digest.update(repr(("tip_offset", sensor.tip_offset)).encode())
    if sensor.tip_offset_across is not None:
        ways = [one.tip_directions for one in recordings.recordings]
        digest.update(repr(("tip_offset_across", sensor.tip_offset_across, ways)).encode())
    for one in recordings.recordings:
        digest.update(repr((one.file, one.probe_names, len(one.times))).encode())
        for array in (one.times, one.poses, one.probes):
            digest.update(np.ascontiguousarray(array).tobytes())
    return digest.hexdigest()
