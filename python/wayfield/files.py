"""Shipped files, checks of files, and drawings."""

import json
import os
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from . import _native
from ._settings import pairs


def scenarios() -> dict[str, str]:
    """The shipped scenarios: name and description."""
    return dict(_native.scenarios())


def presets() -> dict[str, str]:
    """The shipped training presets: name and description."""
    return dict(_native.presets())


def scenario_text(name: str) -> str:
    """The RON text of a shipped scenario, to change and pass on.

    Raises:
        ValueError: There is no such scenario.
    """
    text = _native.scenario_text(name)
    if text is None:
        raise ValueError(f"{name!r} is not a shipped scenario; help: give one of {', '.join(scenarios())}")
    return text


@dataclass(frozen=True)
class Problem:
    """A problem in a file, or a questionable setting.

    Attributes:
        level: "error", "warning" or "note".
        path: The file.
        line, column: The position, from 1; None if it has none.
        message: What is wrong, and the fix.
    """

    level: str
    path: str
    line: int | None
    column: int | None
    message: str

    def __str__(self) -> str:
        position = "" if self.line is None else f"{self.line}:{self.column}:"
        return f"{self.path}:{position} {self.level}: {self.message}"


def check(*paths: str | os.PathLike[str]) -> list[Problem]:
    """Checks scenarios, sets of scenarios, level generators, suites, drivers, presets, experiments, run configurations and
    policies, like ``wayfield --check``.

    Args:
        paths: Files, and folders of RON files.

    Returns:
        All problems and questionable settings; an empty list for valid files.
    """
    report = json.loads(_native.check([os.fspath(path) for path in paths]))
    fields = ("path", "line", "column", "message")
    found = [("error", problem) for problem in report["problems"]]
    found += [(note["level"], note) for note in report["notes"]]
    return [Problem(level, *(problem[field] for field in fields)) for level, problem in found]


def draw(
    scenario: str | os.PathLike[str],
    path: str | os.PathLike[str],
    *,
    set: Mapping[str, Any] | None = None,
    plain: bool = False,
    levels: int | None = None,
    seed: int | None = None,
    over: str | os.PathLike[str] | None = None,
    resolution: float | None = None,
    size: tuple[int, int] | None = None,
) -> None:
    """Draws a scenario, levels of a generator, or a set from above into an SVG, PNG or PDF file, like ``wayfield --draw``.

    Args:
        scenario: A shipped scenario or level generator by name, the path of a file, or RON text; also a set.
        path: The file; its extension decides the format.
        set: New values for fields of the scenario, as in ``train``.
        plain: Without the name, the legend and the axes.
        levels: The number of levels of a level generator, 1 to 100; None for 12.
        seed: The seed of the first of them; None for 0.
        over: A map from which the scenario was imported, whose occupied cells are marked.
        resolution: The side of a pixel in m, if that map is a plain image.
        size: Width and height in pixels (96 per inch in PDF); None for the figure's own
            (in PNG four times that, unless ``plain``).

    Raises:
        FileNotFoundError: There is no such scenario.
        ValueError: The scenario or an option is invalid, or the map cannot be read.
        RuntimeError: The figure cannot be made or written.
    """
    options = {
        "settings": pairs(set),
        "is_plain": plain,
        "levels": levels,
        "seed": seed,
        "over": None if over is None else os.fspath(over),
        "resolution_m": resolution,
        "size": None if size is None else "x".join(map(str, size)),
    }
    _native.draw(os.fspath(scenario), os.fspath(path), options)
