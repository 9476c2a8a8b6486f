"""The sentences of a certificate, written anew from the task."""

from __future__ import annotations

from meso_robust.task import Part, Task

_ASSUMPTIONS = (
    "quasi-static motion: inertia is neglected",
    "the film's drag is diag(e_x, e_x, e_theta) about the part's centre; only rho = e_theta/e_x enters",
    "Coulomb friction at point contacts; at every instant mu is the same at all tips",
    "the part is the stated {outline}, rigid and exactly known; nothing but the probes touches it",
    "each error keeps within its bound; a probe's position error is constant during a move (and may "
    "differ in the next), and the two tips of the active probe share it",
    "the active probe travels exactly along an axis of the task's frame, as each move states; tips are "
    "points",
    "the part rests between moves, and probes are lifted without disturbing it",
)


def assumptions(task: Task) -> tuple[str, ...]:
    """What the checker assumes as well; a certificate that assumes anything else is rejected."""
    outline = "rectangle"
    if not isinstance(task.part, Part):
        outline = "polygon, its reference point the centre of drag"
    return tuple(one.format(outline=outline) for one in _ASSUMPTIONS)


def claim(task: Task, moves: int) -> str:
    """What is claimed of a policy of ``moves`` moves."""
    u, start, goal = task.uncertainty, task.start, task.goal
    return (
        f"From every start within {u.sensed_position_um} um and {u.sensed_orientation_deg} deg of "
        f"({start.x_um} um, {start.y_um} um, {start.theta_deg} deg), whatever the sensing errors "
        f"(same bounds, before each move), the probe errors (within {u.probe_position_um} um), "
        f"mu in {list(u.friction)}, film ratio within {u.film_ratio_percent} % of "
        f"{u.film_ratio_um2} um^2 and tip misalignment in {list(u.tip_misalignment_deg)} deg, the "
        f"plan's policy of {moves} moves can be carried out, and every motion of the quasi-static "
        f"model ends with the part within {goal.position_tolerance_um} um and "
        f"{goal.orientation_tolerance_deg} deg of ({goal.x_um} um, {goal.y_um} um, "
        f"{goal.theta_deg} deg){_walls(task)}."
    )


def _walls(task: Task) -> str:
    return "" if task.slot is None else " and neither the part nor a tip touches the slot's walls"
