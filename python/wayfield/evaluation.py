"""Evaluations of policies."""

import json
import os
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any, overload

import numpy as np

from . import _native
from ._frames import columns, to_frame
from ._settings import pairs
from ._spaces import action_array, is_discrete
from .policy import Policy

_PolicyLike = Policy | str | os.PathLike[str]


@dataclass(frozen=True)
class Evaluation:
    """The results of a policy over episodes: the numbers of ``wayfield --eval --json``.

    Attributes:
        weights_crc32c: The checksum of the policy's weights; None for a function.
        scenario: The scenario's name.
        success_rate, collision_rate, timeout_rate: Shares of the episodes, 0 to 1.
        success_interval, collision_interval, timeout_interval: Their 95 % confidence intervals.
        mean_time_s: The mean simulated time of the successful episodes in s; None without one.
        spl: The mean success weighted by path length, 0 to 1.
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
    spl: float
    optimum_mean_time_s: float | None
    time_ratio: float | None
    seed: int
    rounds: list[float]
    episodes: dict[str, np.ndarray]

    def to_json(self) -> str:
        """The results without the columns, as a JSON object: a file for ``wayfield --export --eval-results``."""
        values = {field.name: getattr(self, field.name) for field in fields(self)}
        return json.dumps(values | {"episodes": len(self.episodes["steps"])})

    def to_frame(self) -> Any:
        """The episodes as a pandas DataFrame.

        Raises:
            ImportError: pandas is not installed.
        """
        return to_frame(self.episodes)


@overload
def evaluate(
    policy: _PolicyLike,
    scenario: str | os.PathLike[str] | None = None,
    *,
    set: Mapping[str, Any] | None = None,
    episodes: int = 100,
    rounds: int = 5,
    seed: int = 0,
    benchmark_route: bool = False,
    optimum: bool = False,
    trace: str | os.PathLike[str] | None = None,
) -> Evaluation: ...
@overload
def evaluate(
    policy: list[_PolicyLike] | tuple[_PolicyLike, ...],
    scenario: str | os.PathLike[str] | None = None,
    *,
    set: Mapping[str, Any] | None = None,
    episodes: int = 100,
    rounds: int = 5,
    seed: int = 0,
    benchmark_route: bool = False,
    optimum: bool = False,
    trace: str | os.PathLike[str] | None = None,
) -> list[Evaluation]: ...
def evaluate(
    policy: _PolicyLike | list[_PolicyLike] | tuple[_PolicyLike, ...],
    scenario: str | os.PathLike[str] | None = None,
    *,
    set: Mapping[str, Any] | None = None,
    episodes: int = 100,
    rounds: int = 5,
    seed: int = 0,
    benchmark_route: bool = False,
    optimum: bool = False,
    trace: str | os.PathLike[str] | None = None,
) -> Evaluation | list[Evaluation]:
    """Tests a policy over ``rounds * episodes`` episodes, as ``wayfield --eval``, or several policies in the same episodes.

    Args:
        policy: A policy, its file, or the name of a shipped one; or a list of them.
        scenario: A shipped name, a path or RON text; None for the scenario that the policies were trained in.
        set: Fields of the scenario with other values, as ``--set`` takes them: ``{"scenario.lidar.noise_std_m": 0.02}``.
        episodes: The episodes of a round.
        rounds: The number of rounds.
        seed: The seed of starts and goals. Equal seeds give equal episodes.
        benchmark_route: Drive the scenario's benchmark route in every episode.
        optimum: Also compute the optimal times, which may take seconds per episode in large scenarios.
        trace: A file of JSON lines, with every control step: the file of ``wayfield --eval --trace``. Episodes then run one
            after the other, with the same results.

    Returns:
        The results; for a list of policies, a list in the same order.

    Warns:
        UserWarning: The scenario differs from that of the training.

    Raises:
        ValueError: A policy does not fit the scenario, or an option is out of range.
        FileNotFoundError: There is no such file.
    """
    policies = list(policy) if isinstance(policy, (list, tuple)) else [policy]
    natives, options = evaluation_options(
        policies,
        scenario,
        set=set,
        episodes=episodes,
        rounds=rounds,
        seed=seed,
        benchmark_route=benchmark_route,
        optimum=optimum,
        trace=trace,
    )
    reports = json.loads(_native.evaluate(natives, options))
    results = [evaluation_from(report, stacklevel=3) for report in reports]
    return results if isinstance(policy, (list, tuple)) else results[0]


def evaluate_function(
    act: Callable[[np.ndarray], Any],
    scenario: str | os.PathLike[str] = "scenario-1",
    *,
    observation: str = "scaled",
    actions: str = "discrete",
    set: Mapping[str, Any] | None = None,
    episodes: int = 100,
    rounds: int = 5,
    seed: int = 0,
    benchmark_route: bool = False,
    optimum: bool = False,
) -> Evaluation:
    """Tests a function, such as the policy of another library, in the episodes of ``evaluate`` with the same options.

    Args:
        act: Gets observations, float32, (rows, width), one row per episode that runs at the time, and returns their actions,
            (rows,), or motions, (rows, 2). The rows of episodes that have ended are without meaning.
        scenario: A shipped name, a path or RON text.
        observation: ``"scaled"`` or ``"raw"``, as in ``NavigationEnv``.
        actions: ``"discrete"`` or ``"continuous"``, as in ``NavigationEnv``.
        set, episodes, rounds, seed, benchmark_route, optimum: As for ``evaluate``.

    Raises:
        ValueError: An option or an action is out of range.
        FileNotFoundError: There is no such scenario.
    """
    discrete = is_discrete(actions)

    def native(observations: bytearray, rows: int) -> np.ndarray:
        return action_array(act(np.frombuffer(observations, np.float32).reshape(rows, -1)), rows, discrete)

    options = _options([], scenario, set, episodes, rounds, seed, benchmark_route, optimum, None)
    (report,) = json.loads(_native.evaluate_function(native, observation, not discrete, options))
    return evaluation_from(report, stacklevel=3)


def evaluation_options(
    policies: Sequence[_PolicyLike],
    scenario: str | os.PathLike[str] | None = None,
    *,
    set: Mapping[str, Any] | None = None,
    episodes: int = 100,
    rounds: int = 5,
    seed: int = 0,
    benchmark_route: bool = False,
    optimum: bool = False,
    trace: str | os.PathLike[str] | None = None,
) -> tuple[list[_native.NativePolicy], dict[str, Any]]:
    """The policies and the options of ``evaluate``, for the native module."""
    if not policies:
        raise ValueError("the list of policies is empty; help: give one or more")

    def name(index: int, policy: _PolicyLike) -> str:
        return f"policy {index + 1}" if isinstance(policy, Policy) else os.fspath(policy)

    loaded = [policy if isinstance(policy, Policy) else Policy.load(policy) for policy in policies]
    names = [name(index, policy) for index, policy in enumerate(policies)]
    options = _options(names, scenario, set, episodes, rounds, seed, benchmark_route, optimum, trace)
    return [policy._native for policy in loaded], options


def _options(
    names: list[str],
    scenario: str | os.PathLike[str] | None,
    set: Mapping[str, Any] | None,
    episodes: int,
    rounds: int,
    seed: int,
    benchmark_route: bool,
    optimum: bool,
    trace: str | os.PathLike[str] | None,
) -> dict[str, Any]:
    return {
        "names": names,
        "scenario": None if scenario is None else os.fspath(scenario),
        "settings": pairs(set),
        "seed": seed,
        "episodes": episodes,
        "rounds": rounds,
        "benchmark_route": benchmark_route,
        "optimum": optimum,
        "trace": None if trace is None else os.fspath(trace),
    }


def evaluation_from(report: dict[str, Any], stacklevel: int) -> Evaluation:
    """The results in the native module's report on a policy. Its warning is given to the caller ``stacklevel`` frames up."""
    warning = report.pop("warning")
    if warning is not None:
        warnings.warn(warning, stacklevel=stacklevel + 1)
    records = report.pop("records")
    for record in records:
        del record["policy"]
    report["episodes"] = columns(records)
    report |= {key: tuple(value) for key, value in report.items() if key.endswith("_interval")}
    return Evaluation(**{field.name: report[field.name] for field in fields(Evaluation)})
