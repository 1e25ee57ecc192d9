"""The options of environments, their spaces, and the native environment."""

import os
from collections.abc import Mapping
from typing import Any

import numpy as np
from gymnasium import spaces

from . import _native
from ._settings import pairs

#: Rendered images are twice the size of the drawing, which has 480 x 360 pixels.
RENDER_SCALE = 2.0


def make_native(
    scenario: str | os.PathLike[str],
    num_envs: int,
    task: str,
    observation: str | None,
    actions: str,
    preset: str | os.PathLike[str],
    settings: Mapping[str, Any] | None,
    autoreset: str,
) -> _native.NativeEnv:
    """Makes the native environments with these options (``NavigationEnv`` describes them)."""
    options = {
        "num_envs": num_envs,
        "task": task,
        "observation": observation,
        "actions": actions,
        "preset": os.fspath(preset),
        "settings": pairs(settings),
        "autoreset": autoreset,
    }
    return _native.NativeEnv(os.fspath(scenario), options)


def observation_space(native: _native.NativeEnv) -> spaces.Box:
    """The space of one observation: float32, (width,)."""
    low, high = (np.array(bound, dtype=np.float32) for bound in native.observation_bounds)
    return spaces.Box(low, high, dtype=np.float32)


def action_space(native: _native.NativeEnv) -> spaces.Space[Any]:
    """The space of one action: the index of a motion, or a speed in m/s and a turning rate in rad/s."""
    if not native.is_continuous:
        return spaces.Discrete(native.num_actions)
    low, high = (np.array(bound, dtype=np.float32) for bound in native.motion_limits)
    return spaces.Box(low, high, dtype=np.float32)


def render(native: _native.NativeEnv, index: int) -> np.ndarray:
    """The image of one environment: uint8, height x width x 3."""
    height, width, pixels = native.render(index, RENDER_SCALE)
    return np.frombuffer(bytearray(pixels), np.uint8).reshape(height, width, 3)


def check_render_mode(render_mode: str | None) -> None:
    """Raises a ValueError for an unknown mode."""
    if render_mode not in (None, "rgb_array"):
        raise ValueError(f'render_mode is {render_mode!r}; help: give "rgb_array" or None')


def seed_of(rng: np.random.Generator) -> int:
    """A native seed drawn from ``rng``."""
    return int(rng.integers(2**63))
