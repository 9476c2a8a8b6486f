"""What is kept of a run: pose, tips, forces and contact modes at given instants.

A row of the record is ``time, x, y, θ, mode of the fixture`` and then for each probe ``x, y, f_x, f_y,
mode``; world frame, forces on the part over e_x. The force of a step and its modes hold over the step.
"""

from meso_robust.kernels import sealed
from meso_robust.simulator.rows import TOLERANCE, slips
from meso_robust.simulator.tables import CONTACTS, MARKS, OBSTACLES, PART, STEP
from meso_robust.types import Floats, Ints

TIME, POSE, FIXTURE_MODE, PROBES = 0, 1, 4, 5
"""Columns of a record."""
TIP, FORCE, PROBE_MODE, PER_PROBE = 0, 2, 4, 5
"""Columns of a probe in a record, and their number."""

_SLIP = 1e-6  # units: slower than this sticks


@sealed
def contact_mode(contacts: Floats, marks: Ints, step: Floats, count: int, c: int) -> int:
    """Tell the mode of a contact: 0 separate, 1 stick, 2 slip +, 3 slip −.

    In slip + the friction on the part points along t, the inward normal turned by +90°.
    """
    if contacts[c, CONTACTS.ln] <= TOLERANCE:
        return 0
    _, vt = slips(contacts, marks, step, count, c)
    if abs(vt) <= _SLIP:
        return 1
    return 2 if vt < 0.0 else 3


@sealed
def on_part(contacts: Floats, c: int, scale: float, pull: float) -> tuple[float, float]:
    """Force of a contact on the part, body frame: λ times a scale, and the pull times another."""
    nx, ny = contacts[c, CONTACTS.nx], contacts[c, CONTACTS.ny]
    ln, lt = scale * contacts[c, CONTACTS.ln], scale * contacts[c, CONTACTS.lt]
    draw = pull * contacts[c, CONTACTS.pull]
    return (draw - ln) * nx + lt * ny, (draw - ln) * ny - lt * nx


@sealed
def record_step(
    record: Floats,
    sample: int,
    end: float,
    dt: float,
    unit: float,
    before: Floats,
    pose: Floats,
    body: Floats,
    obstacles: Floats,
    contacts: Floats,
    marks: Ints,
    step: Floats,
    count: int,
) -> int:
    """Write the samples that fall into the last step; return the next one to write.

    Parameters
    ----------
    record
        (R, 5 + 5 P), the times being written.
    sample
        The next row to write.
    end, dt, unit
        End and length of the step in s, and its unit of length in m.
    before, pose
        (3,) poses before and after the step.
    body, obstacles, contacts, marks, step, count
        Tables of the step, the tips having arrived.
    """
    probes = (record.shape[1] - PROBES) // PER_PROBE
    while sample < record.shape[0] and record[sample, TIME] <= end + 1e-9 * dt:
        share = max((end - record[sample, TIME]) / dt, 0.0)  # of the step, still to come
        for k in range(3):
            record[sample, POSE + k] = pose[k] - share * (pose[k] - before[k])
        for p in range(probes):
            for a in range(2):
                there, here = obstacles[p, OBSTACLES.from_x + a], obstacles[p, OBSTACLES.x + a]
                record[sample, PROBES + PER_PROBE * p + a] = here - share * (here - there)
        _record_contacts(record[sample], probes, body, unit / dt, contacts, marks, step, count)
        sample += 1
    return sample


@sealed
def _record_contacts(
    row: Floats,
    probes: int,
    body: Floats,
    speed: float,
    contacts: Floats,
    marks: Ints,
    step: Floats,
    count: int,
) -> None:
    """Write forces, and the mode of the most loaded contact of each probe and of the fixture."""
    cos, sin = body[PART.cos], body[PART.sin]
    scale = step[STEP.factor + 6] * speed
    for p in range(probes + 1):
        most = 0.0
        for c in range(count):
            if min(marks[c, MARKS.who], probes) != p:
                continue
            mode = (
                contact_mode(contacts, marks, step, count, c)
                if contacts[c, CONTACTS.ln] > most
                else -1
            )
            most = max(most, contacts[c, CONTACTS.ln])
            if p == probes:
                row[FIXTURE_MODE] = mode if mode >= 0 else row[FIXTURE_MODE]
                continue
            at = PROBES + PER_PROBE * p
            fx, fy = on_part(contacts, c, scale, 1.0)
            row[at + FORCE] += cos * fx - sin * fy
            row[at + FORCE + 1] += sin * fx + cos * fy
            row[at + PROBE_MODE] = mode if mode >= 0 else row[at + PROBE_MODE]


@sealed
def record_rest(record: Floats, sample: int, pose: Floats, obstacles: Floats) -> None:
    """Write the samples after the end of a run that was stopped: nothing moves or presses."""
    probes = (record.shape[1] - PROBES) // PER_PROBE
    for row in range(sample, record.shape[0]):
        for k in range(3):
            record[row, POSE + k] = pose[k]
        for p in range(probes):
            for a in range(2):
                record[row, PROBES + PER_PROBE * p + a] = obstacles[p, OBSTACLES.x + a]
