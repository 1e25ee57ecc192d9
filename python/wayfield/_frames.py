"""Tables: columns by name, as numpy arrays or as pandas DataFrames."""

import csv
from pathlib import Path
from typing import Any

import numpy as np


def read_csv(path: Path) -> dict[str, np.ndarray]:
    """The columns of a run's CSV file: strings in the column ``scenario``, otherwise float64, NaN for an empty field."""
    with open(path, newline="", encoding="utf-8") as file:
        header, *rows = csv.reader(file)

    def column(name: str, cells: list[str]) -> np.ndarray:
        if name == "scenario":
            return np.array(cells, np.str_)
        return np.array([float(cell) if cell else np.nan for cell in cells], np.float64)

    return {name: column(name, [row[index] for row in rows]) for index, name in enumerate(header)}


def columns(records: list[dict[str, Any]]) -> dict[str, np.ndarray]:
    """The columns of the records of an evaluation; a missing number is NaN, a missing string is empty."""

    def column(key: str, values: list[Any]) -> np.ndarray:
        if key == "layout_seed" and None not in values:
            # Some seeds do not fit into int64. Without a type, numpy would round them all to float64.
            return np.array(values, np.uint64)
        missing = "" if key in ("hit", "hit_shape") else np.nan
        return np.array([missing if value is None else value for value in values])

    return {key: column(key, [record[key] for record in records]) for key in records[0]}


def to_frame(columns: dict[str, np.ndarray]) -> Any:
    """The columns as a pandas DataFrame."""
    try:
        import pandas
    except ImportError as error:
        raise ImportError("pandas is not installed; help: pip install pandas, or use the arrays") from error
    return pandas.DataFrame(columns)
