"""One line an effect: the premise of the certificate that it bears on, and what becomes of it.

An effect without a line breaks a premise that nobody has named: nothing is proved then.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum

from meso_robust.certificates.premise import Premise
from meso_robust.transfer import inflation
from meso_robust.transfer.inflation import Absorb


class Ground(StrEnum):
    """What a promise rests on that is no premise of a certificate."""

    ONE_MODEL = "one_model"
    A_LINE = "a_line"


GROUND_WORDS: Mapping[Ground, str] = {
    Ground.ONE_MODEL: "the recordings support one model",
    Ground.A_LINE: "no premise is known to survive",
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Line:
    """An effect, or a base model, and the certificate."""

    premise: Premise
    """Which of the certificate's premises it bears on."""
    claim: str
    """What rests on that premise: a key of the register of claims."""
    derivation: str
    """Where that is derived."""
    why: str
    """What breaks, or why nothing does."""
    absorb: Absorb | None = None
    """How it is absorbed in the task; None: it is not, and nothing is proved."""
    any_form: bool = False
    """Whether it is of every form of the effect's law, not of the first one only."""
    even: bool = False
    """Whether the bound is of a film that nothing else keeps from being even."""
    rectangle: bool = False
    """Whether it is of a rectangle, or of a film under one."""
    placed: tuple[str, ...] = ()
    """Parameters that say where it is, without which its size is worth nothing."""


def _one_point(claim: str, premise: Premise, why: str) -> Line:
    file = "derivations/one_point_sticking.py"
    return Line(premise=premise, claim=claim, derivation=file, why=why)


def _tensor(why: str, absorb: Absorb) -> Line:
    file = "derivations/drag_tensor.py"
    premise = Premise.FILM_DRAG
    return Line(
        premise=premise, claim="drag-tensor-sticking", derivation=file, why=why, absorb=absorb
    )


def _uneven(claim: str, why: str, absorb: Absorb, placed: tuple[str, ...] = ()) -> Line:
    """Of a film that nothing else keeps from being even."""
    return Line(
        premise=Premise.FILM_DRAG,
        claim=claim,
        derivation="derivations/uneven_film.py",
        why=why,
        absorb=absorb,
        even=True,
        rectangle=True,
        placed=placed,
    )


def _invariance(claim: str, premise: Premise, why: str, absorb: Absorb | None = None) -> Line:
    file = "derivations/invariances.py"
    return Line(premise=premise, claim=claim, derivation=file, why=why, absorb=absorb)


def _sensing(
    why: str, absorb: Absorb, *, any_form: bool = False, placed: tuple[str, ...] = ()
) -> Line:
    return Line(
        premise=Premise.ERRORS_BOUNDED,
        claim="step-1-conditions",
        derivation="derivations/y_translation.py",
        why=why,
        absorb=absorb,
        any_form=any_form,
        placed=placed,
    )


LINES: Mapping[str, Line] = {
    "dry_friction": _uneven(
        "uneven-film-dry",
        "a dry force does not grow with the velocity: slower places drag more for their speed",
        inflation.dry_friction,
    ),
    "stribeck_friction": _uneven(
        "uneven-film-dry",
        "a dry force that falls with the speed: slower places drag more",
        inflation.dry_friction,
    ),
    "shear_thinning": _uneven(
        "uneven-film-thinning",
        "slower places drag more for their speed: the centre moves towards where the part turns about",
        inflation.shear_thinning,
    ),
    "anisotropic_drag": _tensor(
        "the drag has a preferred direction on the stage", inflation.drag_anisotropy
    ),
    "part_anisotropic_drag": _tensor(
        "the drag along and across the part differ: e_x ≠ e_y", inflation.drag_anisotropy
    ),
    "drag_centre_offset": _tensor(
        "the drag is centred beside the part's centre: pushing there turns it",
        inflation.drag_centre_offset,
    ),
    "drag_gradient": Line(
        premise=Premise.FILM_DRAG,
        claim="uneven-film-gradient",
        derivation="derivations/uneven_film.py",
        why="the drag depends on the place: its centre moves over the part as the part turns",
        absorb=inflation.drag_gradient,
        rectangle=True,
    ),
    "drag_drift": _invariance(
        "film-scale",
        Premise.FILM_DRAG,
        "the drag grows as a whole: only ρ enters",
        inflation.drag_scale,
    ),
    "breakaway_friction": _invariance(
        "rate-film",
        Premise.FILM_DRAG,
        "a dry force that ages at rest: the path depends on times and speeds",
    ),
    "uneven_support": _uneven(
        "uneven-film-dry",
        "a dry force centred beside the part's centre",
        inflation.uneven_support,
        ("x_um", "y_um"),
    ),
    "sticky_spot": _one_point(
        "eq-5-ratio",
        Premise.FILM_DRAG,
        "a place of the stage holds what lies over it: the centre of drag moves as the part passes",
    ),
    "body_force": _one_point(
        "eq-5-normal-force",
        Premise.PART_RESTS,
        "an untouched part moves, and the force enters the balance of eq. (5)",
    ),
    "film_flow": _one_point(
        "eq-5-normal-force",
        Premise.PART_RESTS,
        "an untouched part moves with the film, and the flow enters the balance of eq. (5)",
    ),
    "wall_capillarity": _one_point(
        "eq-5-normal-force",
        Premise.PART_RESTS,
        "a wall draws the part without touching it, untouched or pushed",
    ),
    "point_pull": _one_point(
        "eq-5-normal-force",
        Premise.PART_RESTS,
        "a place of the stage draws the part, untouched or pushed",
    ),
    "unmodelled_wall": Line(
        premise=Premise.PART_KNOWN,
        claim="uniqueness-one-contact",
        derivation="derivations/one_point_sticking.py",
        why="a contact with something that is not in the task",
        absorb=inflation.unmodelled_wall,
    ),
    "tip_adhesion": _one_point(
        "eq-5-normal-force",
        Premise.COULOMB_FRICTION,
        "a meniscus pulls: contacts no longer only press (λ_n ≥ 0), and a tip that leaves drags "
        "the part along",
    ),
    "tip_attraction": _one_point(
        "eq-5-normal-force",
        Premise.PART_RESTS,
        "a tip draws the part before it touches and while it leaves: the part does not rest",
    ),
    "edge_dependent_friction": Line(
        premise=Premise.COULOMB_FRICTION,
        claim="no-jam",
        derivation="derivations/rotation_existence.py",
        why="the two tips of a rotation press on different edges: their μ differ",
        absorb=inflation.own_friction,
    ),
    "friction_spread": Line(
        premise=Premise.COULOMB_FRICTION,
        claim="no-jam",
        derivation="derivations/rotation_existence.py",
        why="the μ of the tips differ",
        absorb=inflation.own_friction,
    ),
    "friction_speed": Line(
        premise=Premise.COULOMB_FRICTION,
        claim="no-jam",
        derivation="derivations/rotation_existence.py",
        why="a tip that slips has another μ than one that sticks",
        absorb=inflation.own_friction,
        any_form=True,
    ),
    "friction_drift": _one_point(
        "eq-5-ratio",
        Premise.COULOMB_FRICTION,
        "the μ of the tips goes on changing: no range is known to hold it",
    ),
    "inertia": Line(
        premise=Premise.QUASI_STATIC,
        claim="inertia",
        derivation="derivations/printed_numbers.py",
        why="a part that goes on by itself when the tip stops has no place that follows from the push",
    ),
    "part_geometry": Line(
        premise=Premise.PART_KNOWN,
        claim="rectangle-edges",
        derivation="derivations/polygon_edge.py",
        why="the same part with edges elsewhere: a rectangle stays one",
        absorb=inflation.part_geometry,
    ),
    "part_skew": Line(
        premise=Premise.PART_KNOWN,
        claim="rectangle-edges",
        derivation="derivations/polygon_edge.py",
        why="a part out of square: its edges are turned",
        absorb=inflation.part_skew,
        any_form=True,
        rectangle=True,
    ),
    "tip_radius": Line(
        premise=Premise.POINT_TIPS,
        claim="round-tip-sticking",
        derivation="derivations/round_tips.py",
        why="a round tip rolls on the edge while the part turns: the contact does not stay at d2",
        absorb=inflation.tip_radius,
        any_form=True,
    ),
    "reference_offset": _sensing(
        "the tracker follows another point of the part", inflation.reference_offset
    ),
    "part_yaw": _sensing("the tracked axes are not the outline's", inflation.part_yaw),
    "probe_compliance": Line(
        premise=Premise.PROBES_RIGID,
        claim="closed-form-motion",
        derivation="derivations/sticking_motion.py",
        why="a tip that bends under the force leaves its line, and creeps after the stop",
    ),
    "backlash": _invariance(
        "rate-film",
        Premise.ERRORS_BOUNDED,
        "a tip lags by half the lost motion while it pushes, and may start anywhere in it",
        inflation.backlash,
    ),
    "tip_latency": Line(
        premise=Premise.TRAVEL_STRAIGHT,
        claim="closed-form-motion",
        derivation="derivations/sticking_motion.py",
        why="a tip that comes later than the other one leaves it alone with the part: the pair does not travel as commanded",
    ),
    "probe_creep": Line(
        premise=Premise.TRAVEL_STRAIGHT,
        claim="closed-form-motion",
        derivation="derivations/sticking_motion.py",
        why="a tip still comes from where it was before: it starts beside its line, and goes on after the stop",
    ),
    "leadscrew_error": Line(
        premise=Premise.TRAVEL_STRAIGHT,
        claim="closed-form-motion",
        derivation="derivations/sticking_motion.py",
        why="a probe's error goes back and forth during a move: it does not travel along a line as commanded",
        absorb=inflation.leadscrew_error,
        placed=("period_um",),
    ),
    "probe_drift": Line(
        premise=Premise.TRAVEL_STRAIGHT,
        claim="closed-form-motion",
        derivation="derivations/sticking_motion.py",
        why="a probe's error grows during a move: its line is not along the axis, and a passive "
        "tip does not rest",
        absorb=inflation.probe_drift,
    ),
    "camera_latency": _sensing("old poses are seen", inflation.camera_latency),
    "log_latency": _sensing("poses are seen before the probe's", inflation.camera_latency),
    "clock_rate": _sensing("poses are seen too early or too late", inflation.clock_rate),
    "camera_scale": _sensing("lengths are seen too long", inflation.camera_scale),
    "camera_rotation": _sensing("the image is turned", inflation.camera_rotation),
    "camera_drift": _sensing("everything is seen to move", inflation.camera_drift),
    "lens_distortion": _sensing("places far out are seen displaced", inflation.lens_distortion),
    "camera_anisotropy": _sensing(
        "lengths along one axis are seen too long", inflation.camera_anisotropy
    ),
    "angle_error": _sensing(
        "the angle is off by how the part is turned", inflation.angle_error, any_form=True
    ),
    "pixel_locking": _sensing(
        "places are drawn to the middle of pixels",
        inflation.pixel_locking,
        placed=("pitch_um",),
    ),
    "registration_shift": _sensing(
        "the camera's frame stands off the probes'", inflation.registration_shift
    ),
}
"""Every effect of the simulator's catalogue."""

BASE = "viscous"
"""The model of motion that certificates are about."""

_NO_FILM = _one_point(
    "eq-5-ratio", Premise.FILM_DRAG, "the part slides on dry contact, not on a film"
)

BASES: Mapping[str, Line] = {
    "three_point": _NO_FILM,
    "uniform_pressure": _NO_FILM,
    "limit_surface": _NO_FILM,
}
"""Other models that can be fitted: none of them keeps the premise on the film."""
