"""Evaluations of policies and classical drivers."""

import json
import os
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any, TypedDict, Unpack, overload

import numpy as np

from . import _native, suites
from ._frames import columns, to_frame
from ._settings import pairs
from .policy import Policy
from .suites import SuiteEvaluation

_PolicyLike = Policy | str | os.PathLike[str]


@dataclass(frozen=True)
class Evaluation:
    """The results of a policy, a classical driver or a function over episodes: the numbers of ``wayfield --eval --json``.

    Attributes:
        driver_class: What the policy, driver or function may perceive (docs/drivers.md): "A" (all policies without a map),
            "B" or "C".
        weights_crc32c: The checksum of the policy's weights; None for a classical driver or a function.
        scenario: The scenario's name.
        success_rate, collision_rate, timeout_rate: Fractions of the episodes, 0 to 1.
        success_interval, collision_interval, timeout_interval: Their 95 % confidence intervals.
        mean_time_s: The mean simulated time of the successful episodes in s; None without one.
        spl: The mean success weighted by path length (docs/command-line.md), 0 to 1.
        mean_cost_s: The mean time of all episodes in s, where a failed one counts as the whole time limit.
        optimum_mean_time_s, time_ratio: With ``optimum=True``, the planner's mean time in s, and the policy's divided by it,
            over the successful episodes in which the planner found a path; None without one.
        seed: The seed of starts and goals.
        rounds: The success rate of each round.
        episodes: The columns of ``wayfield --eval --csv`` (docs/command-line.md), one value per episode. A missing number is
            NaN, a missing string is empty.
    """

    driver_class: str
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


class EvaluationOptions(TypedDict, total=False):
    """The options of ``evaluate`` in one scenario. Its docstring describes them."""

    set: Mapping[str, Any] | None
    episodes: int | None
    rounds: int | None
    seed: int
    benchmark_route: bool
    optimum: bool
    trace: str | os.PathLike[str] | None


@overload
def evaluate(
    policy: _PolicyLike,
    *,
    suite: str | os.PathLike[str],
    set: Mapping[str, Any] | None = None,
    episodes: int | None = None,
    seed: int = 0,
    optimum: bool = False,
) -> SuiteEvaluation: ...
@overload
def evaluate(
    policy: list[_PolicyLike] | tuple[_PolicyLike, ...],
    *,
    suite: str | os.PathLike[str],
    set: Mapping[str, Any] | None = None,
    episodes: int | None = None,
    seed: int = 0,
    optimum: bool = False,
) -> list[SuiteEvaluation]: ...
@overload
def evaluate(
    policy: _PolicyLike, scenario: str | os.PathLike[str] | None = None, **options: Unpack[EvaluationOptions]
) -> Evaluation: ...
@overload
def evaluate(
    policy: list[_PolicyLike] | tuple[_PolicyLike, ...],
    scenario: str | os.PathLike[str] | None = None,
    **options: Unpack[EvaluationOptions],
) -> list[Evaluation]: ...
def evaluate(
    policy: _PolicyLike | list[_PolicyLike] | tuple[_PolicyLike, ...],
    scenario: str | os.PathLike[str] | None = None,
    *,
    suite: str | os.PathLike[str] | None = None,
    set: Mapping[str, Any] | None = None,
    episodes: int | None = None,
    rounds: int | None = None,
    seed: int = 0,
    benchmark_route: bool = False,
    optimum: bool = False,
    trace: str | os.PathLike[str] | None = None,
) -> Evaluation | list[Evaluation] | SuiteEvaluation | list[SuiteEvaluation]:
    """Tests a policy or a classical driver over ``rounds * episodes`` episodes, like ``wayfield --eval``. All policies and
    drivers in a list are tested in the same episodes.

    Args:
        policy: A policy, its file, or the name of a shipped one; with ``+map`` after the file or name, the policy builds a map
            as it drives. Or a classical driver: its name, such as ``"dwa"``, its RON file or its RON text. Or a list of these.
            See docs/drivers.md.
        scenario: A shipped name, a path or RON text; None for the scenario that the policies were trained in, or Scenario I if
            there are only classical drivers.
        suite: In place of ``scenario``, many scenarios with results by family: the file of a suite or ``"shipped"`` or
            ``"validation"``, a folder of scenarios, a set of scenarios, or a level generator (docs/suites.md). ``episodes`` is
            then the number in each scenario; ``rounds``, ``benchmark_route`` and ``trace`` can't be used.
        set: New values for fields of the scenario, as with ``--set``: ``{"scenario.lidar.noise_std_m": 0.02}``.
        episodes: The episodes of a round; 100 if None, or in a suite the number that the suite sets.
        rounds: The number of rounds; 5 if None.
        seed: The seed of starts and goals. Equal seeds give equal episodes.
        benchmark_route: Drive the scenario's benchmark route in every episode.
        optimum: Also compute the optimal times, which may take seconds per episode in large scenarios.
        trace: A file to which every control step is written, as JSON lines: the file of ``wayfield --eval --trace``. Episodes
            then run one after the other, with the same results.

    Returns:
        The results; with ``suite``, those of its families; for a list of policies, a list in the same order.

    Warns:
        UserWarning: The scenario differs from the one used in training.

    Raises:
        ValueError: A policy does not fit the scenario, or an option or a driver's parameter is out of range.
        FileNotFoundError: There is no such file.
    """
    policies = list(policy) if isinstance(policy, (list, tuple)) else [policy]
    if suite is not None:
        if (scenario, rounds, benchmark_route, trace) != (None, None, False, None):
            raise ValueError("scenario, rounds, benchmark_route and trace can't be used with suite; help: leave them out")
        natives, options = evaluation_options(policies)
        names = options["names"]
        found = suites.evaluations(natives, names, suite, set=set, episodes=episodes, seed=seed, optimum=optimum)
        return found if isinstance(policy, (list, tuple)) else found[0]
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
    results = list(map(evaluation_from, reports))
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
        act: Gets observations, float32, (rows, width), one row per parallel episode, and returns their actions, (rows,), or
            motions, (rows, 2). The rows of episodes that have ended are meaningless.
        scenario: A shipped name, a path or RON text.
        observation: ``"scaled"`` or ``"raw"``, as in ``NavigationEnv``.
        actions: ``"discrete"`` or ``"continuous"``, as in ``NavigationEnv``.
        set, episodes, rounds, seed, benchmark_route, optimum: As for ``evaluate``.

    Raises:
        ValueError: An option or an action is out of range.
        FileNotFoundError: There is no such scenario.
    """
    options = _options(
        [],
        scenario,
        set=set,
        episodes=episodes,
        rounds=rounds,
        seed=seed,
        benchmark_route=benchmark_route,
        optimum=optimum,
    )
    (report,) = json.loads(_native.evaluate_function(act, observation, actions, options))
    return evaluation_from(report)


def evaluation_options(
    policies: Sequence[_PolicyLike], scenario: str | os.PathLike[str] | None = None, **options: Unpack[EvaluationOptions]
) -> tuple[list[_native.NativePolicy | str], dict[str, Any]]:
    """The policies and drivers to test, and the options of ``evaluate``, as the native module takes them."""
    if not policies:
        raise ValueError("the list of policies is empty; help: give one or more")

    def name(index: int, policy: _PolicyLike) -> str:
        return f"policy {index + 1}" if isinstance(policy, Policy) else os.fspath(policy)

    def load(policy: _PolicyLike) -> _native.NativePolicy | str:
        return policy._native if isinstance(policy, Policy) else _native.load_tested(os.fspath(policy))

    loaded = list(map(load, policies))
    names = [name(index, policy) for index, policy in enumerate(policies)]
    return loaded, _options(names, scenario, **options)


def _options(
    names: list[str],
    scenario: str | os.PathLike[str] | None,
    *,
    set: Mapping[str, Any] | None = None,
    episodes: int | None = None,
    rounds: int | None = None,
    seed: int = 0,
    benchmark_route: bool = False,
    optimum: bool = False,
    trace: str | os.PathLike[str] | None = None,
) -> dict[str, Any]:
    """The options for the native module."""
    return {
        "names": names,
        "scenario": None if scenario is None else os.fspath(scenario),
        "settings": pairs(set),
        "seed": seed,
        "episodes": 100 if episodes is None else episodes,
        "rounds": 5 if rounds is None else rounds,
        "benchmark_route": benchmark_route,
        "optimum": optimum,
        "trace": None if trace is None else os.fspath(trace),
    }


def evaluation_from(report: dict[str, Any]) -> Evaluation:
    """The results in the native module's report on a policy. The report's warning, if any, points to the caller of this
    function's caller: the user's line."""
    warning = report.pop("warning")
    if warning is not None:
        warnings.warn(warning, stacklevel=3)
    records = report.pop("records")
    for record in records:
        del record["policy"]
    report["episodes"] = columns(records)
    report |= {key: tuple(value) for key, value in report.items() if key.endswith("_interval")}
    return Evaluation(**{field.name: report[field.name] for field in fields(Evaluation)})
