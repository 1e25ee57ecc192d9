"""Imports of maps and worlds."""

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from . import _native
from ._settings import pairs


@dataclass(frozen=True)
class ImportedScenario:
    """A scenario that was imported.

    Attributes:
        text: The scenario as RON text, which every ``scenario`` argument takes.
        deviation_m: The largest distance in m of a wall from the cells of the map that it represents.
        path_length_m: The length in m of a shortest path from start to goal, if the source states it, as BARN does.
        findings: What was left out or changed, one line per kind.
    """

    text: str
    deviation_m: float
    path_length_m: float | None
    findings: list[str]


def import_scenario(
    path: str | os.PathLike[str],
    *,
    resolution: float | None = None,
    tolerance: float | None = None,
    specks: int = 0,
    lidar_height: float = 0.18,
    models: Sequence[str | os.PathLike[str]] = (),
    world: int | None = None,
    robot: str | os.PathLike[str] | None = None,
    set: Mapping[str, Any] | None = None,
) -> ImportedScenario:
    """Makes a scenario from a ROS map, an image, a Gazebo world, a world of the BARN dataset, or a stage of turtlebot3_drlnav,
    like ``wayfield --import`` (docs/import.md).

    Args:
        path: The file: .yaml, .png, .pgm, .world, .sdf or .json.
        resolution: The side of a pixel of a plain image, in m.
        tolerance: How far the walls may be from the cells of a map, in m; by default the side of a cell plus 0.01.
        specks: Connected groups of up to this many occupied or unknown cells of a map become free.
        lidar_height: The height, in m, at which the shapes of an SDF world are cut.
        models: Folders with the models that an SDF world includes.
        world: The number of the world or stage in a .json file.
        robot: A scenario whose robot, LIDAR and rules are used; None for those of Scenario I or, in BARN worlds and stages,
            their own (docs/import.md).
        set: New values for fields of that scenario, as in ``train``.

    Raises:
        FileNotFoundError: There is no such file.
        ValueError: The file or an option is invalid.
    """
    options = {
        "resolution_m": resolution,
        "tolerance_m": tolerance,
        "speck_cells": specks,
        "lidar_height_m": lidar_height,
        "models": [os.fspath(folder) for folder in models],
        "world": world,
        "robot": None if robot is None else os.fspath(robot),
        "settings": pairs(set),
    }
    return ImportedScenario(*_native.import_scenario(os.fspath(path), options))
