"""What a probe's tip does to the part besides pressing on it: friction by edge and time, adhesion, attraction.

Adhesion and attraction pull the part towards the tip with a force that does not depend on the
contact; the contact itself still only presses, ``λ_n ≥ 0``, so that the force between part and tip
is ``λ_n − F`` and its friction ``μ λ_n`` holds while the tip is drawn back.
"""

import numpy as np

from meso_robust.kernels import sealed
from meso_robust.simulator.contact import PER_CORNER
from meso_robust.simulator.stage import FORM, Effect, Parameter, Stage
from meso_robust.simulator.tables import CONTACTS, MARKS, OBSTACLES
from meso_robust.types import Floats, Ints

_UM = 1e-6

CONTACT = Stage(
    name="contact",
    base=56,
    slots=16,
    effects=(
        Effect(
            name="tip_adhesion",
            equation="λ_n ≥ −F from the first touch until the gap exceeds r",
            source="meniscus at the tip, F = 4 π R γ cos φ; R. S. Fearing 1995, "
            "doi:10.1109/IROS.1995.526162",
            forms=("constant until it breaks", "falls linearly to nothing at r"),
            parameters=(
                Parameter(
                    key="pull_um_s", unit="µm/s", to_si=_UM, low=0.0,
                    meaning="F / e_x: speed at which the force drags the part",
                ),
                Parameter(
                    key="range_um", unit="µm", to_si=_UM, default=2.0 * _UM, low=0.0, size=False,
                    meaning="r: gap at which the meniscus breaks",
                ),
            ),
        ),
        Effect(
            name="tip_attraction",
            equation="F(gap) = F₀ r / (r + gap) towards the tip, before and in contact",
            source="sphere and plane at a voltage, F = π ε R V² / gap; Fearing 1995, as above",
            forms=("falls as 1/(1 + gap/r)", "halves every r"),
            parameters=(
                Parameter(
                    key="pull_um_s", unit="µm/s", to_si=_UM, low=0.0,
                    meaning="F₀ / e_x at contact: speed at which the force drags the part",
                ),
                Parameter(
                    key="range_um", unit="µm", to_si=_UM, default=5.0 * _UM, low=1e-3 * _UM, size=False,
                    meaning="r: gap at which the force is half of that at contact",
                ),
            ),
        ),
        Effect(
            name="edge_dependent_friction",
            equation="μ of one edge = μ (1 + c)",
            source="etched and machined edges differ",
            parameters=(
                Parameter(
                    key="change", unit="", to_si=1.0, low=-1.0,
                    meaning="c: relative change of the friction coefficient",
                ),
                Parameter(
                    key="edge", unit="", to_si=1.0, low=0.0, size=False,
                    meaning="the edge that starts at this corner of the outline",
                ),
            ),
        ),
        Effect(
            name="friction_spread",
            equation="μ of one tip = μ (1 + c)",
            source="tips are ground and wear one by one",
            parameters=(
                Parameter(
                    key="change", unit="", to_si=1.0, low=-1.0,
                    meaning="c: relative change of the friction coefficient",
                ),
                Parameter(
                    key="tip", unit="", to_si=1.0, low=0.0, size=False,
                    meaning="the probe, counted from 0 in the order of the recording",
                ),
            ),
        ),
        Effect(
            name="friction_speed",
            equation="μ of every tip = μ (1 + c exp(−v / v₀)), v the speed of its slip",
            source="R. Stribeck 1902; B. Armstrong-Hélouvry et al. 1994, doi:10.1016/0005-1098(94)90209-7",
            forms=("falls exponentially", "falls as 1 / (1 + v / v₀)"),
            parameters=(
                Parameter(
                    key="change", unit="", to_si=1.0, low=-1.0,
                    meaning="c: by what share a tip that sticks has more friction than one that slips fast",
                ),
                Parameter(
                    key="speed_um_s", unit="µm/s", to_si=_UM, default=20.0 * _UM, low=0.01 * _UM, size=False,
                    meaning="v₀: speed of slip over which that is lost",
                ),
            ),
        ),
        Effect(
            name="friction_drift",
            equation="μ of every tip = μ exp(r t)",
            source="a tip that is wetted by the film, or polished, while it slides",
            forms=("steady", "slows down, as exp(r t₀ ln(1 + t/t₀))"),
            parameters=(
                Parameter(
                    key="rate_percent_s", unit="%/s", to_si=0.01, low=-1.0, high=1.0,
                    meaning="r: relative growth of the friction coefficient since the start of a recording",
                ),
                Parameter(
                    key="time_s", unit="s", to_si=1.0, default=1.0, low=1e-2, high=1e3, size=False,
                    meaning="t₀: of a change that slows down, time in which it halves its speed",
                ),
            ),
        ),
    ),
)  # fmt: skip

_ADHESION = CONTACT.slot("tip_adhesion", "pull_um_s")
_ADHESION_RANGE = CONTACT.slot("tip_adhesion", "range_um")
_ADHESION_FORM = CONTACT.slot("tip_adhesion", FORM)
_ATTRACTION = CONTACT.slot("tip_attraction", "pull_um_s")
_ATTRACTION_RANGE = CONTACT.slot("tip_attraction", "range_um")
_ATTRACTION_FORM = CONTACT.slot("tip_attraction", FORM)
_CHANGE = CONTACT.slot("edge_dependent_friction", "change")
EDGE = CONTACT.slot("edge_dependent_friction", "edge")
"""Column of the edge that has a friction of its own."""
SPREAD = CONTACT.slot("friction_spread", "change")
TIP = CONTACT.slot("friction_spread", "tip")
"""Columns of the change of friction of one probe, and of which it is."""
_FADING = CONTACT.slot("friction_drift", "rate_percent_s")
_FADING_TIME = CONTACT.slot("friction_drift", "time_s")
_FADING_FORM = CONTACT.slot("friction_drift", FORM)
SLOWNESS = CONTACT.slot("friction_speed", "change")
"""Column of by how much more friction a tip has that does not slip."""
_SLOW_SPEED = CONTACT.slot("friction_speed", "speed_um_s")
_SLOW_FORM = CONTACT.slot("friction_speed", FORM)
PULL_SLOTS = (_ADHESION, _ATTRACTION)
"""Columns of effects that draw the part to a tip."""
REACH_OF_ATTRACTION = 50.0
"""Attraction ends at this many times its range, where it is below 2 % of that at contact."""

_TOUCHING = 1e-9  # m: a gap this small wets the tip


@sealed
def friction_of_contacts(
    effects: Floats,
    time: float,
    probes: int,
    obstacles: Floats,
    contacts: Floats,
    marks: Ints,
    count: int,
) -> None:
    """Write the friction coefficient of every contact after some s of the run, and no pull.

    A corner of the part belongs to no edge and has the plain coefficient; so have obstacles that are no
    probes at any time. How fast a tip slips is taken from the step before.
    """
    change, edge = effects[_CHANGE], effects[EDGE]
    spread, tip = effects[SPREAD], effects[TIP]
    faded = 1.0
    if effects[_FADING] != 0.0:
        lasted = time
        if effects[_FADING_FORM] != 0.0:
            lasted = effects[_FADING_TIME] * np.log1p(time / effects[_FADING_TIME])
        faded = np.exp(effects[_FADING] * lasted)
    for c in range(count):
        mu = obstacles[marks[c, MARKS.who], OBSTACLES.friction]
        if marks[c, MARKS.who] < probes:
            mu *= faded
            if effects[SLOWNESS] != 0.0:
                slip = obstacles[marks[c, MARKS.who], OBSTACLES.slip] / effects[_SLOW_SPEED]
                left = np.exp(-slip) if effects[_SLOW_FORM] == 0.0 else 1.0 / (1.0 + slip)
                mu *= 1.0 + effects[SLOWNESS] * left
        if spread != 0.0 and marks[c, MARKS.who] == tip:
            mu *= 1.0 + spread
        if (
            change != 0.0
            and marks[c, MARKS.feature] >= 0
            and marks[c, MARKS.feature] % PER_CORNER == edge
        ):
            mu *= 1.0 + change
        contacts[c, CONTACTS.mu] = mu
        contacts[c, CONTACTS.pull] = 0.0


@sealed
def attraction_reach(effects: Floats) -> float:
    """Gap within which a tip may draw the part, m; zero without such an effect."""
    reach = 0.0
    if effects[_ADHESION] != 0.0:
        reach = effects[_ADHESION_RANGE]
    if effects[_ATTRACTION] != 0.0:
        reach = max(reach, REACH_OF_ATTRACTION * effects[_ATTRACTION_RANGE])
    return float(reach)


@sealed
def pull_of_tips(
    effects: Floats, probes: int, obstacles: Floats, contacts: Floats, marks: Ints, count: int
) -> None:
    """Write the pull of every tip at its nearest contact, and keep track of menisci.

    Parameters
    ----------
    effects
        (S,) values of the effects.
    probes
        Number of probes; further obstacles do not pull.
    obstacles, contacts, marks
        Tables of `tables`; the pull of contacts and the menisci of obstacles are written.
    count
        Number of contacts.
    """
    for k in range(probes):
        nearest = -1
        for c in range(count):
            if marks[c, MARKS.who] == k and (
                nearest < 0 or contacts[c, CONTACTS.gap] < contacts[nearest, CONTACTS.gap]
            ):
                nearest = c
        if nearest < 0:
            obstacles[k, OBSTACLES.wet] = 0.0
            continue
        gap = max(contacts[nearest, CONTACTS.gap], 0.0)
        if gap <= _TOUCHING:
            obstacles[k, OBSTACLES.wet] = 1.0
        elif gap > effects[_ADHESION_RANGE]:
            obstacles[k, OBSTACLES.wet] = 0.0
        pull = effects[_ADHESION] * obstacles[k, OBSTACLES.wet]
        if effects[_ADHESION_FORM] != 0.0 and gap > 0.0:
            pull *= max(1.0 - gap / max(effects[_ADHESION_RANGE], gap), 0.0)
        reach = REACH_OF_ATTRACTION * effects[_ATTRACTION_RANGE]
        if effects[_ATTRACTION] != 0.0 and gap <= reach:
            away = gap / effects[_ATTRACTION_RANGE]
            near = 1.0 / (1.0 + away) if effects[_ATTRACTION_FORM] == 0.0 else 0.5**away
            pull += effects[_ATTRACTION] * near
        contacts[nearest, CONTACTS.pull] = pull
