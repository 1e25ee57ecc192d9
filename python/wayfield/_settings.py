"""Settings: values for fields of presets and scenarios, as text."""

from collections.abc import Mapping
from typing import Any


def pairs(settings: Mapping[str, Any] | None) -> list[tuple[str, str]]:
    """The paths and the values as RON text, for the native module."""
    return [(path, _ron(value)) for path, value in (settings or {}).items()]


def _ron(value: Any) -> str:
    if isinstance(value, str):
        return value
    # NumPy's booleans are not `bool`s. Its numbers need no conversion.
    if isinstance(value, bool) or getattr(value, "dtype", None) == "bool":
        return "true" if value else "false"
    if isinstance(value, tuple):
        return "(" + ", ".join(map(_ron, value)) + ")"
    if isinstance(value, list):
        return "[" + ", ".join(map(_ron, value)) + "]"
    return str(value)
