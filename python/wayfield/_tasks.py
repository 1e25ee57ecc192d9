"""Tasks for a cluster: finished tasks are not repeated, and a task can wait for another one."""

import os
import sys
from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass
from typing import Any, Protocol


@dataclass(frozen=True)
class Task:
    """A piece of work for another process.

    Attributes:
        name: Its name; tasks with the same name do the same work.
        work: The function that a process of the cluster calls. It needs nothing but its arguments.
        arguments: Makes the arguments; called when the task can start.
        is_done: Whether the result is stored already.
        store: Stores the result.
        after: The name of the task that this one waits for; None if it can start at once.
        cost: The expected time, in any unit: long tasks start first.
    """

    name: str
    work: Callable[..., Any]
    arguments: Callable[[], tuple[Any, ...]]
    is_done: Callable[[], bool]
    store: Callable[[Any], None]
    after: str | None = None
    cost: float = 1.0


class Pool(Protocol):
    """Processes that carry out tasks. ``RayPool`` is one."""

    @property
    def parallel(self) -> int:
        """The number of tasks that can run at the same time."""

    def submit(self, name: str, work: Callable[..., Any], arguments: tuple[Any, ...]) -> Hashable:
        """Starts a task, or puts it into a queue. Returns a handle."""

    def wait(self, handles: Sequence[Hashable]) -> tuple[Hashable, Any, str]:
        """Waits until one of the tasks has finished. Returns its handle, its result, and where it ran.

        Raises:
            RuntimeError: The task failed.
        """

    def cancel(self, handles: Sequence[Hashable]) -> None:
        """Stops tasks whose results are not needed any more."""


def run_tasks(tasks: Sequence[Task], pool: Pool, progress: bool) -> None:
    """Carries out all tasks whose results are not stored yet, and stores each result as soon as it arrives.

    Raises:
        RuntimeError: A task failed. The others are stopped; results that were stored before stay.
    """
    unique = list({task.name: task for task in tasks}.values())
    waiting = sorted((task for task in unique if not task.is_done()), key=lambda task: -task.cost)
    unfinished = {task.name for task in waiting}
    running: dict[Hashable, Task] = {}
    done = len(unique) - len(waiting)
    if done:
        _show(progress, f"{done} of {len(unique)} are done already")
    try:
        while waiting or running:
            for task in [task for task in waiting if task.after not in unfinished]:
                waiting.remove(task)
                running[pool.submit(task.name, task.work, task.arguments())] = task
            handle, result, where = pool.wait(list(running))
            task = running.pop(handle)
            task.store(result)
            unfinished.remove(task.name)
            done += 1
            _show(progress, f"{done} of {len(unique)} done: {task.name}, on {where}")
    finally:
        pool.cancel(list(running))


def replace_file(path: str | os.PathLike[str], contents: bytes) -> None:
    """Writes a file atomically: an interruption leaves no incomplete file at ``path``."""
    temporary = f"{os.fspath(path)}.tmp"
    with open(temporary, "wb") as file:
        file.write(contents)
    os.replace(temporary, path)


def _show(progress: bool, text: str) -> None:
    if progress and sys.stderr is not None:
        print(text, file=sys.stderr, flush=True)
