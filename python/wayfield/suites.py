"""Evaluations in many scenarios: suites."""

import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any

from . import _native
from ._settings import pairs


@dataclass(frozen=True)
class FamilyEvaluation:
    """The results in a family of a suite: the numbers of ``wayfield --eval --suite --json``, which docs/suites.md explains.

    Attributes:
        scenarios, episodes: The number of scenarios, and of the episodes in all of them.
        success_rate, collision_rate, timeout_rate: Fractions of the episodes, 0 to 1.
        success_interval, collision_interval, timeout_interval: Their 95 % confidence intervals.
        rounds: Success rates: over the first episode of each scenario, over the second of each, and so on.
        mean_time_s: The mean simulated time of the successful episodes in s; None without one.
        spl: The mean success weighted by path length, 0 to 1.
        worst_tenth: The mean success rate in the tenth of the scenarios where it is lowest, 0 to 1.
        barn_score: The mean score of the BARN Challenge, 0 to 0.5; None if the family has none.
        optimum_episodes: With ``optimum=True``, the number of successful episodes in which the planner found a path; else 0.
        time_ratio: With ``optimum=True``, the total time of these episodes divided by that of the planner's paths; else None.
    """

    scenarios: int
    episodes: int
    success_rate: float
    success_interval: tuple[float, float]
    collision_rate: float
    collision_interval: tuple[float, float]
    timeout_rate: float
    timeout_interval: tuple[float, float]
    rounds: list[float]
    mean_time_s: float | None
    spl: float
    worst_tenth: float
    barn_score: float | None
    optimum_episodes: int
    time_ratio: float | None


@dataclass(frozen=True)
class SuiteEvaluation:
    """The results of a policy or a classical driver in a suite.

    Attributes:
        suite: The suite's name.
        driver_class: What it may perceive, ``"A"``, ``"B"`` or ``"C"`` (docs/drivers.md). Policies without a map have class A.
        seed: The seed of starts and goals.
        families: The results by the families' names, in the order of the suite.
    """

    suite: str
    driver_class: str
    seed: int
    families: dict[str, FamilyEvaluation]


def evaluations(
    drivers: Sequence[_native.NativePolicy | str],
    names: list[str],
    suite: str | os.PathLike[str],
    *,
    set: Mapping[str, Any] | None,
    episodes: int | None,
    seed: int,
    optimum: bool,
) -> list[SuiteEvaluation]:
    """The results of each of ``drivers``, which are called ``names``."""
    options = {
        "names": names,
        "suite": os.fspath(suite),
        "settings": pairs(set),
        "seed": seed,
        "episodes": episodes,
        "optimum": optimum,
    }
    report = json.loads(_native.evaluate_suite(drivers, options))

    def evaluation(driver_class: str, results: list[tuple[str, dict[str, Any]]]) -> SuiteEvaluation:
        families = {name: _family(result) for name, result in results}
        return SuiteEvaluation(report["suite"], driver_class, seed, families)

    return list(map(evaluation, report["classes"], report["results"]))


def _family(result: dict[str, Any]) -> FamilyEvaluation:
    result |= {key: tuple(value) for key, value in result.items() if key.endswith("_interval")}
    values: dict[str, Any] = {field.name: result.get(field.name) for field in fields(FamilyEvaluation)}
    return FamilyEvaluation(**values)
