"""Evaluations of policies."""

import json
import os
import warnings
from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from . import _native
from ._frames import columns, to_frame
from ._settings import pairs
from .policy import Policy


@dataclass(frozen=True)
class Evaluation:
    """The results of a policy over episodes: the numbers of ``wayfield --eval --json``.

    Attributes:
        scenario: The scenario's name.
        success_rate, collision_rate, timeout_rate: Shares of the episodes, 0 to 1.
        success_interval, collision_interval, timeout_interval: Their 95 % confidence intervals.
        mean_time_s: The mean simulated time of the successful episodes in s; None without one.
        mean_cost_s: The mean of all, in which a failed episode counts as the whole time limit.
        optimum_mean_time_s, time_ratio: With ``optimum=True``, the mean time of the planner, and the policy's divided by it.
        seed: The seed of starts and goals.
        rounds: The success rate of each round.
        episodes: The columns of ``wayfield --eval --csv`` (docs/command-line.md), one value per episode; NaN if unknown.
    """

    scenario: str
    success_rate: float
    success_interval: tuple[float, float]
    collision_rate: float
    collision_interval: tuple[float, float]
    timeout_rate: float
    timeout_interval: tuple[float, float]
    mean_time_s: float | None
    mean_cost_s: float
    optimum_mean_time_s: float | None
    time_ratio: float | None
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
    optimum: bool = False,
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
        optimum: Also compute the optimal times, which may take seconds per episode in large scenarios.

    Warns:
        UserWarning: The scenario differs from that of the training.

    Raises:
        ValueError: The policy does not fit the scenario, or an option is out of range.
        FileNotFoundError: There is no such file.
    """
    policy = policy if isinstance(policy, Policy) else Policy.load(policy)
    options = {
        "scenario": None if scenario is None else os.fspath(scenario),
        "settings": pairs(set),
        "seed": seed,
        "episodes": episodes,
        "rounds": rounds,
        "benchmark_route": benchmark_route,
        "optimum": optimum,
    }
    report = json.loads(_native.evaluate(policy._native, options))
    warning = report.pop("warning")
    if warning is not None:
        warnings.warn(warning, stacklevel=2)
    records = report.pop("records")
    for record in records:
        del record["policy"]
    report["episodes"] = columns(records)
    report |= {key: tuple(value) for key, value in report.items() if key.endswith("_interval")}
    return Evaluation(**{field.name: report[field.name] for field in fields(Evaluation)})
