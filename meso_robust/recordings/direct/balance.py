"""The balance of moments while one tip pushes: it holds for every friction between tip and part.

On drag E a force f at the contact moves the part with v = f / e_x and turns it with
ω = (p × f) / (ρ e_x), so p × v = ρ ω however the tip sticks or slides, and whatever the limit surface
is as long as it is an ellipsoid. Divided by the speed of the tip this is a length, the error of the
lever arm. An anisotropic drag, a centre of drag beside the reference point, a gradient or a force that
acts on the part without touching it add a term each that is linear in its size.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from meso_robust.recordings.contact import size
from meso_robust.recordings.direct.finding import Estimate, Finding, possible
from meso_robust.recordings.direct.pushing import Contacts
from meso_robust.recordings.direct.selection import Columns, Comparison, selected
from meso_robust.recordings.outline import gyration
from meso_robust.recordings.rules import DEG, UM
from meso_robust.recordings.values import RecordingSet
from meso_robust.types import Floats, Ints

_FEWEST = 10
_RATIO = "film"
_LAYS = frozenset({"anisotropic_drag", "part_anisotropic_drag"})


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BalanceTest(Comparison):
    """Errors of the lever arm at the contact, with ρ alone and with what was found.

    Attributes
    ----------
    rows
        (n,) rows of the contacts that were used.
    rho
        Ratio of drags in m².
    """

    rows: Ints
    rho: float


def balance_test(recordings: RecordingSet, pairs: Contacts) -> BalanceTest | None:
    """Hold the motion of a part that one tip pushes against the balance of moments.

    Parameters
    ----------
    recordings
        The set.
    pairs
        Of its pushing frames.

    Returns
    -------
    BalanceTest or None
        None of fewer than ten frames in which one tip alone pushes.
    """
    rows = np.flatnonzero(pairs.alone)
    if rows.size < _FEWEST:
        return None
    outline = recordings.part.outline
    values, columns = _terms(pairs, rows, gyration(outline))
    groups = np.unique(pairs.recording[rows], return_inverse=True)[1]
    size_um = size(outline) / UM
    plain = selected(values, groups, {_RATIO: columns[_RATIO]}, lambda *_: True, fixed=(_RATIO,))
    chosen = selected(
        values,
        groups,
        columns,
        lambda effect, key, value: possible(effect, key, value, size_um),
        fixed=(_RATIO,),
    )
    findings = tuple(
        Finding(
            test="balance",
            effect=step.effect,
            estimates=_lay(chosen.estimates[step.effect])
            if step.effect in _LAYS
            else chosen.estimates[step.effect],
            before=step.before,
            after=step.after,
            p_value=step.p_value,
            alike=step.alike,
        )
        for step in chosen.steps
    )
    return BalanceTest(
        rows=rows,
        recording=pairs.recording[rows],
        rho=UM**2 * chosen.estimates[_RATIO][0].value,
        before=plain.residual,
        after=chosen.residual,
        findings=findings,
    )


def _terms(pairs: Contacts, rows: Ints, radius: float) -> tuple[Floats, Mapping[str, Columns]]:
    """Lever arm times speed over speed, (n,) m, and what it is made of."""
    poses, velocities = pairs.poses[rows], pairs.velocities[rows]
    cos, sin = np.cos(poses[:, 2]), np.sin(poses[:, 2])
    along, across = np.stack((cos, sin), -1), np.stack((-sin, cos), -1)
    own = pairs.tip[rows] - (pairs.tip_radius * pairs.normal[rows])
    arm = own[:, :1] * along + own[:, 1:] * across
    v, omega = velocities[:, :2], velocities[:, 2]
    speed = np.sqrt(np.sum(v**2, axis=1) + (radius * omega) ** 2)

    def shifted(directions: Floats, by: float) -> Floats:
        """Change by a centre of drag that lies ``by`` m along directions (n, 2)."""
        moment = _cross(directions, v) - omega * np.sum(arm * directions, axis=1)
        return np.asarray(by * moment / speed)

    x, y = np.array([[1.0, 0.0]]), np.array([[0.0, 1.0]])
    ones = np.ones((rows.size, 1))
    own_v = np.stack((np.sum(along * v, axis=1), np.sum(across * v, axis=1)), -1)
    stage = [-_cross(arm, lay) / speed for lay in (v * [1.0, -1.0], v[:, ::-1])]
    part = [-_cross(own, lay) / speed for lay in (own_v * [1.0, -1.0], own_v[:, ::-1])]
    slope = 0.5e3 * radius**2  # m of shift a unit per mm: second moment over area about one axis
    both = ("along", "diagonal")
    return _cross(arm, v) / speed, {
        _RATIO: Columns(("rho_um2",), (UM**2 * omega / speed)[:, None]),
        "anisotropic_drag": Columns(both, np.column_stack(stage)),
        "part_anisotropic_drag": Columns(both, np.column_stack(part)),
        "drag_centre_offset": Columns(
            ("x_um", "y_um"), np.column_stack((shifted(along, UM), shifted(across, UM)))
        ),
        "drag_gradient": Columns(
            ("x_per_mm", "y_per_mm"),
            np.column_stack((shifted(ones * x, slope), shifted(ones * y, slope))),
        ),
        "body_force": Columns(
            ("x_um_s", "y_um_s"),
            np.column_stack([UM * _cross(arm, ones * axis) / speed for axis in (x, y)]),
        ),
    }


def _cross(a: Floats, b: Floats) -> Floats:
    return np.asarray(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])


def _lay(parts: tuple[Estimate, ...]) -> tuple[Estimate, ...]:
    """Fraction and direction of the largest drag from its components along x and along the diagonal."""
    along, diagonal = parts
    fraction = float(np.hypot(along.value, diagonal.value))
    half = 0.5 * max(along.high - along.low, diagonal.high - diagonal.low)
    angle = 0.5 * float(np.arctan2(diagonal.value, along.value)) / DEG
    turn = 0.5 * float(np.arctan2(half, fraction)) / DEG
    return (
        Estimate(key="fraction", value=fraction, low=fraction - half, high=fraction + half),
        Estimate(key="direction_deg", value=angle, low=angle - turn, high=angle + turn),
    )
