"""Which way a push turns the part at first contact, in closed form.

The voting theorem (Mason, Int. J. Robotics Research 5(3), 1986, DOI 10.1177/027836498600500303):
three lines through the contact – that of the push and the two edges of the friction cone – pass the
centre of drag on one side or the other, and the part turns as two of the three say. The majority of
three signs is the sign of the middle one of the three arms. Where it is less than what the start is
uncertain by, the part may turn either way.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from meso_robust.errors import InputError
from meso_robust.identification.experiment import PlannedPush
from meso_robust.identification.rollout import Setting
from meso_robust.simulator.support_models import Tables
from meso_robust.types import Floats


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Arms:
    """Signed arms about the centre of drag of N starts, m; positive turns counter-clockwise.

    Attributes
    ----------
    push
        (N,) of the line of the push.
    cone
        (N, 2) of the two edges of the friction cone.
    """

    push: Floats
    cone: Floats

    @property
    def middle(self) -> Floats:
        """(N,) the arm that decides: the median of the three, m."""
        return np.median(np.column_stack([self.push, self.cone]), axis=1)


def arms(setting: Setting, push: PlannedPush, starts: Floats, values: Floats) -> Arms:
    """Arms of a push at its first contact.

    Parameters
    ----------
    setting
        Part, bench and model.
    push
        The push; its tip meets the planned edge, as `experiment.edge_push` has it.
    starts
        (N, 3) poses of the part, m and rad.
    values
        (n,) parameters in SI.

    Raises
    ------
    InputError
        If the support has no centre of drag of its own.
    """
    physics = setting.model.physics(values[None])
    centre = centre_of_drag(physics.support.tables())
    corners = setting.part.outline
    side = corners[(push.edge + 1) % len(corners)] - corners[push.edge]
    side = side / np.hypot(*side)
    heading = np.array(push.travel) / np.hypot(*push.travel)
    normal = _turn(np.array([side[1], -side[0]]), starts[:, 2])
    corner = starts[:, :2] + _turn(corners[push.edge], starts[:, 2])
    ahead = setting.bench.tip_radius - np.sum((push.tip - corner) * normal, axis=1)
    way = ahead / (normal @ heading)
    contact = np.array(push.tip) + way[:, None] * heading - setting.bench.tip_radius * normal
    arm = contact - starts[:, :2] - _turn(centre, starts[:, 2])
    lean = np.arctan(float(physics.friction[0]))
    inward = np.arctan2(-normal[:, 1], -normal[:, 0])
    edges = [_cross(arm, _unit(inward + turn)) for turn in (-lean, lean)]
    return Arms(push=_cross(arm, heading[None]), cone=np.column_stack(edges))


def centre_of_drag(tables: Tables) -> Floats:
    """(2,) the point about which a translation meets no torque, m, body frame.

    Parameters
    ----------
    tables
        Of a support, of one run.

    Raises
    ------
    InputError
        If the support is a mixture whose parts have no centre in common, or is anisotropic.
    """
    centres = []
    for matrix in (tables.film[0], tables.surface[0]):
        if matrix.any():
            if abs(matrix[0] - matrix[3]) > 1e-9 * matrix[0] or abs(matrix[1]) > 1e-9 * matrix[0]:
                raise InputError("support: anisotropic; has no centre of drag; use the spread only")
            centres.append(np.array([matrix[4] / matrix[3], -matrix[2] / matrix[0]]))
    if tables.points.shape[1]:
        points = tables.points[0]
        centres.append(points[:, 2] @ points[:, :2] / points[:, 2].sum())
    if not all(np.allclose(centre, centres[0], atol=1e-9) for centre in centres):
        raise InputError("support: parts with centres apart; has no centre of drag; use one part")
    return np.asarray(centres[0])


def _turn(vector: Floats, theta: Floats) -> Floats:
    """(N, 2) a vector (2,) turned by angles (N,)."""
    cos, sin = np.cos(theta), np.sin(theta)
    x, y = vector
    return np.column_stack([cos * x - sin * y, sin * x + cos * y])


def _unit(angle: Floats) -> Floats:
    return np.column_stack([np.cos(angle), np.sin(angle)])


def _cross(a: Floats, b: Floats) -> Floats:
    return np.asarray(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
