"""The loop itself, without devices: readings in, commands out, the same ones for the same readings.

Lift all probes; see the part at rest; ask the controller; place the probes, lifted; see that the part is
where it was; lower them; see that again; push; lift; see again. A move may ask for rests, in which the camera
runs on before the push and after it, and for drawing the tips back before they are lifted. Whatever is amiss ends it: everything halts and is lifted,
and no further move is made. A pose goes to the controller only if the move before was carried out to its
end, as the controller takes it for the pose after that move.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Any

from meso_robust.live.exchange import HALT, Command, Outcome, Place, Reading, Seen
from meso_robust.live.lab_file import Lab, ManipulatorSection
from meso_robust.live.placing import (
    PlacingError,
    carriers,
    check_within,
    distance_from_line,
    target,
)
from meso_robust.live.sight import SIGMAS, Trust, spread_of

Pose = tuple[float, float, float]
Decide = Callable[[float, float, float], Mapping[str, Any]]
"""Sensed x_um, y_um, theta_deg to a move, ``done``, ``refused`` or ``error``: what `drive` answers."""

GRACE = 0.5
"""s in which a device that was told to move may still say that it rests."""
LATE = 1.5
"""Of the time that a motion should take, after which, and `SLACK`, it counts as stuck."""
SLACK = 2.0  # s
AGAIN = 1.0
"""s after which a probe that is still down and rests is told to lift once more, as long as it ends."""
NO_FRAME = "no frame arrived"
AHEAD = 1e-3
"""s by which a frame may be ahead of the clock that is read after it."""


class Phase(StrEnum):
    """What is being done."""

    LIFTING = "lifting"
    SEEING = "seeing"
    ASKING = "asking"
    PLACING = "placing"
    HOVERING = "hovering"
    LOWERING = "lowering"
    CHECKING = "checking"
    PUSHING = "pushing"
    RESTING = "resting"
    WITHDRAWING = "withdrawing"
    RAISING = "raising"
    ENDING = "ending"
    ENDED = "ended"


MOVING = {
    Phase.PLACING,
    Phase.HOVERING,
    Phase.LOWERING,
    Phase.CHECKING,
    Phase.PUSHING,
    Phase.RESTING,
    Phase.WITHDRAWING,
    Phase.RAISING,
}
"""While a frame must never be too old."""
CLEAR = {Phase.SEEING, Phase.ASKING, Phase.PLACING, Phase.HOVERING}
"""While every probe must be lifted."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Leg:
    """What one manipulator does in a move; um, its own axes."""

    of: ManipulatorSection
    start: tuple[float, float]
    end: tuple[float, float]
    """The same as the start of one that holds still."""
    back: tuple[float, float]
    """To where it is drawn back after the push; the same as the end if it is not."""
    speed: float

    @property
    def moves(self) -> bool:
        """Whether it travels."""
        return self.end != self.start


class Conductor:
    """One run of the loop.

    Parameters
    ----------
    lab
        The laboratory: limits, watchdog, manipulators.
    decide
        Answers sensed poses.
    trust
        How accurate a pose must be.
    confirm
        Whether each move waits for a yes.
    dry
        Whether nothing is commanded: it ends with what the first move would be.
    """

    def __init__(
        self, lab: Lab, decide: Decide, trust: Trust, *, confirm: bool = False, dry: bool = False
    ) -> None:
        self._lab, self._decide, self._trust = lab, decide, trust
        self._confirm = confirm
        self.dry = dry
        """Whether nothing is commanded."""
        self._all = {one.name: one for one in lab.manipulators}
        self.phase = Phase.SEEING if dry else Phase.LIFTING
        self._since: float | None = None
        self._fresh: float | None = None
        self._frame: tuple[int, float, int] | None = None
        self._stage: tuple[float, float] | None = None
        self._rest: list[Seen] = []
        self._why_not_seen = NO_FRAME
        self._legs: tuple[Leg, ...] = ()
        self._deadline, self._rest_s = 0.0, 0.0
        self._end = Command(do="end")
        self._failed, self._lifted_at = False, 0.0
        self.move: Mapping[str, Any] | None = None
        """The move that was decided last."""
        self.sensed: Pose | None = None
        """The pose that it was decided from."""
        self.made = 0
        """Moves that were carried out to their end."""

    @property
    def outcome(self) -> Command | None:
        """How it ended; None while it runs."""
        return self._end if self.phase is Phase.ENDED else None

    @property
    def lowered(self) -> tuple[str, ...]:
        """Manipulators whose tips are to be taken as in the plane."""
        down = MOVING - {Phase.PLACING, Phase.HOVERING}
        return tuple(leg.of.name for leg in self._legs) if self.phase in down else ()

    def step(self, reading: Reading) -> tuple[Command, ...]:
        """What to do after a reading."""
        if self.phase is Phase.ENDED:
            return ()
        if self._since is None:
            self._since, self._stage = reading.time, reading.stage_um
            if reading.word == "stop":
                return self._give_up(reading, "stopped", "stopped by the user")
            if not self.dry:
                # whatever was going on before, a killed run's push included, ends here
                return (HALT, *self._lift_all())
        fault = self._amiss(reading)
        if self.phase is not Phase.ENDING:
            if reading.word == "stop":
                return self._give_up(reading, "stopped", "stopped by the user")
            if fault:
                return self._give_up(reading, "fault", fault)
        act: dict[Phase, Callable[[Reading], tuple[Command, ...]]] = {
            Phase.LIFTING: self._lifting,
            Phase.SEEING: self._seeing,
            Phase.ASKING: self._asking,
            Phase.PLACING: self._placing,
            Phase.HOVERING: self._hovering,
            Phase.LOWERING: self._lowering,
            Phase.CHECKING: self._checking,
            Phase.PUSHING: self._pushing,
            Phase.RESTING: self._resting,
            Phase.WITHDRAWING: self._withdrawing,
            Phase.RAISING: self._raising,
            Phase.ENDING: self._ending,
        }
        return act[self.phase](reading)

    # what is watched

    def _amiss(self, reading: Reading) -> str:
        """What forbids to go on, or nothing."""
        if reading.fault:
            return reading.fault
        for name in self._all:
            place = reading.places.get(name)
            if place is None or not all(
                map(math.isfinite, (place.x_um, place.y_um, place.height_um))
            ):
                return f"{name} does not say where it is"
        return (
            self._stage_fault(reading) or self._frame_fault(reading) or self._height_fault(reading)
        )

    def _stage_fault(self, reading: Reading) -> str:
        if reading.stage_um is None:
            return "" if self._stage is None else "the stage does not say where it is"
        off = math.inf if self._stage is None else math.dist(self._stage, reading.stage_um)
        if not off <= self._lab.watch.stage_error_um:  # so that NaN is a fault too
            return f"the stage has moved by {off:.1f} um"
        return ""

    def _frame_fault(self, reading: Reading) -> str:
        watch, seen = self._lab.watch, reading.seen
        if seen is not None:
            now = (seen.number, seen.time, seen.digest)
            if not seen.time <= reading.time + AHEAD:
                return f"frame {seen.number} is from the future; set the camera's clock"
            if self._frame is not None and not seen.time > self._frame[1]:
                return f"frame {seen.number} is not newer than the one before"
            # the noise of a camera that works changes every image
            if self._frame is None or self._frame[2] != seen.digest:
                self._fresh = seen.time
            self._frame = now
        if self.phase not in MOVING:
            return ""
        age = math.inf if self._fresh is None else 1e3 * (reading.time - self._fresh)
        if not age <= watch.max_age_ms:
            return f"the newest frame is {age:.0f} ms old; at most {watch.max_age_ms:g} ms"
        late = 1e3 * reading.latency_s
        if not late <= watch.max_latency_ms:
            return (
                f"{late:.0f} ms from a frame to its commands; at most {watch.max_latency_ms:g} ms"
            )
        return ""

    def _height_fault(self, reading: Reading) -> str:
        engaged = () if self.phase in CLEAR else {leg.of.name for leg in self._legs}
        if self.phase is Phase.LIFTING:
            return ""
        for name, of in self._all.items():
            if name not in engaged and not _at_height(of, reading.places[name], of.lifted_um):
                return f"{name} is not lifted"
        return ""

    # phases, in their order

    def _lifting(self, reading: Reading) -> tuple[Command, ...]:
        if self._all_lifted(reading):
            return self._enter(Phase.SEEING, reading)
        return self._waited(reading, "the probes could not be lifted")

    def _seeing(self, reading: Reading) -> tuple[Command, ...]:
        seen = reading.seen
        if seen is not None and self._since is not None and seen.time > self._since:
            if seen.sight.pose is None:
                self._rest, self._why_not_seen = [], seen.sight.reason or seen.sight.state
            elif not self._rest or seen.digest != self._rest[-1].digest:
                self._rest = [*self._rest, seen][-self._lab.watch.still_frames :]
                if self._at_rest():
                    return self._decided(reading)
        watch = self._lab.watch
        if self._since is not None and reading.time - self._since > watch.patience_s:
            return self._over("refused", f"the part was not seen at rest: {self._why_not_seen}")
        return ()

    def _at_rest(self) -> bool:
        poses = [seen.sight.pose for seen in self._rest if seen.sight.pose is not None]
        if len(poses) < self._lab.watch.still_frames:
            return False
        place, turn = spread_of(poses)
        still = place <= 0.5 * self._trust.position_um and turn <= 0.5 * self._trust.orientation_deg
        self._why_not_seen = "" if still else f"it moves by {place:.1f} um and {turn:.2f} deg"
        return still

    def _decided(self, reading: Reading) -> tuple[Command, ...]:
        pose = self._rest[-1].sight.pose
        if pose is None:
            return ()
        answer = self._decide(*pose)
        self.sensed, self._rest, self._why_not_seen = pose, [], NO_FRAME
        for key in ("refused", "error"):
            if key in answer:
                return self._over("refused", str(answer[key]))
        if "done" in answer:
            return self._over("done", "the part is in the goal")
        self.move = answer
        try:
            self._legs = self._planned(answer)
        except PlacingError as error:
            return self._over("refused", f"move {self.made + 1} cannot be made: {error}")
        if self.dry:
            return self._over("dry_run", told(answer))
        if self._confirm:
            self._enter(Phase.ASKING, reading)
            return (Command(do="ask", text=told(answer)),)
        return self._place(reading)

    def _planned(self, move: Mapping[str, Any]) -> tuple[Leg, ...]:
        """What each manipulator does; refused if one cannot."""
        places = {tip["name"]: (tip["start_um"][0], tip["start_um"][1]) for tip in move["probes"]}
        by_tip = carriers(self._lab, list(places))
        passive = {tip["name"] for tip in move["probes"] if tip.get("passive")}
        speed = float(move["speed_um_s"])
        travel = (float(move["travel_um"][0]), float(move["travel_um"][1]))
        self._rest_s, back_um = float(move.get("rest_s", 0.0)), float(move.get("back_um", 0.0))
        kept = 1.0 - min(back_um / max(math.hypot(*travel), 1e-300), 1.0)
        legs = []
        for name in sorted({one.name for one in by_tip.values()}):
            of = self._all[name]
            tips = {tip: places[tip] for tip, by in by_tip.items() if by.name == name}
            if {tip in passive for tip in tips} == {True, False}:
                raise PlacingError(f"{name} carries a tip that travels and one that holds still")
            start, off = target(of, tips)
            if off > of.arrival_um:
                raise PlacingError(
                    f"{name} cannot hold its tips so: one would be {off:.2f} um from its place, more "
                    f"than arrival_um = {of.arrival_um:g}"
                )
            holds = bool(set(tips) & passive)
            end = back = start
            if not holds:
                end, _ = target(of, {tip: _plus(place, travel) for tip, place in tips.items()})
                back = end
            if not holds and kept < 1.0:
                there = (kept * travel[0], kept * travel[1])
                back, _ = target(of, {tip: _plus(place, there) for tip, place in tips.items()})
            check_within(of, start)
            check_within(of, end)
            if not holds and speed > of.max_speed_um_s:
                raise PlacingError(
                    f"{name}: {speed:g} um/s is more than max_speed_um_s = {of.max_speed_um_s:g}"
                )
            legs.append(Leg(of=of, start=start, end=end, back=back, speed=speed))
        return tuple(legs)

    def _asking(self, reading: Reading) -> tuple[Command, ...]:
        if reading.word == "yes":
            return self._place(reading)
        if reading.word == "no":
            return self._over("stopped", "the move was not confirmed")
        return ()

    def _place(self, reading: Reading) -> tuple[Command, ...]:
        self._enter(Phase.PLACING, reading)
        ways = [
            (leg, _at(reading.places[leg.of.name]), leg.of.place_speed_um_s) for leg in self._legs
        ]
        self._expect(reading, [math.dist(at, leg.start) / speed for leg, at, speed in ways])
        return tuple(_go(leg.of, leg.start, speed) for leg, _, speed in ways)

    def _placing(self, reading: Reading) -> tuple[Command, ...]:
        fault = self._arrival(reading, [leg.start for leg in self._legs])
        if fault is None:
            return ()
        if fault:
            return self._give_up(reading, "fault", fault)
        return self._enter(Phase.HOVERING, reading)

    def _hovering(self, reading: Reading) -> tuple[Command, ...]:
        """No tip is to come down on a part that has moved."""
        amiss = self._unmoved(reading)
        if amiss is not None:
            return amiss
        self._enter(Phase.LOWERING, reading)
        return tuple(_lift(leg.of, leg.of.lowered_um) for leg in self._legs)

    def _lowering(self, reading: Reading) -> tuple[Command, ...]:
        places = reading.places
        down = [_at_height(leg.of, places[leg.of.name], leg.of.lowered_um) for leg in self._legs]
        if all(down) and not any(places[leg.of.name].busy for leg in self._legs):
            return self._enter(Phase.CHECKING, reading)
        return self._waited(reading, "the probes could not be lowered")

    def _checking(self, reading: Reading) -> tuple[Command, ...]:
        """The part is where it was when the move was decided, and so are the probes."""
        amiss = self._unmoved(reading)
        if amiss is not None:
            return amiss
        for leg in self._legs:
            off = math.dist(_at(reading.places[leg.of.name]), leg.start)
            if off > leg.of.arrival_um:
                return self._give_up(
                    reading, "fault", f"{leg.of.name} is {off:.1f} um from where it was placed"
                )
        if self._rests(reading):
            return ()
        self._enter(Phase.PUSHING, reading)
        active = [leg for leg in self._legs if leg.moves]
        self._expect(reading, [math.dist(leg.start, leg.end) / leg.speed for leg in active])
        return tuple(_go(leg.of, leg.end, leg.speed) for leg in active)

    def _unmoved(self, reading: Reading) -> tuple[Command, ...] | None:
        """None if a new frame shows the part where it was decided from, else what to do instead."""
        seen = reading.seen
        if seen is None or self._since is None or seen.time <= self._since:
            return self._waited(reading, "no frame arrived after the probes were moved")
        sight = seen.sight
        if sight.pose is None or sight.sigma is None or self.sensed is None:
            return self._waited(reading, f"the part is not seen between the probes: {sight.reason}")
        place, turn = spread_of([self.sensed, sight.pose])
        camera, trust = self._lab.camera, self._trust
        room = trust.position_um - SIGMAS * max(sight.sigma[:2]) - camera.position_error_um
        room_turn = trust.orientation_deg - SIGMAS * sight.sigma[2] - camera.orientation_error_deg
        if place <= room and turn <= room_turn:
            return None
        return self._give_up(
            reading,
            "refused",
            f"the part has moved by {place:.2f} um and {turn:.3f} deg since the move was decided; at most "
            f"{room:.2f} um and {room_turn:.3f} deg, so that its pose is known as the task states",
        )

    def _pushing(self, reading: Reading) -> tuple[Command, ...]:
        fault = self._astray(reading) or self._arrival(reading, [leg.end for leg in self._legs])
        if fault is None:
            return ()
        if fault:
            return self._give_up(reading, "fault", fault)
        if self._rest_s > 0.0 or any(leg.back != leg.end for leg in self._legs):
            return self._enter(Phase.RESTING, reading)
        return self._raised(reading)

    def _resting(self, reading: Reading) -> tuple[Command, ...]:
        fault = self._astray(reading)
        if fault:
            return self._give_up(reading, "fault", fault)
        if self._rests(reading):
            return ()
        drawn = [leg for leg in self._legs if leg.back != leg.end]
        if not drawn:
            return self._raised(reading)
        self._enter(Phase.WITHDRAWING, reading)
        self._expect(reading, [math.dist(leg.end, leg.back) / leg.speed for leg in drawn])
        return tuple(_go(leg.of, leg.back, leg.speed) for leg in drawn)

    def _withdrawing(self, reading: Reading) -> tuple[Command, ...]:
        fault = self._astray(reading) or self._arrival(reading, [leg.back for leg in self._legs])
        if fault is None:
            return ()
        if fault:
            return self._give_up(reading, "fault", fault)
        self._legs = tuple(replace(leg, end=leg.back) for leg in self._legs)
        return self._enter(Phase.RESTING, reading)

    def _astray(self, reading: Reading) -> str:
        """Why a tip that is down is not where it may be, or nothing."""
        for leg in self._legs:
            off = distance_from_line(_at(reading.places[leg.of.name]), leg.start, leg.end)
            if off > leg.of.arrival_um:
                return f"{leg.of.name} has left its straight way by {off:.1f} um"
            if not _at_height(leg.of, reading.places[leg.of.name], leg.of.lowered_um):
                return f"{leg.of.name} has left the plane"
        return ""

    def _rests(self, reading: Reading) -> bool:
        return self._since is None or reading.time - self._since < self._rest_s

    def _raised(self, reading: Reading) -> tuple[Command, ...]:
        self._enter(Phase.RAISING, reading)
        return tuple(_lift(leg.of, leg.of.lifted_um) for leg in self._legs)

    def _raising(self, reading: Reading) -> tuple[Command, ...]:
        if self._all_lifted(reading):
            self.made += 1
            self._legs = ()
            return self._enter(Phase.SEEING, reading)
        return self._waited(reading, "the probes could not be lifted")

    def _ending(self, reading: Reading) -> tuple[Command, ...]:
        late = self._since is not None and reading.time - self._since > self._lab.watch.patience_s
        down = [
            name
            for name, of in self._all.items()
            if name not in reading.places
            or not _at_height(of, reading.places[name], of.lifted_um)
            or reading.places[name].busy
        ]
        if down and not late:
            return self._lifted_again(reading, down)
        if down:
            text = f"{self._end.text}; {', '.join(down)} could not be lifted: lift by hand"
            self._end = Command(do="end", outcome="fault", text=text)
        self.phase = Phase.ENDED
        return (self._end,)

    def _lifted_again(self, reading: Reading, down: Sequence[str]) -> tuple[Command, ...]:
        """A device that failed when everything was halted and lifted may answer now."""
        self._failed = self._failed or bool(reading.fault)
        if reading.time - self._lifted_at <= AGAIN:
            return ()
        failed, self._failed, self._lifted_at = self._failed, False, reading.time
        if failed:
            return (HALT, *self._lift_all())
        resting = [
            name for name in down if name in reading.places and not reading.places[name].busy
        ]
        return tuple(_lift(self._all[name], self._all[name].lifted_um) for name in resting)

    # what several phases share

    def _enter(self, phase: Phase, reading: Reading) -> tuple[Command, ...]:
        self.phase, self._since, self._rest = phase, reading.time, []
        return ()

    def _over(self, outcome: Outcome, text: str) -> tuple[Command, ...]:
        """The end, all probes being lifted."""
        self.phase, self._end = Phase.ENDED, Command(do="end", outcome=outcome, text=text)
        return (self._end,)

    def _give_up(self, reading: Reading, outcome: Outcome, text: str) -> tuple[Command, ...]:
        """The end, everything halted and lifted first."""
        if self.dry:
            return self._over(outcome, text)
        self._end = Command(do="end", outcome=outcome, text=text)
        self._enter(Phase.ENDING, reading)
        self._failed, self._lifted_at = False, reading.time
        return (HALT, *self._lift_all())

    def _waited(self, reading: Reading, why: str) -> tuple[Command, ...]:
        if self._since is not None and reading.time - self._since > self._lab.watch.patience_s:
            return self._give_up(reading, "fault", why)
        return ()

    def _lift_all(self) -> tuple[Command, ...]:
        return tuple(_lift(of, of.lifted_um) for of in self._all.values())

    def _all_lifted(self, reading: Reading) -> bool:
        return all(
            name in reading.places
            and _at_height(of, reading.places[name], of.lifted_um)
            and not reading.places[name].busy
            for name, of in self._all.items()
        )

    def _expect(self, reading: Reading, times: Sequence[float]) -> None:
        self._deadline = reading.time + LATE * max(times, default=0.0) + SLACK

    def _arrival(self, reading: Reading, targets: Sequence[tuple[float, float]]) -> str | None:
        """None while one is on its way, "" if all are there, else why one will not be."""
        waits = False
        for leg, end in zip(self._legs, targets, strict=True):
            place = reading.places[leg.of.name]
            off = math.dist(_at(place), end)
            if place.busy:
                waits = True
            elif off > leg.of.arrival_um:
                if self._since is not None and reading.time - self._since > GRACE:
                    return f"{leg.of.name} stopped {off:.1f} um short of its target"
                waits = True
        if waits and reading.time > self._deadline:
            return "a manipulator did not arrive in time"
        return None if waits else ""


def told(move: Mapping[str, Any]) -> str:
    """A move in words.

    Parameters
    ----------
    move
        As `drive` answers it.

    Returns
    -------
    str
        One line.
    """
    tips = ", ".join(
        f"{tip['name']} at ({tip['start_um'][0]:.1f}, {tip['start_um'][1]:.1f})"
        + (" (holds)" if tip.get("passive") else "")
        for tip in move["probes"]
    )
    x, y = move["travel_um"]
    return f"{move['primitive']}: {tips}; by ({x:.1f}, {y:.1f}) um at {move['speed_um_s']:g} um/s"


def _plus(a: tuple[float, float], b: tuple[float, float]) -> tuple[float, float]:
    return a[0] + b[0], a[1] + b[1]


def _at(place: Place) -> tuple[float, float]:
    return place.x_um, place.y_um


def _at_height(of: ManipulatorSection, place: Place, height: float) -> bool:
    return abs(place.height_um - height) <= of.height_error_um


def _go(of: ManipulatorSection, to: tuple[float, float], speed: float) -> Command:
    return Command(do="go", name=of.name, x_um=to[0], y_um=to[1], speed_um_s=speed)


def _lift(of: ManipulatorSection, height: float) -> Command:
    return Command(do="lift", name=of.name, height_um=height)
