"""Trained policies: observations in, actions out."""

import json
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _native
from .driver import Driver

if TYPE_CHECKING:
    from .evaluation import Evaluation


class Policy:
    """A trained policy, which acts on numpy arrays. ``Policy.load`` reads one.

    Attributes:
        num_inputs: The length of an observation.
        num_actions: The number of discrete actions.
    """

    def __init__(self, native: _native.NativePolicy) -> None:
        self._native = native
        self.num_inputs: int = native.inputs
        self.num_actions: int = native.actions
        self._header: dict[str, Any] = json.loads(native.header())

    @classmethod
    def load(cls, policy: str | os.PathLike[str]) -> "Policy":
        """The policy in a file (``policy.safetensors`` of a run), or a shipped one (``Policy.shipped()``) by name.

        Raises:
            FileNotFoundError: There is no such file or name.
            ValueError: The file is not a policy.
        """
        return cls(_native.NativePolicy(os.fspath(policy)))

    @staticmethod
    def shipped() -> list[str]:
        """The names of the shipped policies."""
        return _native.NativePolicy.shipped()

    def q_values(self, observations: Any) -> np.ndarray:
        """The Q-values: float32, (actions,) for one observation, (rows, actions) for a batch.

        Raises:
            ValueError: The observations have the wrong length.
        """
        observations = np.ascontiguousarray(observations, np.float32)
        if observations.ndim not in (1, 2) or observations.shape[-1] != self.num_inputs:
            raise ValueError(
                f"the observations have the shape {observations.shape}; "
                f"help: give ({self.num_inputs},), or (rows, {self.num_inputs})"
            )
        values = self._native.q_values(observations.reshape(-1, self.num_inputs))
        return values.reshape(*observations.shape[:-1], self.num_actions)

    def act(self, observations: Any) -> np.ndarray | np.int64:
        """The greedy actions: int64, an index for one observation, (rows,) for a batch."""
        actions: np.ndarray | np.int64 = np.argmax(self.q_values(observations), axis=-1)
        return actions

    def velocities(self, observations: Any) -> np.ndarray:
        """The motions of the greedy actions: float32, (2,) or (rows, 2), speed in m/s and turning rate in rad/s (left
        positive). For a policy that drives any robot, such as ``general``, they are those of the robot in its card; use
        ``driver`` for another robot.

        Raises:
            ValueError: The policy has no card, which lists its motions.
        """
        if self.card is None:
            raise ValueError("the policy has no card, so its motions are unknown; help: use act()")
        motions = [(action["v_m_s"], action["w_rad_s"]) for action in self.card["actions"]]
        velocities: np.ndarray = np.array(motions, np.float32)[self.act(observations)]
        return velocities

    def encode(self, ranges_m: Any, bearing_rad: float, distance_m: float) -> np.ndarray:
        """The observation (float32) for a LIDAR scan and a goal, for robots outside wayfield. Use ``driver`` for policies
        that also observe earlier scans.

        Args:
            ranges_m: One range per beam in m, counterclockwise from the first beam of the card.
            bearing_rad: The angle from the heading to the goal in rad, -pi to pi, left positive.
            distance_m: The distance to the goal in m.

        Raises:
            ValueError: The number of ranges is wrong, or the policy observes by sectors (docs/algorithm.md) or was trained with
                plugin sensors.
        """
        return self._native.encode(np.ravel(ranges_m).tolist(), bearing_rad, distance_m)

    def driver(
        self, scenario: str | os.PathLike[str], *, with_map: bool = False, set: Mapping[str, Any] | None = None
    ) -> Driver:
        """Makes a driver, with which this policy drives a robot outside wayfield step by step.

        Args:
            scenario: A shipped name, a path or RON text. Its robot, LIDAR, control period and goal radius must be the real ones;
                its obstacles do not matter.
            with_map: Whether the driver builds a map as it drives, to find its way out of dead ends (docs/drivers.md).
            set: New values for fields of the scenario, as with ``--set``: ``{"scenario.lidar.beams": 360}``.

        Warns:
            UserWarning: The scenario differs from the one used in training.

        Raises:
            ValueError: The policy does not fit the scenario, was trained with plugin sensors, or a setting is invalid.
            FileNotFoundError: There is no such scenario.
        """
        return Driver(self, scenario, with_map, set)

    def predict(
        self, observation: Any, state: Any = None, episode_start: Any = None, deterministic: bool = True
    ) -> tuple[np.ndarray | np.int64, None]:
        """The greedy actions, and no state: the interface of Stable-Baselines3's ``evaluate_policy``."""
        return self.act(observation), None

    @property
    def card(self) -> dict[str, Any] | None:
        """The policy's card: inputs with units, actions, scenario, training. None in files of format version 1."""
        return self._header.get("card")

    @property
    def network(self) -> dict[str, Any]:
        """The sizes of the network."""
        network: dict[str, Any] = self._header["network"]
        return network

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the policy as a safetensors file."""
        with open(path, "wb") as file:
            file.write(self._native.to_bytes())

    def export_onnx(
        self, path: str | os.PathLike[str], evaluations: "Sequence[Evaluation]" = ()
    ) -> Path | None:
        """Writes the policy as an ONNX file, like ``wayfield --export``: metres and radians in, velocities out.

        Args:
            path: The file, with the extension ``onnx``.
            evaluations: Results of ``wayfield.evaluate`` with this policy, for the model card.

        Returns:
            The path of the model card (``README.md`` in the same folder), or None if that file exists and wayfield did not
            write it.
        """
        card = self._native.export_onnx(os.fspath(path), [evaluation.to_json() for evaluation in evaluations])
        return None if card is None else Path(card)

    def __repr__(self) -> str:
        return f"Policy({self.num_inputs} inputs, {self.num_actions} actions)"

    def __reduce__(self) -> tuple[Any, ...]:
        return _from_bytes, (self._native.to_bytes(),)


def _from_bytes(contents: bytes) -> Policy:
    return Policy(_native.NativePolicy.from_bytes(contents))
