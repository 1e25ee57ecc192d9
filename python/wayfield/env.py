"""The environment of one robot."""

import os
from collections.abc import Mapping
from typing import Any

import gymnasium
import numpy as np

from ._spaces import action_space, check_render_mode, make_native, observation_space, render, seed_of


class NavigationEnv(gymnasium.Env):
    """A LIDAR robot that drives to a goal among obstacles: ``gymnasium.make("wayfield/Navigation-v0", ...)``.

    **Observation**: float32, (beams + 4,); 28 numbers with 24 beams. The LIDAR's ranges, counterclockwise; the goal's
    bearing, left positive; the goal's distance; the smallest range; the index of its beam. ``"scaled"``: divided by 3.5 m,
    pi, 4 m, 3.5 m and the number of beams. ``"raw"``: in m and rad. A preset such as ``general`` may observe by sectors
    instead (docs/algorithm.md), with another width and without bounds.

    **Action**: ``"discrete"``, the index of one of the robot's motions (``motions``), or ``"continuous"``, float32, (2,):
    speed in m/s and turning rate in rad/s, limited to the action space and by the robot's minimum turning radius.

    **Reward**: the sum of the terms in ``info``: ``reward_goal``, ``reward_collision``, ``reward_attraction`` and
    ``reward_repulsion``. ``info`` also has ``is_success`` and ``collision``.

    **End**: a collision or a reached goal terminates an episode; the scenario's time limit (500 steps by default) truncates
    it. A step is one control period (0.2 s by default).

    Args:
        scenario: A shipped scenario by name (``wayfield.scenarios()``), a file's path, or the text of a RON file; also a set,
            from which each episode draws a scenario.
        task: ``"navigation"``: a reached goal ends the episode, and the next one starts elsewhere. ``"continuing"``: the
            next episode starts where the robot is, with a new goal and with the steps that are left of the time limit. The
            robot is moved only after a collision, at the time limit, or if no new goal is far enough from it. wayfield's own
            learner trains on this task.
        observation: ``"scaled"`` or ``"raw"``; None takes the preset's.
        actions: ``"discrete"`` or ``"continuous"``.
        preset: A training preset (``wayfield.presets()``, a path or RON text), whose reward and observation are used.
        set: New values for fields of the preset or the scenario, as with ``--set``: ``{"reward.mu": 50,
            "reward.kind": "Traditional", "scenario.lidar.noise_std_m": 0.02}``. A string is taken as RON text, and a tuple
            becomes a RON tuple.
        render_mode: None, or ``"rgb_array"``: an image of 960 x 720 pixels, seen from above, with obstacles, goal, robot
            and beams.

    Raises:
        ValueError: An option or the scenario is invalid; the message gives the file, the line and a fix.
        FileNotFoundError: There is no such scenario or preset.
    """

    metadata = {"render_modes": ["rgb_array"], "render_fps": 5}

    def __init__(
        self,
        scenario: str | os.PathLike[str] = "scenario-1",
        *,
        task: str = "navigation",
        observation: str | None = None,
        actions: str = "discrete",
        preset: str | os.PathLike[str] = "fast",
        set: Mapping[str, Any] | None = None,
        render_mode: str | None = None,
    ) -> None:
        check_render_mode(render_mode)
        native = make_native(scenario, 1, task, observation, actions, preset, set, "disabled")
        self.action_space = action_space(native)
        self.observation_space = observation_space(native)
        self.render_mode = render_mode
        self.metadata = {**self.metadata, "render_fps": max(1, round(1 / native.control_period_s))}
        self._native = native
        self._is_reset = False

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[np.ndarray, dict[str, Any]]:
        """Starts an episode. With a seed, its random numbers are the same as after ``VecEnv::reset(seed)`` in Rust; without one,
        they continue the sequence of the previous episodes, and the first reset draws a seed.

        Returns:
            The observation and an empty dict.
        """
        super().reset(seed=seed)
        if seed is None and not self._is_reset:
            seed = seed_of(self.np_random)
        self._is_reset = True
        return self._native.reset(seed)[0], {}

    def step(self, action: Any) -> tuple[np.ndarray, float, bool, bool, dict[str, Any]]:
        """Takes one control step.

        Returns:
            Observation, reward, terminated, truncated, info.

        Raises:
            RuntimeError: The environment was not reset, or its episode has ended.
            ValueError: The action is out of range, or the motion is not finite or has the wrong shape.
        """
        if not self._is_reset:
            raise RuntimeError("the environment was not reset; help: call reset() before step()")
        return self._native.step_one(action)

    def render(self) -> np.ndarray | None:
        """The image of the environment: uint8, 720 x 960 x 3; None without ``render_mode="rgb_array"``."""
        return render(self._native, 0) if self.render_mode == "rgb_array" else None

    @property
    def motions(self) -> list[tuple[float, float]]:
        """The motions of the discrete actions: speed in m/s, turning rate in rad/s (left positive)."""
        return self._native.motions

    @property
    def state(self) -> dict[str, Any]:
        """The state: ``pose`` (m, m, rad), ``velocity`` (m/s, rad/s), ``goal`` (m, m), ``ranges`` (m), ``clock``
        (control steps since the last reset with a seed) and ``episode_steps`` (control steps)."""
        return self._native.state(0)
