"""The environments for Stable-Baselines3, which has its own interface for vectorized environments."""

import os
from collections.abc import Sequence
from typing import Any

import numpy as np
from gymnasium.vector import AutoresetMode

try:
    from stable_baselines3.common.vec_env import VecEnv
except ImportError as error:
    raise ImportError("Stable-Baselines3 is not installed; help: pip install stable-baselines3") from error

from .vector import NavigationVectorEnv


class NavigationVecEnv(VecEnv):
    """``num_envs`` robots in one process, for SB3's learners: ``DQN("MlpPolicy", NavigationVecEnv(16))``.

    The options are those of :class:`wayfield.NavigationVectorEnv`, except ``autoreset_mode``, which is always
    ``SAME_STEP``. At the end of an episode, the environment's info has ``is_success``, ``terminal_observation`` and
    ``TimeLimit.truncated``; otherwise it is empty.
    """

    def __init__(self, num_envs: int = 1, scenario: str | os.PathLike[str] = "scenario-1", **options: Any) -> None:
        self.envs = NavigationVectorEnv(num_envs, scenario, autoreset_mode=AutoresetMode.SAME_STEP, **options)
        self.render_mode = self.envs.render_mode
        self._actions: Any = None
        self._seed: int | None = None
        super().__init__(num_envs, self.envs.single_observation_space, self.envs.single_action_space)

    def seed(self, seed: int | None = None) -> Sequence[int | None]:
        """Sets the seed of the next reset."""
        self._seed = seed
        return [seed] * self.num_envs

    def reset(self) -> np.ndarray:
        """The first observations: float32, (num_envs, width)."""
        observations, _ = self.envs.reset(seed=self._seed)
        self._seed = None
        self.reset_infos: list[dict[str, Any]] = [{} for _ in range(self.num_envs)]
        return observations

    def step_async(self, actions: np.ndarray) -> None:
        """Keeps the actions for ``step_wait``."""
        self._actions = actions

    def step_wait(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, list[dict[str, Any]]]:
        """Observations, rewards (float32), dones, and a dict per environment."""
        observations, rewards, terminated, truncated, info = self.envs.step(self._actions)
        dones = terminated | truncated
        infos: list[dict[str, Any]] = [{} for _ in range(self.num_envs)]
        for index in np.flatnonzero(dones):
            infos[index] = {
                "terminal_observation": info["final_obs"][index],
                "TimeLimit.truncated": bool(truncated[index]),
                "is_success": bool(info["final_info"]["is_success"][index]),
            }
        return observations, rewards.astype(np.float32), dones, infos

    def close(self) -> None:
        """Closes the environments."""
        self.envs.close()

    def get_images(self) -> Sequence[np.ndarray | None]:
        """The image of each environment."""
        return self.envs.render() or [None] * self.num_envs

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        """An attribute, once per selected environment."""
        return [getattr(self.envs, attr_name)] * len(list(self._get_indices(indices)))

    def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
        """Sets an attribute of all environments, which share it."""
        if indices is not None and len(list(self._get_indices(indices))) != self.num_envs:
            raise ValueError("the environments share their attributes; help: set the attribute of all of them")
        setattr(self.envs, attr_name, value)

    def env_method(self, method_name: str, *arguments: Any, indices: Any = None, **options: Any) -> list[Any]:
        """Calls a method of ``NavigationVectorEnv`` once per selected environment, whose index is the first argument."""
        method = getattr(self.envs, method_name)
        return [method(index, *arguments, **options) for index in self._get_indices(indices)]

    def env_is_wrapped(self, wrapper_class: type, indices: Any = None) -> list[bool]:
        """False for every selected environment: they have no wrappers."""
        return [False for _ in self._get_indices(indices)]
