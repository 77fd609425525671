"""Conversion of readings and overrides to the input of the program."""

from __future__ import annotations

import csv
import io
import json
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Protocol, runtime_checkable


@runtime_checkable
class _Pandas(Protocol):
    def to_csv(self, *, index: bool) -> str: ...


@runtime_checkable
class _Polars(Protocol):
    def write_csv(self) -> str: ...


OneTable = str | os.PathLike[str] | Mapping[str, Sequence[Any]] | _Pandas | _Polars
Readings = OneTable | list[OneTable]
"""A data frame, a dict of columns, the path of a table, or a list of these."""


def csv_of(readings: Any) -> tuple[list[str], dict[str, bytes]]:
    """Return names of tables, and the content of those that are not files on disk."""
    tables = readings if isinstance(readings, list) else [readings]
    names: list[str] = []
    files: dict[str, bytes] = {}
    for number, table in enumerate(tables, 1):
        if isinstance(table, (str, os.PathLike)):
            names.append(str(Path(table)))
            continue
        name = "readings.csv" if len(tables) == 1 else f"readings_{number}.csv"
        names.append(name)
        files[name] = _text(table).encode()
    return names, files


def _text(table: Any) -> str:
    if hasattr(table, "write_csv"):
        return str(table.write_csv())
    if not isinstance(table, Mapping) and hasattr(table, "to_csv"):
        # An index with a name is a column.
        is_named = any(name is not None for name in getattr(getattr(table, "index", None), "names", ()))
        return str((table.reset_index() if is_named else table).to_csv(index=False))
    if not isinstance(table, Mapping):
        raise TypeError(f"readings are a data frame, a dict of columns or a path, not {type(table).__name__}")
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow(table)
    # numpy scalars are written as plain numbers.
    columns = [column.tolist() if hasattr(column, "tolist") else column for column in table.values()]
    lengths = {name: len(column) for name, column in zip(table, columns)}
    if len({*lengths.values()}) > 1:
        raise ValueError(f"readings: columns of different lengths: {', '.join(f'{name} {count}' for name, count in lengths.items())}")
    rows.writerows(zip(*columns, strict=True))
    return text.getvalue()


def overrides(given: Mapping[str, Any] | None) -> list[str]:
    """Return ``section.key=value`` for each key, values in TOML."""
    return [f"{key}={_toml(value)}" for key, value in (given or {}).items()]


def _toml(value: Any) -> str:
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{json.dumps(key)} = {_toml(inner)}" for key, inner in value.items()) + " }"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(map(_toml, value)) + "]"
    if isinstance(value, float):
        return repr(value)
    return json.dumps(str(value) if isinstance(value, os.PathLike) else value, ensure_ascii=False)
