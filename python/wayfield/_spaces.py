"""The options of environments, their spaces, and the native environment."""

import os
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from gymnasium import spaces

from . import _native
from ._settings import pairs

#: The images of environments are twice the size of the drawing, 480 x 360 pixels.
RENDER_SCALE = 2.0


def make_native(
    scenario: str | os.PathLike[str],
    num_envs: int,
    task: str,
    observation: str | None,
    preset: str | os.PathLike[str],
    settings: Mapping[str, Any] | None,
    autoreset: str,
) -> _native.NativeEnv:
    """The native environments with these options (``NavigationEnv`` describes them)."""
    options = {
        "num_envs": num_envs,
        "task": task,
        "observation": observation,
        "preset": os.fspath(preset),
        "settings": pairs(settings),
        "autoreset": autoreset,
    }
    return _native.NativeEnv(os.fspath(scenario), options)


def observation_space(native: _native.NativeEnv) -> spaces.Box:
    """The space of one observation: float32, (beams + 4,)."""
    low, high = (np.array(bound, dtype=np.float32) for bound in native.observation_bounds)
    return spaces.Box(low, high, dtype=np.float32)


def action_space(native: _native.NativeEnv, actions: str) -> spaces.Space[Any]:
    """The space of one action: an index of a motion, or a speed in m/s and a turning rate in rad/s."""
    if is_discrete(actions):
        return spaces.Discrete(native.num_actions)
    low, high = (np.array(bound, dtype=np.float32) for bound in native.motion_limits)
    return spaces.Box(low, high, dtype=np.float32)


def is_discrete(actions: str) -> bool:
    """Whether ``actions`` is the name of the discrete ones.

    Raises:
        ValueError: It is not a name of actions.
    """
    if actions not in ("discrete", "continuous"):
        raise ValueError(f'actions is {actions!r}; help: give "discrete" or "continuous"')
    return actions == "discrete"


def action_array(actions: Any, count: int, is_discrete: bool) -> np.ndarray:
    """``count`` actions as the native environment takes them: int64, (count,), or float32, (count, 2).

    Raises:
        ValueError: They have another shape.
    """
    array = np.ascontiguousarray(actions, np.int64 if is_discrete else np.float32)
    shape = (count,) if is_discrete else (count, 2)
    if array.shape != shape:
        raise ValueError(f"the actions have the shape {array.shape}; help: give an array of the shape {shape}")
    return array


class Stepper:
    """Takes the steps of native environments: actions in, fresh arrays out."""

    def __init__(self, native: _native.NativeEnv, num_envs: int, actions: str) -> None:
        self.native = native
        self.num_envs = num_envs
        self.width = native.observation_width
        self.terms = native.reward_terms
        self._is_discrete = is_discrete(actions)
        self._step: Callable[..., bool] = native.step if self._is_discrete else native.step_motions
        self._numbers = (1 + len(native.reward_terms), num_envs)
        self._flags = (len(native.flags), num_envs)

    def reset(self, seed: int | None, mask: Any = None) -> np.ndarray:
        """The observations after the reset of all environments, or of those in ``mask``."""
        observations = np.empty((self.num_envs, self.width), np.float32)
        self.native.reset(observations, seed, mask)
        return observations

    def step(self, actions: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray, bool]:
        """Observations, rewards with their terms (float64, row by row), flags (bool, row by row), and whether any episode
        ended."""
        actions = action_array(actions, self.num_envs, self._is_discrete)
        observations = np.empty((self.num_envs, self.width), np.float32)
        numbers, flags = np.empty(self._numbers), np.empty(self._flags, np.uint8)
        ended = self._step(actions, (observations, numbers, flags))
        return observations, numbers, flags.view(np.bool_), ended

    def final_observations(self) -> np.ndarray:
        """The observations after the last step and before any reset."""
        observations = np.empty((self.num_envs, self.width), np.float32)
        self.native.final_observations(observations)
        return observations

    def render(self, index: int) -> np.ndarray:
        """The picture of one environment: uint8, height x width x 3."""
        height, width, pixels = self.native.render(index, RENDER_SCALE)
        return np.frombuffer(bytearray(pixels), np.uint8).reshape(height, width, 3)


def check_render_mode(render_mode: str | None) -> None:
    """Raises a ValueError for an unknown mode."""
    if render_mode not in (None, "rgb_array"):
        raise ValueError(f'render_mode is {render_mode!r}; help: give "rgb_array" or None')


def seed_of(rng: np.random.Generator) -> int:
    """A native seed drawn from ``rng``."""
    return int(rng.integers(2**63))
