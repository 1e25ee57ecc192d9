"""The vectorized environment: many robots, stepped together in one call."""

import os
from collections.abc import Mapping
from typing import Any

import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space

from ._info import StepInfo
from ._spaces import action_space, check_render_mode, make_native, observation_space, render, seed_of

_NATIVE_MODES = {
    AutoresetMode.NEXT_STEP: "next_step",
    AutoresetMode.SAME_STEP: "same_step",
    AutoresetMode.DISABLED: "disabled",
}


class NavigationVectorEnv(VectorEnv):
    """``num_envs`` robots in one scenario: ``gymnasium.make_vec("wayfield/Navigation-v0", num_envs=64, ...)``.

    Observations, actions, rewards and options are those of :class:`wayfield.NavigationEnv`, with a first axis of length
    ``num_envs``. The results of environment k do not depend on ``num_envs``. With the same seed, they equal those of
    environment k of Rust's ``VecEnv``.

    ``info`` is a dict of arrays, filled when it is first read: float64 ``reward_goal``, ``reward_collision``,
    ``reward_attraction`` and ``reward_repulsion``, bool ``is_success`` and ``collision``. As in Gymnasium, the mask ``_key``
    marks the environments in which ``key`` is valid.

    Args:
        num_envs: The number of robots, 1 to 4096.
        autoreset_mode: When the next episode begins. ``NEXT_STEP``: in the step after the last one of the episode; that step
            ignores the action and has a reward of 0. ``SAME_STEP``: in the last step itself, with the last observation in
            ``info["final_obs"]`` and its info in ``info["final_info"]``. ``DISABLED``: only when
            ``reset(options={"reset_mask": mask})`` is called.
    """

    metadata = {"render_modes": ["rgb_array"], "render_fps": 5, "autoreset_mode": AutoresetMode.NEXT_STEP}

    def __init__(
        self,
        num_envs: int = 1,
        scenario: str | os.PathLike[str] = "scenario-1",
        *,
        task: str = "navigation",
        observation: str | None = None,
        actions: str = "discrete",
        preset: str | os.PathLike[str] = "fast",
        set: Mapping[str, Any] | None = None,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        render_mode: str | None = None,
    ) -> None:
        check_render_mode(render_mode)
        mode = AutoresetMode(autoreset_mode)
        native = make_native(scenario, num_envs, task, observation, actions, preset, set, _NATIVE_MODES[mode])
        self.num_envs = num_envs
        self.render_mode = render_mode
        self.single_observation_space = observation_space(native)
        self.single_action_space = action_space(native)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self.metadata = {
            **self.metadata,
            "render_fps": max(1, round(1 / native.control_period_s)),
            "autoreset_mode": mode,
        }
        self._native = native
        self._is_reset = False

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[np.ndarray, dict[str, Any]]:
        """Starts new episodes: in all environments, or in those that the bool array ``options["reset_mask"]`` selects. With
        a seed, environment k gets the same random numbers as environment k after Rust's ``VecEnv::reset(seed)``.

        Returns:
            All observations, float32, (num_envs, width), and an empty dict.

        Raises:
            RuntimeError: The mask leaves out environments that have never been reset.
            ValueError: The mask is not a bool array of the shape (num_envs,).
        """
        if seed is not None:
            super().reset(seed=seed)
        mask = None if options is None else options.get("reset_mask")
        if not self._is_reset:
            if mask is not None and not np.all(mask):
                raise RuntimeError("the environments were not reset; help: call reset() without reset_mask first")
            seed = seed_of(self.np_random) if seed is None else seed
        observations = self._native.reset(seed, mask)
        self._is_reset = True
        return observations, {}

    def step(self, actions: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, dict[str, Any]]:
        """Takes one control step in every environment.

        Args:
            actions: int, (num_envs,), or with continuous actions float32, (num_envs, 2).

        Returns:
            Observations (float32), rewards (float64), terminated and truncated (bool), info. The arrays are newly allocated.

        Raises:
            RuntimeError: The environments have not been reset or, with ``DISABLED``, an episode has ended and was not reset.
            ValueError: An action is out of range, a motion is not finite, or the shape is wrong.
        """
        if not self._is_reset:
            raise RuntimeError("the environments were not reset; help: call reset() before step()")
        info = StepInfo()
        observations, rewards, terminated, truncated, info.details = self._native.step(actions)
        return observations, rewards, terminated, truncated, info

    def render(self) -> tuple[np.ndarray, ...] | None:
        """The image of each environment: uint8, 720 x 960 x 3; None without ``render_mode="rgb_array"``."""
        if self.render_mode != "rgb_array":
            return None
        return tuple(render(self._native, index) for index in range(self.num_envs))

    @property
    def motions(self) -> list[tuple[float, float]]:
        """The motions of the discrete actions: speed in m/s, turning rate in rad/s (left positive)."""
        return self._native.motions

    def state(self, index: int) -> dict[str, Any]:
        """The state of one environment, like ``NavigationEnv.state``."""
        return self._native.state(index)
