"""Planar quasi-static pushing by point tips, simulated by complementarity time steps.

A convex part on a viscous film is pushed by tips with prescribed paths, with Coulomb friction at
the contacts. The simulator is the judge of the verified bounds and shares no code with them.
"""

from meso_robust.simulator.batch import simulate as simulate
from meso_robust.simulator.outcome import Outcome as Outcome
from meso_robust.simulator.push import Push as Push, PushResult as PushResult
