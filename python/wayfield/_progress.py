"""The progress line of a training run."""

import sys
import time
from collections.abc import Callable
from typing import Any

#: The seconds between two lines if stderr is neither a terminal nor a notebook.
_PLAIN_INTERVAL_S = 10.0


class ProgressLine:
    """Calls the user's callback, and shows the progress on stderr: one line that is rewritten, or a new line every ten seconds if
    stderr is neither a terminal nor a notebook."""

    def __init__(self, callback: Callable[[dict[str, Any]], Any] | None, show: bool) -> None:
        self._callback = callback
        self._show = show
        # A notebook's stderr understands the carriage return, too.
        self._rewrites = sys.stderr is not None and (sys.stderr.isatty() or "ipykernel" in sys.modules)
        self._due = time.monotonic() + (0.0 if self._rewrites else _PLAIN_INTERVAL_S)
        self._written = False

    def __call__(self, progress: dict[str, Any]) -> Any:
        if self._show and sys.stderr is not None and time.monotonic() >= self._due:
            self._write(progress)
        return None if self._callback is None else self._callback(progress)

    def _write(self, progress: dict[str, Any]) -> None:
        rate, mean = progress["success_rate"], progress["mean_return"]
        success = "-" if rate is None else f"{100 * rate:.1f} %"
        text = f"{progress['env_steps']} env steps, {progress['episodes']} episodes, success {success}"
        text += "" if mean is None else f", return {mean:.1f}"
        if self._rewrites:
            print(f"\r{text:<79}", end="", file=sys.stderr, flush=True)
        else:
            print(text, file=sys.stderr, flush=True)
            self._due = time.monotonic() + _PLAIN_INTERVAL_S
        self._written = True

    def __enter__(self) -> "ProgressLine":
        return self

    def __exit__(self, *_: object) -> None:
        if self._written and self._rewrites:
            print(file=sys.stderr)
