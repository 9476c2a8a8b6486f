"""Poses at evenly spaced instants of a move, in the motion that is going on."""

from meso_robust.simulator.events.channel import glide_inside, prepare_inside
from meso_robust.simulator.events.curve import CUBIC, pose_at
from meso_robust.simulator.events.fused import sealed
from meso_robust.simulator.events.scene import SAMPLE, Scene, Work
from meso_robust.simulator.events.stride import stride
from meso_robust.types import Floats


@sealed
def _instant(work: Work, path: Floats, sample: int) -> float:
    """The clock at a sample of the path."""
    return float(work.whole * sample / (path.shape[0] - 1))


@sealed
def sample_curve(work: Work, path: Floats, clock: float, length: float) -> None:
    """Write the samples that fall on a curve of closed form."""
    while work.count[SAMPLE] < path.shape[0]:
        sample = work.count[SAMPLE]
        time = _instant(work, path, sample) - clock
        if time > length:
            break
        path[sample, 0], path[sample, 1], path[sample, 2] = pose_at(work, time)
        work.count[SAMPLE] = sample + 1


@sealed
def sample_step(scene: Scene, work: Work, path: Floats, clock: float, length: float) -> None:
    """Write the samples that fall in a step, the last that was tried.

    In a Runge-Kutta step each is a shorter one, but in a channel, where the way inside is known.
    """
    if work.curve[0] != CUBIC:
        sample_curve(work, path, clock, length)
        return
    whole, first = work.curve[13], True
    while work.count[SAMPLE] < path.shape[0]:
        sample = work.count[SAMPLE]
        time = _instant(work, path, sample) - clock
        if time > length:
            break
        if work.channel[0] > 0.0:
            if first:
                prepare_inside(scene, work, whole)
            first = False
            glide_inside(scene, work, whole, time)
        else:
            stride(scene, work, clock, time)
        for m in range(3):
            path[sample, m] = work.trial[m]
        work.count[SAMPLE] = sample + 1
