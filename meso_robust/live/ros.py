"""What the loop says and needs, in the shapes of ROS 2 messages: plain values, no ROS is imported.

A node of the laboratory hands ``latest`` the newest message of a topic and ``publish`` what is to be sent;
fields, units and frames are those of ``sensor_msgs`` and ``geometry_msgs``: m, rad, s.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from meso_robust.live.devices import Clock, DeviceError, Devices, Frame, Status
from meso_robust.live.lab_file import Lab
from meso_robust.live.sight import DEG, UM, Sight
from meso_robust.types import Image

Message = Mapping[str, Any]
Latest = Callable[[str], Message | None]
Publish = Callable[[str, Message], object]
MONO8 = "mono8"


def stamp_of(instant: float) -> dict[str, int]:
    """``builtin_interfaces/Time``.

    Parameters
    ----------
    instant
        s

    Returns
    -------
    dict
        Whole seconds, and the rest in ns.
    """
    whole = math.floor(instant)
    return {"sec": whole, "nanosec": round((instant - whole) * 1e9) % 10**9}


def seconds_of(stamp: Message) -> float:
    """The instant of a ``builtin_interfaces/Time``.

    Parameters
    ----------
    stamp
        The message.

    Returns
    -------
    float
        s
    """
    return int(stamp["sec"]) + 1e-9 * int(stamp["nanosec"])


def image_message(frame: Frame, frame_id: str = "camera") -> dict[str, Any]:
    """``sensor_msgs/Image`` of a frame.

    Parameters
    ----------
    frame, frame_id
        The frame, and what its header calls the camera.

    Returns
    -------
    dict
        8 bits of grey, row by row.
    """
    high, wide = frame.image.shape
    return {
        "header": {"stamp": stamp_of(frame.time), "frame_id": frame_id},
        "height": high,
        "width": wide,
        "encoding": MONO8,
        "is_bigendian": 0,
        "step": wide,
        "data": frame.image.tobytes(),
    }


def image_of(message: Message) -> Image:
    """The image of a ``sensor_msgs/Image``.

    Parameters
    ----------
    message
        Of encoding mono8.

    Returns
    -------
    Image
        (H, W) uint8.

    Raises
    ------
    DeviceError
        It has another encoding, or too few data.
    """
    if message["encoding"] != MONO8:
        raise DeviceError(f"image: encoding {message['encoding']!r}; must be {MONO8}: convert it")
    high, wide, step = int(message["height"]), int(message["width"]), int(message["step"])
    data = np.frombuffer(bytes(message["data"]), np.uint8)
    if step < wide or data.size < high * step:
        raise DeviceError(f"image: {data.size} bytes for {high} rows of {step}")
    return np.ascontiguousarray(data[: high * step].reshape(high, step)[:, :wide])


def pose_message(sight: Sight, instant: float, frame_id: str = "world") -> dict[str, Any] | None:
    """``geometry_msgs/PoseWithCovarianceStamped`` of what a frame shows.

    Parameters
    ----------
    sight, instant, frame_id
        What it shows, when it was exposed, s, and what the world is called.

    Returns
    -------
    dict or None
        None if the pose cannot be trusted: a message could not say so.
    """
    if sight.pose is None or sight.covariance is None:
        return None
    x, y, theta = sight.pose
    xx, xy, xt, yy, yt, tt = sight.covariance
    half, cell = 0.5 * theta * DEG, np.zeros((6, 6))
    cell[0, 0], cell[1, 1], cell[5, 5] = xx * UM**2, yy * UM**2, tt * DEG**2
    cell[0, 1] = cell[1, 0] = xy * UM**2
    cell[0, 5] = cell[5, 0] = xt * UM * DEG
    cell[1, 5] = cell[5, 1] = yt * UM * DEG
    return {
        "header": {"stamp": stamp_of(instant), "frame_id": frame_id},
        "pose": {
            "pose": {
                "position": {"x": x * UM, "y": y * UM, "z": 0.0},
                "orientation": {"x": 0.0, "y": 0.0, "z": math.sin(half), "w": math.cos(half)},
            },
            "covariance": cell.ravel().tolist(),
        },
    }


class RosCamera:
    """The camera's topic ``image``."""

    def __init__(self, latest: Latest, wait: Callable[[float], object]) -> None:
        self._latest, self._wait = latest, wait
        self._number, self._last = 0, -math.inf

    def frame(self, patience: float) -> Frame | None:
        """The newest message, if it is newer than the one before."""
        for late in (False, True):
            message = self._latest("image")
            if message is not None:
                time = seconds_of(message["header"]["stamp"])
                if time > self._last:
                    self._number, self._last = self._number + 1, time
                    return Frame(number=self._number, time=time, image=image_of(message))
            if not late:
                self._wait(patience)
        return None


class RosManipulator:
    """Topics ``NAME/joint_states`` (x, y, height) in, ``NAME/target``, ``NAME/lift``, ``NAME/stop`` out."""

    def __init__(self, name: str, latest: Latest, publish: Publish) -> None:
        self._name, self._latest, self._publish = name, latest, publish

    def status(self) -> Status:
        """Of the newest ``sensor_msgs/JointState``; it moves while any velocity is not zero."""
        message = self._latest(f"{self._name}/joint_states")
        if message is None:
            raise DeviceError(f"{self._name}: no joint_states arrived")
        at = dict(zip(message["name"], message["position"], strict=False))
        missing = {"x", "y", "height"} - set(at)
        if missing:
            raise DeviceError(f"{self._name}: joint_states has no {', '.join(sorted(missing))}")
        busy = any(float(speed) != 0.0 for speed in message.get("velocity", ()))
        return Status(x=float(at["x"]), y=float(at["y"]), height=float(at["height"]), busy=busy)

    def go(self, x: float, y: float, speed: float) -> None:
        """``geometry_msgs/TwistStamped`` would not say where to: a target with its speed."""
        position = {"x": x, "y": y, "z": 0.0}
        self._publish(f"{self._name}/target", {"position": position, "speed": speed})

    def lift(self, height: float) -> None:
        """``std_msgs/Float64``."""
        self._publish(f"{self._name}/lift", {"data": height})

    def stop(self) -> None:
        """``std_msgs/Empty``."""
        self._publish(f"{self._name}/stop", {})


def devices_by(
    lab: Lab, latest: Latest, publish: Publish, clock: Clock, wait: Callable[[float], object]
) -> Devices:
    """The devices of a laboratory that speaks ROS 2.

    Parameters
    ----------
    lab
        Names its manipulators.
    latest, publish
        The newest message of a topic; sends one.
    clock
        Of the stamps.
    wait
        Waits for a time in s, or until a message arrives.

    Returns
    -------
    Devices
        Nothing is asked yet.
    """
    return Devices(
        camera=RosCamera(latest, wait),
        manipulators={
            one.name: RosManipulator(one.name, latest, publish) for one in lab.manipulators
        },
        clock=clock,
    )
