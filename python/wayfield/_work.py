"""The work that the processes of a cluster do. It needs no files except the installed package, and leaves none behind."""

import os
import tempfile
from pathlib import Path
from typing import Any

from . import _native
from ._folders import pack


def train(build: str, cpus: int, text: str, inputs: dict[str, bytes]) -> bytes:
    """Carries out a training task. Returns the run folder as an archive.

    Args:
        build: The build of wayfield that made the task.
        cpus: The number of threads for matrix products.
        text: The task, as text.
        inputs: The files that the training run starts from, by their paths relative to the folder of all runs.
    """
    _check_build(build)
    os.environ.setdefault("RAYON_NUM_THREADS", str(cpus))
    with tempfile.TemporaryDirectory(prefix="wayfield-") as folder:
        runs = Path(folder)
        for path, contents in inputs.items():
            (runs / path).parent.mkdir(parents=True, exist_ok=True)
            (runs / path).write_bytes(contents)
        return pack(runs / _native.run_task(text, folder))


def evaluate(build: str, cpus: int, policy: tuple[bytes, bool] | str, options: dict[str, Any]) -> str:
    """Tests ``policy``: the bytes of a policy and whether it drives with a map, or the RON text of a classical driver. Returns a
    list of one report, as JSON."""
    _check_build(build)
    os.environ.setdefault("RAYON_NUM_THREADS", str(cpus))
    tested = policy if isinstance(policy, str) else _native.NativePolicy.from_bytes(*policy)
    return _native.evaluate([tested], options)


def _check_build(build: str) -> None:
    if build != _native.build():
        raise RuntimeError(
            f"this node has wayfield {_native.build()}, but the task comes from {build}; "
            "help: install the same wheel on every node"
        )
