"""Reproductions, sweeps and sets of evaluations on several machines, with Ray (docs/cluster.md).

Every training run is a task of its own. Its result, the run folder, comes back through Ray, so no shared file system is needed.
It is stored under a name derived from the task's content. Tasks whose results are stored are not run again: after an
interruption, the same call runs only the others. The tasks of a lost node are repeated on another one.
"""

import hashlib
import json
import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path, PurePosixPath
from typing import Any

from . import _native, _work
from ._folders import unpack
from ._ray_pool import RayPool, check_options
from ._settings import pairs
from ._tasks import Pool, Task, replace_file, run_tasks
from .evaluation import Evaluation, evaluation_from, evaluation_options
from .training import TrainingResult, load_run, training_options

__all__ = ["Pool", "RayPool", "Reproduction", "evaluate", "reproduce", "sweep"]


@dataclass(frozen=True)
class Reproduction:
    """A finished report.

    Attributes:
        folder: Its folder.
        report: Its page, ``report.html``.
        runs: The number of training runs.
        wall_s: The wall time in s, summed over all calls that worked on it.
        claims: A dict for each claim, with the keys ``claim``, ``outcome`` and ``because``.
    """

    folder: Path
    report: Path
    runs: int
    wall_s: float
    claims: list[dict[str, str]]


def reproduce(
    *experiments: str | os.PathLike[str],
    only: Iterable[str] = (),
    seeds: int | Sequence[int] | None = None,
    set: Mapping[str, Any] | None = None,
    quick: bool = False,
    out: str | os.PathLike[str] | None = None,
    cpus: int = 1,
    retries: int = 5,
    progress: bool = True,
    pool: Pool | None = None,
) -> Reproduction:
    """Makes the report of ``wayfield --reproduce``, with every training run as a task on the cluster.

    Args:
        experiments: Experiment files; none for the paper's experiments.
        only: Names of figures, tables or experiments; none for all.
        seeds: The number of seeds, or a list of them; None for the experiments' own.
        set: New values for fields of presets and scenarios, as in ``wayfield.train``.
        quick: Whether to make a rough report, with a tenth of the training and tests, and at most two seeds.
        out: The folder of the report; None for that of the command line.
        cpus: The number of CPUs for each task, 1 or more. It changes no result.
        retries: How many times a task is repeated after its node or its process was lost.
        progress: Whether to show the finished tasks on stderr.
        pool: The pool of processes to use instead of Ray's.

    Raises:
        ValueError: An option or a file is invalid, or the folder is in use.
        RuntimeError: A training run failed. Finished runs stay: the same call, made again, trains only the others.
        ImportError: Ray is not installed.
    """
    pool = _pool(pool, cpus, retries)
    report = _native.NativeReport(
        {
            "experiments": [os.fspath(path) for path in experiments],
            "only": list(only),
            "seeds": _seeds(seeds),
            "settings": pairs(set),
            "quick": quick,
            "out": None if out is None else os.fspath(out),
        }
    )
    runs = Path(report.runs)
    run_tasks([_training(record, runs, cpus, {}) for record in json.loads(report.tasks())], pool, progress)
    folder, text = report.finish(pool.parallel)
    fields = json.loads(text)
    return Reproduction(Path(folder), Path(fields["report"]), fields["runs"], fields["wall_s"], fields["claims"])


def sweep(
    runs: Iterable[Mapping[str, Any]],
    out: str | os.PathLike[str],
    *,
    cpus: int = 1,
    retries: int = 5,
    progress: bool = True,
    pool: Pool | None = None,
) -> list[TrainingResult]:
    """Trains with many settings, each as a task on the cluster.

    Args:
        runs: The options of each training run, such as ``{"seed": 3, "set": {"learning.gamma": 0.97}}``: those of
            ``wayfield.train`` that change its result.
        out: The folder for the run folders. They have no checkpoints, so ``wayfield.resume`` cannot continue them.
        cpus, retries, progress, pool: As for ``reproduce``.

    Returns:
        The results in the order of ``runs``.

    Raises:
        ValueError: An option is invalid.
        RuntimeError: A training run failed. Finished runs stay: the same call, made again, trains only the others.
        ImportError: Ray is not installed.
    """
    folder, pool = Path(out), _pool(pool, cpus, retries)
    tasks = []
    for run in runs:
        options, init = training_options(**run)
        inputs = {}
        if init is not None:
            contents = init.to_bytes()
            options["init_from"] = f"init-{_checksum(contents)}/policy.safetensors"
            inputs = {options["init_from"]: contents}
        record = json.loads(_native.training_task(options, init is not None))
        tasks.append(_training(record, folder, cpus, inputs))
    folder.mkdir(parents=True, exist_ok=True)
    run_tasks(tasks, pool, progress)
    return [load_run(folder / task.name) for task in tasks]


def evaluate(
    cases: Iterable[Mapping[str, Any]],
    out: str | os.PathLike[str],
    *,
    cpus: int = 1,
    retries: int = 5,
    progress: bool = True,
    pool: Pool | None = None,
) -> list[Evaluation]:
    """Tests many policies or classical drivers, or one in many scenarios, each as a task on the cluster.

    Args:
        cases: The options of each test, such as ``{"policy": "runs/a/policy.safetensors", "scenario": "hall"}``: those of
            ``wayfield.evaluate`` in one scenario, with one policy or classical driver, without ``trace``.
        out: The folder for the results, a JSON file each.
        cpus, retries, progress, pool: As for ``reproduce``.

    Returns:
        The results in the order of ``cases``.

    Raises:
        ValueError: An option is invalid, or a policy does not fit its scenario.
        RuntimeError: A test failed. Finished tests stay: the same call, made again, tests only the others.
        ImportError: Ray is not installed.
    """
    folder, pool = Path(out), _pool(pool, cpus, retries)
    tasks = [_evaluation(dict(case), folder, cpus) for case in cases]
    folder.mkdir(parents=True, exist_ok=True)
    run_tasks(tasks, pool, progress)
    results = [json.loads((folder / f"{task.name}.json").read_text(encoding="utf-8")) for task in tasks]
    return list(map(evaluation_from, results))


def _pool(pool: Pool | None, cpus: int, retries: int) -> Pool:
    """The given pool, or else Ray's."""
    check_options(cpus, retries)
    return RayPool(cpus, retries) if pool is None else pool


def _seeds(seeds: int | Sequence[int] | None) -> str | None:
    """Seeds as the command line takes them: ``3`` is a number of seeds, ``3,`` a list of one seed."""
    if seeds is None or isinstance(seeds, int):
        return None if seeds is None else str(seeds)
    return ",".join(map(str, seeds)) + ("," if len(seeds) == 1 else "")


def _training(record: dict[str, Any], runs: Path, cpus: int, inputs: dict[str, bytes]) -> Task:
    """The task of a training run whose folder is stored in ``runs``. If it starts from another run, it waits for that run."""
    name, text, origin = record["name"], record["text"], record["starts_from"]
    waits = origin is not None and origin not in inputs

    def arguments() -> tuple[Any, ...]:
        files = {origin: (runs / origin).read_bytes()} if waits else inputs
        return _native.build(), cpus, text, files

    return Task(
        name,
        _work.train,
        arguments,
        is_done=partial(_native.is_task_done, text, os.fspath(runs)),
        store=lambda contents: unpack(contents, runs / name),
        after=PurePosixPath(origin).parts[0] if waits else None,
        cost=record["cost"],
    )


def _evaluation(case: dict[str, Any], folder: Path, cpus: int) -> Task:
    """The task of a test whose result is stored in ``folder``."""
    if "policy" not in case:
        raise ValueError("a case has no policy; help: give the file of a policy, or a classical driver, as its policy")
    if "trace" in case:
        raise ValueError("a case has a trace; help: leave it out, and use wayfield.evaluate for traces")
    (policy,), options = evaluation_options([case.pop("policy")], **case)
    # The scenario's text: its file may change, and need not be on the node.
    options["scenario"] = _native.evaluation_scenario([policy], options)
    options["settings"] = []
    # A classical driver is sent as its text, a policy as its bytes and whether it has a map.
    contents = policy if isinstance(policy, str) else (policy.to_bytes(), policy.with_map)
    identity = json.dumps([_native.build(), {**options, "names": []}], sort_keys=True).encode()
    parts = contents.encode() if isinstance(contents, str) else contents[0] + b"+map" * contents[1]
    name = f"evaluation-{_checksum(identity + parts)}"
    path = folder / f"{name}.json"

    def store(text: str) -> None:
        (report,) = json.loads(text)
        replace_file(path, json.dumps(report).encode())

    arguments = (_native.build(), cpus, contents, options)
    return Task(name, _work.evaluate, lambda: arguments, path.exists, store, cost=float(options["episodes"]))


def _checksum(contents: bytes) -> str:
    return hashlib.sha256(contents).hexdigest()[:16]
