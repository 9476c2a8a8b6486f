"""A laboratory by hand: readings as devices would give them, without any device."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

from meso_robust.live.conductor import Conductor
from meso_robust.live.exchange import Command, Place, Reading, Seen
from meso_robust.live.lab_file import CameraSection, Lab, ManipulatorSection, TipSection
from meso_robust.live.sight import Sight, Trust

TRUST = Trust(position_um=5.0, orientation_deg=0.2)
MOVE: Mapping[str, Any] = {
    "step": 1,
    "primitive": "y_translation",
    "probes": [
        {"name": "dtp_top", "start_um": [1000.0, 290.0], "passive": False},
        {"name": "dtp_bottom", "start_um": [1000.0, -290.0], "passive": False},
    ],
    "travel_um": [-150.0, 0.0],
    "speed_um_s": 75.0,
}
HOLDING: Mapping[str, Any] = {
    **MOVE,
    "probes": [*MOVE["probes"], {"name": "stp", "start_um": [-500.0, 0.0], "passive": True}],
}
DONE: Mapping[str, Any] = {"done": True, "within": {}}


def lab(**changes: Any) -> Lab:
    """A dual-tip and a single-tip manipulator under a camera."""

    def manipulator(name: str, tips: tuple[TipSection, ...]) -> ManipulatorSection:
        return ManipulatorSection(
            name=name,
            tips=tips,
            low_um=(-3000.0, -3000.0),
            high_um=(3000.0, 3000.0),
            lifted_um=300.0,
            max_speed_um_s=1000.0,
            place_speed_um_s=1000.0,
        )

    def tip(name: str, y: float) -> TipSection:
        return TipSection(name=name, offset_um=(0.0, y), direction_deg=0.0, radius_um=12.5)

    pair = (tip("dtp_top", 290.0), tip("dtp_bottom", -290.0))
    made = Lab(
        backend="virtual",
        camera=CameraSection(width_px=640, height_px=480, pixel_size_um=5.0),
        manipulators=(manipulator("dual", pair), manipulator("single", (tip("stp", 0.0),))),
    )
    return made.model_copy(update=changes)


def sight(x: float = 1500.0, y: float = 0.0, theta: float = 90.0, sigma: float = 0.5) -> Sight:
    """A pose that is known well."""
    return Sight(
        pose=(x, y, theta),
        sigma=(sigma, sigma, 0.02),
        covariance=None,
        state="found",
        reason="",
    )


LOST = Sight(
    pose=None, sigma=None, covariance=None, state="lost", reason="no place fits the outline"
)


class Rig:
    """Devices that obey at once, turn by turn, unless they are told otherwise."""

    def __init__(
        self, decide: Callable[[float, float, float], Mapping[str, Any]], **more: Any
    ) -> None:
        self.lab: Lab = more.pop("lab", lab())
        self.conductor = Conductor(self.lab, decide, TRUST, **more)
        self.places = {
            one.name: Place(x_um=0.0, y_um=0.0, height_um=0.0, busy=False)
            for one in self.lab.manipulators
        }
        self.time, self.number = 0.0, 0
        self.said: list[Command] = []
        self.sight: Sight | None = sight()
        self.obey = True

    def turn(self, step: float = 0.1, **changes: Any) -> tuple[Command, ...]:
        """One turn; ``changes``: of the reading."""
        self.time += step
        self.number += 1
        seen = None
        if self.sight is not None:
            seen = Seen(
                number=self.number, time=self.time - 0.01, digest=self.number, sight=self.sight
            )
        reading = Reading(time=self.time, seen=seen, places=dict(self.places))
        commands = self.conductor.step(replace(reading, **changes))
        self.said += commands
        if self.obey:
            self._do(commands)
        return commands

    def _do(self, commands: tuple[Command, ...]) -> None:
        for command in commands:
            place = self.places.get(command.name)
            if command.do == "go" and place is not None:
                place = replace(place, x_um=command.x_um, y_um=command.y_um)
                self.places[command.name] = place
            elif command.do == "lift" and place is not None:
                self.places[command.name] = replace(place, height_um=command.height_um)

    def until(self, phase: str, most: int = 200) -> None:
        """Turns until a phase begins."""
        for _ in range(most):
            if self.conductor.phase == phase:
                return
            self.turn()
        raise AssertionError(f"still {self.conductor.phase}, not {phase}")

    def end(self, most: int = 400) -> Command:
        """Turns until it ends."""
        self.until("ended", most)
        ending = self.conductor.outcome
        assert ending is not None
        return ending

    @property
    def went(self) -> list[Command]:
        """Commands that move something in the plane of the part."""
        return [command for command in self.said if command.do == "go"]

    @property
    def lifted(self) -> bool:
        """Whether all probes are out of the plane."""
        return all(place.height_um == 300.0 for place in self.places.values())
