"""Ray as the pool of processes."""

import warnings
from collections.abc import Callable, Hashable, Sequence
from typing import Any


def check_options(cpus: int, retries: int) -> None:
    """Checks the options that the functions of ``wayfield.cluster`` have in common.

    Raises:
        ValueError: ``cpus`` is less than 1, or ``retries`` is negative.
    """
    if cpus < 1 or retries < 0:
        raise ValueError(f"cpus={cpus}, retries={retries}; help: give 1 or more cpus, and 0 or more retries")


class RayPool:
    """The nodes of a Ray cluster. The first use connects to the running cluster, or else starts Ray on this machine alone,
    unless the caller has already called ``ray.init``.

    Args:
        cpus: The CPUs that a task needs, at least 1.
        retries: How many times a task is repeated after its node or its process was lost.

    Warns:
        UserWarning: No node has as many CPUs as a task needs.

    Raises:
        ImportError: Ray is not installed.
        ValueError: ``cpus`` is less than 1, or ``retries`` is negative.
    """

    def __init__(self, cpus: int, retries: int) -> None:
        check_options(cpus, retries)
        try:
            import ray
        except ImportError as error:
            raise ImportError("Ray is not installed; help: pip install 'wayfield[cluster]', or pip install ray") from error
        self._ray: Any = ray
        self._cpus, self._retries = cpus, retries
        self._names: dict[Hashable, str] = {}
        self._is_checked = False

    @property
    def parallel(self) -> int:
        """The number of tasks that the cluster can run at the same time."""
        self._connect()
        return max(1, int(self._ray.cluster_resources().get("CPU", 1)) // self._cpus)

    def submit(self, name: str, work: Callable[..., Any], arguments: tuple[Any, ...]) -> Hashable:
        self._connect()
        if not self._is_checked:
            self._is_checked = True
            self._warn_of_waiting()
        # wayfield's own exceptions would only recur; a retry helps only after a lost process or node.
        options = {"name": name, "num_cpus": self._cpus, "max_retries": self._retries, "retry_exceptions": False}
        handle: Hashable = self._ray.remote(_call).options(**options).remote(work, arguments)
        self._names[handle] = name
        return handle

    def _connect(self) -> None:
        if not self._ray.is_initialized():
            self._ray.init()

    def _warn_of_waiting(self) -> None:
        """Warns if no node can run a task. It is not an error, because a cluster may start larger nodes on demand."""
        nodes = [node["Resources"].get("CPU", 0) for node in self._ray.nodes() if node["Alive"]]
        largest = int(max(nodes, default=0))
        if largest < self._cpus:
            warnings.warn(
                f"a task needs {self._cpus} CPUs, but the largest node of the cluster has {largest}: the tasks wait until a "
                f"larger node joins; help: give cpus={max(1, largest)}",
                # The user's line: the caller of wayfield.cluster, run_tasks, submit and this function.
                stacklevel=5,
            )

    def wait(self, handles: Sequence[Hashable]) -> tuple[Hashable, Any, str]:
        (handle,), _ = self._ray.wait(list(handles), num_returns=1)
        name = self._names.pop(handle)
        exceptions = self._ray.exceptions
        try:
            node, result = self._ray.get(handle)
        except exceptions.RayTaskError as error:
            raise RuntimeError(f"{name}: {error.cause}") from error
        except exceptions.RayError as error:
            reason = f"{type(error).__name__}: {(str(error).splitlines() or [''])[0]}"
            if isinstance(error, (exceptions.WorkerCrashedError, exceptions.NodeDiedError)):
                reason = f"its process or node was lost more than {self._retries} times ({reason})"
            raise RuntimeError(f"{name}: {reason}; help: make the same call again; finished work is kept") from error
        return handle, result, f"node {node[:8]}"

    def cancel(self, handles: Sequence[Hashable]) -> None:
        for handle in handles:
            self._ray.cancel(handle, force=True)


def _call(work: Callable[..., Any], arguments: tuple[Any, ...]) -> tuple[str, Any]:
    """Runs on a node. Returns the node's id, and the result of the work."""
    import ray

    return ray.get_runtime_context().get_node_id(), work(*arguments)
