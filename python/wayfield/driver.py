"""Policies that drive robots outside wayfield, step by step."""

import os
import warnings
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from . import _native
from ._settings import pairs

if TYPE_CHECKING:
    from .policy import Policy


class Motion(NamedTuple):
    """What a driver commands for the next control period.

    Attributes:
        v_m_s: The speed in m/s.
        w_rad_s: The turning rate in rad/s, left positive.
        action: The index of the policy's action.
    """

    v_m_s: float
    w_rad_s: float
    action: int


class Driver:
    """A policy that drives one robot, step by step. It remembers what the robot has seen in the episode. ``Policy.driver`` makes
    one.

    Attributes:
        beam_angles_rad: The directions of the LIDAR's beams from the heading in rad, left positive: float32, (beams,).
        max_range_m: The LIDAR's maximum range in m.
        control_period_s: The time between two calls of ``act`` in s.
    """

    def __init__(
        self, policy: "Policy", scenario: str | os.PathLike[str], with_map: bool, set: Mapping[str, Any] | None
    ) -> None:
        self._native = _native.NativeDriver(policy._native, os.fspath(scenario), pairs(set), with_map)
        self.beam_angles_rad: np.ndarray = self._native.beam_angles_rad
        self.max_range_m: float = self._native.max_range_m
        self.control_period_s: float = self._native.control_period_s
        if self._native.warning is not None:
            # Level 3 is the line that called `Policy.driver`.
            warnings.warn(self._native.warning, stacklevel=3)

    def reset(self) -> None:
        """Starts an episode, for example in another building: forgets all scans and the map. Neither a new driver nor a new goal
        needs a reset."""
        self._native.reset()

    def act(
        self,
        ranges_m: Any,
        *,
        goal: tuple[float, float],
        pose: tuple[float, float, float],
        twist: tuple[float, float],
    ) -> Motion:
        """Chooses the motion for the next control period. Call it once per control period: the policy assumes that this is the
        time between two calls.

        Args:
            ranges_m: The scan: one range per beam in m, in the order of ``beam_angles_rad``. A beam that hits nothing has the
                maximum range; longer ranges count as the maximum.
            goal: The angle from the heading to the goal in rad, left positive, and the distance from the robot's centre in m.
            pose: The robot's x in m, y in m and heading in rad by odometry, in any frame that stays fixed during the episode.
            twist: The robot's actual speed in m/s and turning rate in rad/s, left positive.

        Raises:
            ValueError: The number of ranges is not the LIDAR's number of beams, a number is not finite, a range or the distance
                is negative, or a number in ``goal``, ``pose`` or ``twist`` has a magnitude above 1e7. Such a call leaves the
                driver unchanged.
        """
        ranges = np.asarray(ranges_m, np.float32).ravel()
        return Motion(*self._native.act(ranges, tuple(goal), tuple(pose), tuple(twist)))

    @property
    def observation(self) -> np.ndarray:
        """The policy's observation in the last call of ``act``: float32, (width,). If the policy observes by sectors
        (docs/algorithm.md), this is the input ``observation`` of its ONNX file. All zeros before the first call of an episode."""
        return self._native.observation
