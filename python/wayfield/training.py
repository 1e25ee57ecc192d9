"""Training runs."""

import json
import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from . import _native
from ._frames import read_csv, to_frame
from ._progress import ProgressLine
from ._settings import pairs
from .policy import Policy

#: A function that gets the progress every 0.1 s, and stops the run by returning False.
Callback = Callable[[dict[str, Any]], Any]


@dataclass(frozen=True)
class TrainingResult:
    """A training run. In a notebook it is displayed as its learning curves.

    Attributes:
        folder: The run folder, which the command line and the app read, too.
        summary: The contents of ``summary.json``: ``best_success_rate`` (0 to 1), ``best_mean_time_s``, ``env_steps``, ...
    """

    folder: Path
    summary: dict[str, Any]

    @cached_property
    def policy(self) -> Policy:
        """The best policy by evaluation."""
        return Policy.load(self.folder / "policy.safetensors")

    @cached_property
    def last_policy(self) -> Policy:
        """The policy at the end of the run."""
        return Policy.load(self.folder / "policy-last.safetensors")

    @cached_property
    def episodes(self) -> dict[str, np.ndarray]:
        """The columns of ``episodes.csv``, one value per episode: float64, NaN for an empty field. After training over a set of
        scenarios, the column ``scenario`` has strings."""
        return read_csv(self.folder / "episodes.csv")

    @cached_property
    def evaluations(self) -> dict[str, np.ndarray]:
        """The columns of ``evaluations.csv``, one value per evaluation: float64, NaN for an empty field."""
        return read_csv(self.folder / "evaluations.csv")

    def episodes_frame(self) -> Any:
        """The episodes as a pandas DataFrame."""
        return to_frame(self.episodes)

    def evaluations_frame(self) -> Any:
        """The evaluations as a pandas DataFrame."""
        return to_frame(self.evaluations)

    def draw(self, path: str | os.PathLike[str]) -> None:
        """Draws the learning curves into an SVG, PNG or PDF file, like ``wayfield --draw --run``."""
        _native.draw_run(os.fspath(self.folder), os.fspath(path))

    def _repr_svg_(self) -> str:
        return (self.folder / "learning-curve.svg").read_text(encoding="utf-8")


def train(
    scenario: str | os.PathLike[str] = "scenario-1",
    preset: str | os.PathLike[str] = "fast",
    *,
    set: Mapping[str, Any] | None = None,
    seed: int = 0,
    steps: int | None = None,
    episodes: int | None = None,
    arenas: int | None = None,
    out: str | os.PathLike[str] | None = None,
    init: Policy | str | os.PathLike[str] | None = None,
    epsilon: float | None = None,
    callback: Callback | None = None,
    progress: bool = True,
    checkpoint_every_s: float = 30.0,
) -> TrainingResult:
    """Trains a policy, with the same results as ``wayfield --train``.

    Ctrl-C saves a checkpoint before it raises KeyboardInterrupt; ``wayfield.resume`` continues the run.

    Args:
        scenario: A shipped scenario by name, a file's path, or RON text.
        preset: A shipped training preset by name, a file's path, or RON text.
        set: New values for fields of the preset or the scenario, as with ``--set``: ``{"learning.gamma": 0.97,
            "scenario.lidar.noise_std_m": 0.02}``. A string is RON text; a tuple, a RON tuple.
        seed: The seed of every random number.
        steps: The budget in env steps over all arenas; None for the preset's.
        episodes: The budget in episodes, in place of ``steps``.
        arenas: The number of parallel robots; None for the preset's.
        out: The run folder, a new one; None for ``runs/<scenario>-<preset>-<seed>``, with a number appended if that exists.
        init: A policy whose weights the run starts from (transfer).
        epsilon: With ``init``, the initial probability of a random action, 0 to 1.
        callback: Called every 0.1 s with ``episodes``, ``env_steps``, ``gradient_steps``, ``mean_return``, ``success_rate`` (of
            the last evaluation), and ``epsilon``. The run stops if it returns False.
        progress: Whether to show a progress line on stderr.
        checkpoint_every_s: The interval between checkpoints in s; it does not change what is learned.

    Raises:
        ValueError: The scenario, the preset or an option is invalid, or ``out`` is in use.
        FileNotFoundError: There is no such file.
        RuntimeError: The run failed, for example because learning diverged.
    """
    options, native = training_options(
        scenario,
        preset,
        set=set,
        seed=seed,
        steps=steps,
        episodes=episodes,
        arenas=arenas,
        out=out,
        init=init,
        epsilon=epsilon,
    )
    with ProgressLine(callback, progress) as line:
        folder, summary = _native.train(options, native, line, checkpoint_every_s)
    return TrainingResult(Path(folder), json.loads(summary))


def training_options(
    scenario: str | os.PathLike[str] = "scenario-1",
    preset: str | os.PathLike[str] = "fast",
    *,
    set: Mapping[str, Any] | None = None,
    seed: int = 0,
    steps: int | None = None,
    episodes: int | None = None,
    arenas: int | None = None,
    out: str | os.PathLike[str] | None = None,
    init: Policy | str | os.PathLike[str] | None = None,
    epsilon: float | None = None,
) -> tuple[dict[str, Any], _native.NativePolicy | None]:
    """The options of ``train`` that change its result, for the native module, and the policy to start from."""
    if steps is not None and episodes is not None:
        raise ValueError("both steps and episodes are given; help: give one of them")
    if epsilon is not None and init is None:
        raise ValueError("epsilon is given without init; help: give a policy to start from, too")
    policy = init if isinstance(init, Policy) or init is None else Policy.load(init)
    options = {
        "scenario": os.fspath(scenario),
        "preset": os.fspath(preset),
        "settings": pairs(set),
        "seed": seed,
        "steps": steps,
        "episodes": episodes,
        "arenas": arenas,
        "out": None if out is None else os.fspath(out),
        "epsilon": epsilon,
        "init_from": "a policy in memory" if isinstance(init, Policy) else os.fspath(init or ""),
    }
    return options, None if policy is None else policy._native


def resume(
    folder: str | os.PathLike[str],
    *,
    steps: int | None = None,
    episodes: int | None = None,
    callback: Callback | None = None,
    progress: bool = True,
    checkpoint_every_s: float = 30.0,
) -> TrainingResult:
    """Continues a run exactly where it stopped, like ``wayfield --resume``.

    Args:
        folder: The run folder.
        steps: A larger budget in env steps, counted from the start of the run.
        episodes: A larger budget in episodes, in place of ``steps``.
        callback, progress, checkpoint_every_s: As for ``train``.

    Raises:
        ValueError: The folder holds no run that can be continued, it is in use, or an option is invalid.
        RuntimeError: The run failed, for example because learning diverged.
    """
    if steps is not None and episodes is not None:
        raise ValueError("both steps and episodes are given; help: give one of them")
    with ProgressLine(callback, progress) as line:
        path, summary = _native.resume(os.fspath(folder), steps, episodes, line, checkpoint_every_s)
    return TrainingResult(Path(path), json.loads(summary))


def load_run(folder: str | os.PathLike[str]) -> TrainingResult:
    """The run in ``folder``, finished or stopped.

    Raises:
        FileNotFoundError: The folder has no ``summary.json``.
    """
    folder = Path(folder)
    return TrainingResult(folder, json.loads((folder / "summary.json").read_text(encoding="utf-8")))
