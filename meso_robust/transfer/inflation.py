"""What an effect adds to the errors of a task: bounded over the whole of its interval.

Every bound is one of a distance in the plane, which no coordinate exceeds; it is rounded up to two
decimals. The stages of the camera follow one another (`simulator.observation`), so a bound that grows
with the place holds for all of them together where the pose and all that is added to it stay within
`Budget.radius_um` of the world's origin.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Literal

from meso_robust.simulator.stage import REFERENCE_SPEED
from meso_robust.transfer.uneven_film import MOST, rubbed, thinned
from meso_robust.wording import down_to, up_to

Ends = tuple[float, float]
Ranges = Mapping[str, Ends]
"""Lower and upper end of each parameter of an effect, in the catalogue's units."""

_ROUNDING = 1.0 + 1e-12  # far more than a few operations on doubles lose
_DIGITS = 100  # steps of a unit that bounds are rounded up to
_LEAST_DRAG = 0.05  # over that at the origin: a drag that falls along a line is not taken below it
_NEARLY = 0.99  # of the place where a lens folds the image over: there roundings count for much
_MOST_DRY = 1.0  # dry contact over film: nothing is gained by a closer bound of more
NOTHING: Ends = (0.0, 0.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class Budget:
    """What bounds that grow with place or time are computed for; a plan must keep within it."""

    radius_um: float
    """Largest distance of what is seen of the part from the world's origin."""
    seconds: float
    """Longest time from the zero of a drift to the last pose that is sensed."""
    ratio_um2: float
    """Largest ratio of rotational to translational drag of the film, as it would be if it were even."""
    least_ratio_um2: float
    """The smallest."""
    slender: float
    """Length over width of a rectangle; 0 of another part, or where something besides keeps its film from being even."""
    rectangle: bool
    """Whether the part is one: some bounds are of a film under a rectangle."""
    reach_um: float
    """Largest distance of a contact from the part's centre."""
    speed_um_s: float
    """Commanded of a moving tip."""
    press: float
    """Least speed of such a tip against the edge of a part that it alone turns, over what is commanded."""
    turn_per_um: float
    """Least turn of a part between a moving and a passive tip, rad, per travel as commanded."""
    capped: bool
    """Whether contact forces are capped, by the film's stated drag."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Post:
    """A round post on the stage: where it can be, and its radius, um."""

    x_um: Ends
    y_um: Ends
    radius_um: Ends


@dataclass(frozen=True, slots=True, kw_only=True)
class Absorbed:
    """What an effect comes to at most; zeros add nothing."""

    said: str
    sensed_um: float = 0.0
    """Added to the largest error of a sensed x or y."""
    turned_deg: float = 0.0
    """Added to the largest error of a sensed orientation."""
    probe_um: float = 0.0
    """Added to the largest error of a probe's x or y."""
    length_um: Ends = NOTHING
    """By how much the part is longer than stated."""
    width_um: Ends = NOTHING
    leans_deg: float = 0.0
    """By how much every edge of a rectangle may be turned from its direction; it is no farther out then, and its
    distance from the centre at least the cosine of that."""
    radius_um: Ends = NOTHING
    """By how much every tip's radius is larger than stated."""
    drag_centre_um: float = 0.0
    """Added to the largest distance of the centre of drag from the reference point."""
    centre_moves: bool = False
    """Whether the centre of drag may be anywhere within its distance at every instant."""
    ratio_share: float = 0.0
    """By what share the ratio of drags may differ from that of the even film, at every instant."""
    anisotropy: float = 0.0
    """Drag along the axis of the largest over the mean, less one: added for all axes."""
    more_drag: bool = False
    """Whether the part may drag more, in all, than the film as stated."""
    friction: Ends = (1.0, 1.0)
    """Factors on the friction of a tip, each tip with its own."""
    wander_um: float = 0.0
    """Added to how far a moving probe strays from its path, and does at most in 100 um of travel."""
    drift_um_s: float = 0.0
    """Speed of all probes besides their travel, in any direction; no probe then rests."""
    post: Post | None = None
    """What the part and the tips must stay clear of."""
    bounded_by: Literal["", "place", "time", "speed"] = ""
    """What of the budget the bound rests on."""
    condition: str = ""
    """What the laboratory must keep to for the bound to hold."""


Absorb = Callable[[Ranges, Budget], Absorbed | None]
"""None: of that size nothing bounds it."""
_PARALLELOGRAMS = 2.0  # last form of a part out of square whose opposite edges stay parallel
_STEEPEST = 0.5  # slope of a wave from which on it is taken for a tip that may go back


def _proportions(budget: Budget) -> str:
    """Of the film that a bound is for; the part may be a little off its own."""
    return (
        "the film lies under a rectangle about the part's centre, with the part's proportions as stated, "
        f"{budget.slender:.4g} to 1"
    )


def spelled(value: float) -> Fraction:
    """The decimal number that a double was written as."""
    return Fraction(repr(float(value)))


def rounded_up(value: float | Fraction) -> float:
    """A decimal number of two digits that is not below a bound; a double may have been rounded."""
    bound = value if isinstance(value, Fraction) else Fraction(value * _ROUNDING)
    return math.ceil(bound * _DIGITS) / _DIGITS


def largest(ends: Ends) -> float:
    """Largest absolute value."""
    return max(abs(ends[0]), abs(ends[1]))


def _distance(ranges: Ranges, x: str, y: str) -> float:
    return math.hypot(largest(ranges[x]), largest(ranges[y]))


def drag_scale(_: Ranges, __: Budget) -> Absorbed:
    """A factor on the whole drag, at any time: only ρ enters."""
    return Absorbed(
        said="nothing changes: at every instant the motion depends on ρ and μ only", more_drag=True
    )


def part_geometry(ranges: Ranges, _: Budget) -> Absorbed:
    """Edges that stand out by d: the part is longer by 2 d."""
    x, y = ranges["x_um"], ranges["y_um"]
    return Absorbed(
        said="the part's sides, each with its interval",
        length_um=(2.0 * x[0], 2.0 * x[1]),
        width_um=(2.0 * y[0], 2.0 * y[1]),
    )


def part_skew(ranges: Ranges, _: Budget) -> Absorbed | None:
    """A rectangle of half sides a, b that is sheared by κ has edges that lean by κ at most.

    With x → x + y tan κ, or y → y + x tan κ, those across one axis lean by κ, at a cos κ from the centre, and the
    others are where they were. With both by half, t = tan(κ/2), all lean by κ/2, at a (1 - t²) / √(1 + t²) and b
    likewise: between a cos κ and a. A part that narrows has its centre of drag elsewhere, as no parallelogram has.
    """
    if max(ranges.get("form", NOTHING)) > _PARALLELOGRAMS:
        return None
    lean = largest(ranges["angle_deg"])
    return Absorbed(said=f"every edge turned by ± {up_to(lean, 3)}° more", leans_deg=lean)


def reference_offset(ranges: Ranges, _: Budget) -> Absorbed:
    """The tracked point is off the centre by R(θ) c, whose length is that of c."""
    far = rounded_up(_distance(ranges, "x_um", "y_um"))
    return Absorbed(said=f"sensed position ± {far:g} µm more: |R(θ) c| = |c|", sensed_um=far)


def backlash(ranges: Ranges, _: Budget) -> Absorbed:
    """A probe within b/2 of its command; while it pushes it lags by b/2 throughout.

    The lost motion is taken up at the start of a move, where the tip is free of contact for every
    error in the bound. What the part meets is the way of a tip whose error is constant; that it
    comes later does not matter, because the path does not depend on the speed.
    """
    far = rounded_up(spelled(largest(ranges["width_um"])) / 2)
    return Absorbed(said=f"probe position ± {far:g} µm more: half the lost motion", probe_um=far)


def unmodelled_wall(ranges: Ranges, _: Budget) -> Absorbed:
    """A post that part and tips stay clear of is of no effect."""
    return Absorbed(
        said="of no effect if part and tips are proved to stay clear of it",
        post=Post(x_um=ranges["x_um"], y_um=ranges["y_um"], radius_um=ranges["radius_um"]),
    )


def tip_radius(ranges: Ranges, _: Budget) -> Absorbed:
    """Every tip is larger than stated by the same, or one of them: nobody says which tip of a plan that is."""
    low, high = ranges["excess_um"]
    if ranges.get("form", NOTHING) != NOTHING:
        low, high = min(low, 0.0), max(high, 0.0)
    return Absorbed(said=f"tips larger by {low:g} … {high:g} µm than stated", radius_um=(low, high))


def drag_centre_offset(ranges: Ranges, _: Budget) -> Absorbed:
    """The centre of drag is a point of the part, so far from the reference point."""
    far = rounded_up(_distance(ranges, "x_um", "y_um"))
    return Absorbed(said=f"drag centre within {far:g} µm", drag_centre_um=far)


def drag_gradient(ranges: Ranges, budget: Budget) -> Absorbed:
    """The drag of a place over that at the part's centre is e^(g·x) or 1 + g·x, x from there.

    derivations/uneven_film.py: with |g·x| ≤ Z < 1 under the part and C = cosh Z the centre is within |g| λ C
    of that of the even film, and the ratio between ρ/C - |c|² and ρ C. A film with the ratio ρ under a
    rectangle reaches √(3 ρ) and has λ ≤ ρ. Where the drag grows along a line, g is its slope over its value
    at the part's centre, which is within the budget's radius. Whatever the drag, its centre and all of it
    lie among the places that drag.
    """
    slope = 1e-3 * _distance(ranges, "x_per_mm", "y_per_mm")
    reach = math.sqrt(3.0 * budget.ratio_um2)
    if ranges.get("form", NOTHING) != NOTHING:
        left = 1.0 - slope * (budget.radius_um + reach)
        slope = slope / (1.0 - slope * budget.radius_um) if left > _LEAST_DRAG else math.inf
    steep = slope * reach * _ROUNDING
    if steep < 1.0:
        most = math.cosh(steep) * _ROUNDING
        far, share = (
            slope * budget.ratio_um2 * most,
            most - 1.0 + slope**2 * budget.ratio_um2 * most**2,
        )
    else:
        far, share = reach, 2.0
    return Absorbed(
        said=f"drag centre anywhere within {rounded_up(far):g} µm at every instant, and ρ ± "
        f"{up_to(100 * share, 3)} % more",
        drag_centre_um=rounded_up(far),
        centre_moves=True,
        ratio_share=share,
        more_drag=True,
        bounded_by="place",
    )


def shear_thinning(ranges: Ranges, budget: Budget) -> Absorbed:
    """The drag of a place is a power of its speed: centre and ratio depend on where the part turns about.

    derivations/uneven_film.py. The film is that of a part of its shape, enlarged until it has its ratio.
    """
    drop = ranges["exponent_drop"]
    far, share = math.sqrt(3.0), 2.0
    if largest(drop) <= MOST:
        far, share = thinned(drop, budget.slender)
    far = rounded_up(far * math.sqrt(budget.ratio_um2))
    return Absorbed(
        said=f"drag centre anywhere within {far:g} µm at every instant, and ρ ± "
        f"{up_to(100 * share, 3)} % more, whatever the speed",
        drag_centre_um=far,
        centre_moves=True,
        ratio_share=share,
        more_drag=True,
        condition=_proportions(budget),
    )


def dry_friction(ranges: Ranges, budget: Budget) -> Absorbed:
    """Every place drags by a force that does not grow with its speed, besides the film."""
    return _dry(largest(ranges["ratio"]), budget)


def uneven_support(ranges: Ranges, budget: Budget) -> Absorbed:
    """The same, of a pressure 1 + q·x on a rectangle: no place has more than 1 + 3 |x| / a + 3 |y| / b.

    Its half sides a, b are those of a film under a rectangle with the least ratio.
    """
    ratio, (x, y) = largest(ranges["ratio"]), (largest(ranges[key]) for key in ("x_um", "y_um"))
    half = math.sqrt(3.0 * budget.least_ratio_um2 / (1.0 + budget.slender**2))
    return _dry(ratio * (1.0 + 3.0 * (x / (half * budget.slender) + y / half)), budget)


def _dry(ratio: float, budget: Budget) -> Absorbed:
    """Dry contact of any size up to a ratio at each place and instant.

    derivations/uneven_film.py: a place of the speed u drags by up to T / |u| beyond the film. A part that a
    tip alone turns about p is passed by it with at least its speed against the edge, which is within
    |p| and the farthest contact of p; one between two tips turns with at least its least turn.
    """
    strength, root = ratio * 1e6 * REFERENCE_SPEED * _ROUNDING, math.sqrt(budget.least_ratio_um2)
    alone = strength / (budget.speed_um_s * budget.press) if budget.press else math.inf
    held = strength / (budget.speed_um_s * budget.turn_per_um) if budget.turn_per_um else math.inf
    # beyond the ratio of an even film, of what is no farther out than its area
    far, share = math.sqrt(3.0), 2.0
    if max(alone, held / root) < _MOST_DRY:
        found = (
            rubbed(alone * budget.reach_um / root, alone, budget.slender),
            rubbed(held / root, 0.0, budget.slender),
        )
        far, share = (max(one[k] for one in found) for k in (0, 1))
    far = rounded_up(far * math.sqrt(budget.ratio_um2))
    return Absorbed(
        said=f"drag centre anywhere within {far:g} µm at every instant, and ρ ± {up_to(100 * share, 3)} % more, "
        f"at {budget.speed_um_s:g} µm/s",
        drag_centre_um=far,
        centre_moves=True,
        ratio_share=share,
        more_drag=True,
        bounded_by="speed",
        condition=f"a tip is moved at {budget.speed_um_s:g} µm/s or more from its first touch to its stop; and "
        f"{_proportions(budget)}",
    )


def drag_anisotropy(ranges: Ranges, _: Budget) -> Absorbed:
    """The drag along two axes is 1 + a and 1 - a of their mean: they differ by 2 a.

    Where every place of the area drags so, that of a turn is within (1 +- a) of the even film's.
    """
    most = largest(ranges["fraction"])
    return Absorbed(
        said=f"drag along two axes different by {up_to(200 * most, 3)} %, and ρ ± {up_to(100 * most, 3)} % more",
        anisotropy=most,
        ratio_share=most,
        more_drag=True,
    )


def own_friction(ranges: Ranges, _: Budget) -> Absorbed:
    """One edge has its own friction, or one tip, or a tip that slips: a tip has what its touch has at the instant."""
    low, high = ranges["change"]
    factors = min(1.0, 1.0 + low), max(1.0, 1.0 + high)
    return Absorbed(
        said=f"each tip its own µ, × {down_to(factors[0], 4)} … {up_to(factors[1], 4)}",
        friction=factors,
    )


def probe_drift(ranges: Ranges, budget: Budget) -> Absorbed:
    """A steady drift bends and stretches a straight travel to another straight travel.

    What drifted before the travel is an error of the probe's position.
    """
    speed = _distance(ranges, "x_um_s", "y_um_s")
    far = rounded_up(speed * budget.seconds)
    return Absorbed(
        said=f"probe position ± {far:g} µm more: |d| t; and travels turned and stretched by |d| / v",
        probe_um=far,
        drift_um_s=speed,
        bounded_by="time",
        condition=f"the last move ends within {budget.seconds:g} s of the probes' calibration",
    )


def leadscrew_error(ranges: Ranges, _: Budget) -> Absorbed | None:
    """A probe is off its straight path by √(s² + c²) of each axis, with a slope of 2π √(s² + c²) / p at most.

    As a share of the way that the tip has really gone the slope is larger by what it may fall short of the command.
    One that rests is off by as much. Where the slope may reach 1 the tip may go back, and no path is bounded.
    """
    far = max(_waves(ranges))
    shortest = min(ranges["period_um"])
    slope = 2.0 * math.pi * far / shortest if shortest > 0.0 else math.inf
    if slope >= _STEEPEST:
        return None
    off, stray = rounded_up(far), rounded_up(max(far, 100.0 * slope / (1.0 - slope)))
    return Absorbed(
        said=f"probe position ± {off:g} µm more, and a path that strays by {off:g} µm, by {stray:g} µm in 100 µm "
        "of travel at its steepest",
        probe_um=off,
        wander_um=stray,
        condition="both tips of a probe are carried by one mount, and the screws of all are within these",
    )


def camera_latency(ranges: Ranges, _: Budget) -> Absorbed:
    """A pose that has been at rest for the latency is seen as it is."""
    wait = math.ceil(largest(ranges["time_ms"]) * _ROUNDING)
    return Absorbed(
        said="nothing changes: poses are sensed at rest",
        condition=f"the part has been at rest for {wait} ms before its pose is sensed, and still is "
        f"{wait} ms later",
    )


def clock_rate(ranges: Ranges, budget: Budget) -> Absorbed:
    """|r| t: a pose that has been at rest for as long is seen as it is."""
    wait = math.ceil(0.01 * largest(ranges["percent"]) * budget.seconds * _ROUNDING)
    return Absorbed(
        said="nothing changes: poses are sensed at rest",
        bounded_by="time",
        condition=f"the last move ends within {budget.seconds:g} s of when the clocks were set alike, and the part has "
        f"been at rest for {wait} s before its pose is sensed, and still is {wait} s later",
    )


def camera_rotation(ranges: Ranges, budget: Budget) -> Absorbed:
    """|R(φ) (x - m) + m - x| ≤ |φ| (|x| + |m|), and every orientation is off by φ."""
    angle = largest(ranges["angle_deg"])
    reach = budget.radius_um + _from_origin(ranges)
    far, turn = rounded_up(math.radians(angle) * reach), rounded_up(angle)
    return Absorbed(
        said=f"sensed position ± {far:g} µm and orientation ± {turn:g}° more: |φ| (|x| + |m|) and |φ|, "
        f"{_place(budget)}",
        sensed_um=far,
        turned_deg=turn,
        bounded_by="place",
    )


def camera_scale(ranges: Ranges, budget: Budget) -> Absorbed:
    """|s| (|x| + |m|)."""
    reach = budget.radius_um + _from_origin(ranges)
    far = rounded_up(0.01 * largest(ranges["percent"]) * reach)
    return Absorbed(
        said=f"sensed position ± {far:g} µm more: |s| (|x| + |m|), {_place(budget)}",
        sensed_um=far,
        bounded_by="place",
    )


def lens_distortion(ranges: Ranges, budget: Budget) -> Absorbed:
    """|k1| r³, and |q| arcsin(b / (1 - 2 b)) of the orientation, b = |k1| r², r = |x| + |m|.

    A symmetric matrix turns a vector by at most the arcsine of the difference of its eigenvalues over
    their sum; those of the lens are 1 + k1 |x - m|² and 1 + 3 k1 |x - m|². Where the latter vanishes, the
    lens folds the image over, and no orientation is bounded.
    """
    reach = budget.radius_um + _from_origin(ranges)
    bulge = largest(ranges["k1_per_mm2"]) * (1e-3 * reach) ** 2
    share = largest(ranges.get("turned", NOTHING))
    folds = 3.0 * bulge >= _NEARLY
    turn = 180.0 if folds else math.degrees(share * math.asin(bulge / (1.0 - 2.0 * bulge)))
    far, turned = rounded_up(bulge * reach), rounded_up(turn) if share else 0.0
    return Absorbed(
        said=f"sensed position ± {far:g} µm and orientation ± {turned:g}° more: |k1| r³ and "
        f"|q| arcsin(b / (1 - 2 b)), b = |k1| r², r = |x| + |m|, {_place(budget)}",
        sensed_um=far,
        turned_deg=turned,
        bounded_by="place",
    )


def camera_anisotropy(ranges: Ranges, budget: Budget) -> Absorbed:
    """λ |x|, and |q| arcsin(√((a - b)² + 4 k²) / (2 + a + b)) of the orientation.

    A symmetric matrix turns a vector by at most the arcsine of the difference of its eigenvalues over
    their sum; λ is the largest eigenvalue where all entries have their largest size.
    """
    x, y, shear = (
        0.01 * largest(ranges.get(key, NOTHING))
        for key in ("x_percent", "y_percent", "shear_percent")
    )
    share = largest(ranges.get("turned", NOTHING))
    far = rounded_up((0.5 * (x + y) + math.hypot(0.5 * (x - y), shear)) * budget.radius_um)
    most = min(math.hypot(x + y, 2.0 * shear) / (2.0 - x - y), 1.0)
    turned = rounded_up(share * math.degrees(math.asin(most))) if share else 0.0
    return Absorbed(
        said=f"sensed position ± {far:g} µm and orientation ± {turned:g}° more: "
        f"λ |x|, λ the largest eigenvalue of the stretch, {_place(budget)}",
        sensed_um=far,
        turned_deg=turned,
        bounded_by="place",
    )


def registration_shift(ranges: Ranges, _: Budget) -> Absorbed:
    """|c|."""
    far = rounded_up(_distance(ranges, "x_um", "y_um"))
    return Absorbed(said=f"sensed position ± {far:g} µm more: |c|", sensed_um=far)


def angle_error(ranges: Ranges, _: Budget) -> Absorbed:
    """√(s² + c²), whatever k is."""
    turned = rounded_up(_distance(ranges, "sine_deg", "cosine_deg"))
    return Absorbed(said=f"sensed orientation ± {turned:g}° more: √(s² + c²)", turned_deg=turned)


def pixel_locking(ranges: Ranges, _: Budget) -> Absorbed:
    """√(s² + c²) of each coordinate, together."""
    far = rounded_up(math.hypot(*_waves(ranges)))
    return Absorbed(said=f"sensed position ± {far:g} µm more: √(s² + c²)", sensed_um=far)


def part_yaw(ranges: Ranges, _: Budget) -> Absorbed:
    """|ψ|."""
    turned = rounded_up(largest(ranges["angle_deg"]))
    return Absorbed(said=f"sensed orientation ± {turned:g}° more: |ψ|", turned_deg=turned)


def camera_drift(ranges: Ranges, budget: Budget) -> Absorbed:
    """|d| t."""
    far = rounded_up(_distance(ranges, "x_um_s", "y_um_s") * budget.seconds)
    return Absorbed(
        said=f"sensed position ± {far:g} µm more: |d| t",
        sensed_um=far,
        bounded_by="time",
        condition=f"the last pose is sensed within {budget.seconds:g} s of the camera's calibration",
    )


def _waves(ranges: Ranges) -> tuple[float, float]:
    """Largest displacements along x and along y by a wave on each axis; um."""
    x, y = (_distance(ranges, f"{axis}_sine_um", f"{axis}_cosine_um") for axis in "xy")
    return x * _ROUNDING, y * _ROUNDING


def _from_origin(ranges: Ranges) -> float:
    """Largest distance of the place m that an error of the image leaves where it is; um."""
    x, y = (largest(ranges.get(f"about_{axis}_um", NOTHING)) for axis in "xy")
    return math.hypot(x, y) * _ROUNDING


def _place(budget: Budget) -> str:
    return f"|x| ≤ {budget.radius_um:g} µm"
