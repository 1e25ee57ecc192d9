"""Evaluations of policies."""

import json
import os
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from . import _native
from ._frames import to_frame
from ._settings import pairs
from .policy import Policy


@dataclass(frozen=True)
class Evaluation:
    """The results of a policy over episodes: the numbers of ``wayfield --eval --json``.

    Attributes:
        scenario: The scenario's name.
        success_rate, collision_rate, timeout_rate: Shares of the episodes, 0 to 1.
        mean_time_s: The mean simulated time of the successful episodes in s; None without one.
        mean_cost_s: The same, with the time limit for each failed episode.
        seed: The seed of starts and goals.
        rounds: The success rate of each round.
        episodes: One value per episode: ``end`` ("goal", "collision" or "timeout"), ``steps``, ``start_x_m``, ``start_y_m``,
            ``start_heading_rad``, ``goal_x_m``, ``goal_y_m``, ``layout_seed``.
    """

    scenario: str
    success_rate: float
    collision_rate: float
    timeout_rate: float
    mean_time_s: float | None
    mean_cost_s: float
    seed: int
    rounds: list[float]
    episodes: dict[str, np.ndarray]

    def to_frame(self) -> Any:
        """The episodes as a pandas DataFrame.

        Raises:
            ImportError: pandas is not installed.
        """
        return to_frame(self.episodes)


def evaluate(
    policy: Policy | str | os.PathLike[str],
    scenario: str | os.PathLike[str] | None = None,
    *,
    set: Mapping[str, Any] | None = None,
    episodes: int = 100,
    rounds: int = 5,
    seed: int = 0,
    benchmark_route: bool = False,
) -> Evaluation:
    """Tests a policy over ``rounds * episodes`` episodes, as ``wayfield --eval``.

    Args:
        policy: A policy, its file, or the name of a shipped one.
        scenario: A shipped name, a path or RON text; None for the scenario that the policy was trained in.
        set: Fields of the scenario with other values, as ``--set`` takes them: ``{"scenario.lidar.noise_std_m": 0.02}``.
        episodes: The episodes of a round.
        rounds: The number of rounds.
        seed: The seed of starts and goals. Equal seeds give equal episodes.
        benchmark_route: Drive the scenario's benchmark route in every episode.

    Raises:
        ValueError: The policy does not fit the scenario, or an option is out of range.
        FileNotFoundError: There is no such file.
    """
    policy = policy if isinstance(policy, Policy) else Policy.load(policy)
    scenario = None if scenario is None else os.fspath(scenario)
    name, text, rows = _native.evaluate(policy._native, scenario, pairs(set), seed, episodes, rounds, benchmark_route)
    rates = json.loads(text)
    starts, goals = np.array([row[2] for row in rows]), np.array([row[3] for row in rows])
    columns = {
        "end": np.array([row[0] for row in rows]),
        "steps": np.array([row[1] for row in rows], np.int64),
        "start_x_m": starts[:, 0],
        "start_y_m": starts[:, 1],
        "start_heading_rad": starts[:, 2],
        "goal_x_m": goals[:, 0],
        "goal_y_m": goals[:, 1],
        "layout_seed": np.array([row[4] for row in rows], np.uint64),
    }
    keys = ("success_rate", "collision_rate", "timeout_rate", "mean_time_s", "mean_cost_s", "seed", "rounds")
    return Evaluation(scenario=name, episodes=columns, **{key: rates[key] for key in keys})
