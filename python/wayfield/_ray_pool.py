"""Ray as the pool of processes."""

from collections.abc import Callable, Hashable, Sequence
from typing import Any


class RayPool:
    """The nodes of a Ray cluster. The first use connects to the running cluster, or else starts Ray on this machine alone,
    unless the caller has already called ``ray.init``.

    Args:
        cpus: The CPUs that a task needs, at least 1.
        retries: How many times a task is repeated after its node or its process was lost.

    Raises:
        ImportError: Ray is not installed.
        ValueError: ``cpus`` is less than 1, or ``retries`` is negative.
    """

    def __init__(self, cpus: int, retries: int) -> None:
        try:
            import ray
        except ImportError as error:
            raise ImportError("Ray is not installed; help: pip install 'wayfield[cluster]', or pip install ray") from error
        if cpus < 1 or retries < 0:
            raise ValueError(f"cpus={cpus}, retries={retries}; help: give 1 or more cpus, and 0 or more retries")
        self._ray: Any = ray
        self._cpus, self._retries = cpus, retries
        self._names: dict[Hashable, str] = {}

    @property
    def parallel(self) -> int:
        """The number of tasks that the cluster can run at the same time."""
        self._connect()
        return max(1, int(self._ray.cluster_resources().get("CPU", 1)) // self._cpus)

    def submit(self, name: str, work: Callable[..., Any], arguments: tuple[Any, ...]) -> Hashable:
        self._connect()
        # wayfield's own exceptions would only recur; a retry helps only after a lost process or node.
        options = {"name": name, "num_cpus": self._cpus, "max_retries": self._retries, "retry_exceptions": False}
        handle: Hashable = self._ray.remote(_call).options(**options).remote(work, arguments)
        self._names[handle] = name
        return handle

    def _connect(self) -> None:
        if not self._ray.is_initialized():
            self._ray.init()

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
