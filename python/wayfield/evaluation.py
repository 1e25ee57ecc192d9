"""Evaluations of policies."""

import json
import os
import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from . import _native
from ._frames import columns, to_frame
from ._settings import pairs
from ._spaces import action_array, is_discrete
from .policy import Policy


@dataclass(frozen=True)
class Evaluation:
    """The results of a policy over episodes: the numbers of ``wayfield --eval --json``.

    Attributes:
        weights_crc32c: The checksum of the policy's weights; None for a function.
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

    weights_crc32c: str | None
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

    def to_json(self) -> str:
        """The results without the columns, as a JSON object: a file of ``--eval-results``."""
        values = {field.name: getattr(self, field.name) for field in fields(self)}
        return json.dumps(values | {"episodes": len(self.episodes["steps"])})

    def to_frame(self) -> Any:
        """The episodes as a pandas DataFrame.

        Raises:
            ImportError: pandas is not installed.
        """
        return to_frame(self.episodes)


def evaluate(
    policy: Policy | str | os.PathLike[str] | Callable[[np.ndarray], Any],
    scenario: str | os.PathLike[str] | None = None,
    *,
    observation: str | None = None,
    actions: str | None = None,
    set: Mapping[str, Any] | None = None,
    episodes: int = 100,
    rounds: int = 5,
    seed: int = 0,
    benchmark_route: bool = False,
    optimum: bool = False,
) -> Evaluation:
    """Tests a policy over ``rounds * episodes`` episodes, as ``wayfield --eval``.

    Args:
        policy: A policy, its file, or the name of a shipped one. Or a function, for example of another library's policy: it
            gets observations, (rows, width), and returns their actions, (rows,), or motions, (rows, 2).
        scenario: A shipped name, a path or RON text; None for the scenario that the policy was trained in, or for a function
            Scenario I.
        observation: For a function, ``"scaled"`` (the default) or ``"raw"``.
        actions: For a function, ``"discrete"`` (the default) or ``"continuous"``.
        set: Fields of the scenario with other values, as ``--set`` takes them: ``{"scenario.lidar.noise_std_m": 0.02}``.
        episodes: The episodes of a round.
        rounds: The number of rounds.
        seed: The seed of starts and goals. Equal seeds give equal episodes.
        benchmark_route: Drive the scenario's benchmark route in every episode.
        optimum: Also compute the optimal times, which may take seconds per episode in large scenarios.

    Warns:
        UserWarning: The scenario differs from that of the training.

    Raises:
        ValueError: The policy does not fit the scenario, or an option or an action is out of range.
        FileNotFoundError: There is no such file.
    """
    options = {
        "scenario": None if scenario is None else os.fspath(scenario),
        "settings": pairs(set),
        "seed": seed,
        "episodes": episodes,
        "rounds": rounds,
        "benchmark_route": benchmark_route,
        "optimum": optimum,
    }
    report = json.loads(_report(policy, observation, actions, options))
    warning = report.pop("warning")
    if warning is not None:
        warnings.warn(warning, stacklevel=2)
    records = report.pop("records")
    for record in records:
        del record["policy"]
    report["episodes"] = columns(records)
    report |= {key: tuple(value) for key, value in report.items() if key.endswith("_interval")}
    return Evaluation(**{field.name: report[field.name] for field in fields(Evaluation)})


def _report(
    policy: Policy | str | os.PathLike[str] | Callable[[np.ndarray], Any],
    observation: str | None,
    actions: str | None,
    options: dict[str, Any],
) -> str:
    if isinstance(policy, Policy | str | os.PathLike):
        if observation is not None or actions is not None:
            raise ValueError("observation and actions are for functions, but a policy is given; help: leave them out")
        policy = policy if isinstance(policy, Policy) else Policy.load(policy)
        return _native.evaluate(policy._native, options)
    discrete = is_discrete(actions or "discrete")

    def act(observations: bytearray, count: int) -> np.ndarray:
        return action_array(policy(np.frombuffer(observations, np.float32).reshape(count, -1)), count, discrete)

    return _native.evaluate_function(act, observation or "scaled", not discrete, options)
