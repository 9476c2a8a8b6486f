"""The common push by MuJoCo: free joint, elliptic cone.

Lengths are a tenth of a unit to the mm, as MuJoCo's contacts are tuned to things of that size. The
probe is a heavy ball on a slide, low on the side of the box so as not to tip it, and is put back on
its path at each output: a mocap body would rub as if at rest.
"""

from __future__ import annotations

import copy
from dataclasses import dataclass
from importlib import import_module
from typing import Any

import numpy as np
import numpy.typing as npt

from reports.benchmarks.one_push import (
    HALF_HIGH,
    HALF_LONG,
    HALF_SHORT,
    MU,
    OUTPUTS,
    RADIUS,
    TIP,
    TRAVEL,
    Ground,
)
from reports.benchmarks.timing import Clock, best

F = npt.NDArray[np.float64]

_UNIT = 0.1  # of MuJoCo to the mm
_FOOT = 0.01  # mm, radius of the balls that the box stands on
_SCENE = """<mujoco>
<option timestep="{dt}" cone="elliptic" gravity="0 0 -9.81" integrator="implicitfast"/>
<default><geom solref="{solref} 1" mass="0" friction="{slide} 0 0"/></default>
<worldbody>
<geom type="plane" size="2 2 1"/>
<body pos="0 0 {z}"><freejoint/>
<geom type="box" size="{a} {b} {c}" contype="2" conaffinity="2" mass="0.1"/>{feet}</body>
<body gravcomp="1" pos="{x} {y} {r}"><joint type="slide" axis="0 1 0"/>
<geom type="sphere" size="{r}" contype="2" conaffinity="2" friction="{mu} 0 0" priority="1" mass="1e4"/>
</body></worldbody></mujoco>"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Setting:
    """One choice of MuJoCo's numbers."""

    name: str
    dt: float
    """Time step, s."""
    duration: float = 1.0
    """Of the push, s: shorter pushes have more inertia."""
    solref: float = 0.02
    """Time constant of the contacts, s; 0.02 is MuJoCo's own."""
    slide: float = 0.3
    """Friction under the feet: less of it tips the box less."""

    @property
    def steps(self) -> int:
        """Number of time steps."""
        return round(self.duration / self.dt)


SETTINGS = (
    Setting(name="dt 5 ms", dt=5e-3),
    Setting(name="dt 0.5 ms", dt=5e-4),
    Setting(name="dt 0.5 ms, hard contacts", dt=5e-4, solref=2e-3),
    Setting(name="dt 5 ms, ten times slower, slippery", dt=5e-3, duration=10.0, slide=0.03),
    Setting(name="dt 0.5 ms, ten times slower, slippery", dt=5e-4, duration=10.0, slide=0.03),
)


def _model(mujoco: Any, ground: Ground, setting: Setting) -> Any:
    """Compile the scene."""
    down = -HALF_HIGH * _UNIT
    feet = "".join(
        f'<geom type="sphere" size="{_FOOT * _UNIT}" pos="{x * _UNIT} {y * _UNIT} {down}"/>'
        for x, y in ground.points
    )
    scene = _SCENE.format(
        dt=setting.dt, solref=setting.solref, slide=setting.slide, mu=MU, feet=feet,
        a=HALF_LONG * _UNIT, b=HALF_SHORT * _UNIT, c=HALF_HIGH * _UNIT,
        x=TIP[0] * _UNIT, y=TIP[1] * _UNIT, r=RADIUS * _UNIT, z=(HALF_HIGH + _FOOT) * _UNIT,
    )  # fmt: skip
    return mujoco.MjModel.from_xml_string(scene)


def _settled(mujoco: Any, model: Any, setting: Setting) -> Any:
    """The box at rest on its feet, the probe about to start at its side."""
    data = mujoco.MjData(model)
    data.qpos[7] = -_UNIT
    mujoco.mj_step(model, data, round(0.2 / setting.dt))
    data.qpos[7] = 0.0
    data.qvel[:] = 0.0
    return data


def _take(mujoco: Any, model: Any, data: Any, setting: Setting) -> F:
    """Push, and return the poses (x, y in units, rad) at the outputs."""
    path = np.zeros((OUTPUTS, 3))
    for k in range(OUTPUTS):
        data.qpos[7] = TRAVEL * _UNIT * k / OUTPUTS
        data.qvel[6] = TRAVEL * _UNIT / setting.duration
        mujoco.mj_step(model, data, setting.steps // OUTPUTS)
        q = data.qpos
        path[k] = q[0], q[1], 2.0 * np.arctan2(q[6], q[3])
    return path


def mujoco_push(ground: Ground, setting: Setting) -> tuple[F, Clock]:
    """End of the push (x, y in mm, θ in deg) and its time.

    Raises
    ------
    ImportError
        If MuJoCo is not installed.
    """
    mujoco: Any = import_module("mujoco")
    model = _model(mujoco, ground, setting)
    start = _settled(mujoco, model, setting)
    last = _take(mujoco, model, copy.copy(start), setting)[-1]
    end = last - [start.qpos[0], start.qpos[1], 0.0]
    clock = best(
        lambda data: _take(mujoco, model, data, setting),
        lambda: copy.copy(start),
        2 if setting.steps > 5000 else 5,
    )
    return np.array([end[0] / _UNIT, end[1] / _UNIT, np.degrees(end[2])]), clock
