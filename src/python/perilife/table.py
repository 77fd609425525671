"""Tables of results: columns with their units in their names."""

from __future__ import annotations

import csv
import io
import os
from collections.abc import Iterator, Mapping
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from .errors import FileError

if TYPE_CHECKING:
    import pandas
    import polars


class Table(Mapping[str, "npt.NDArray[Any]"]):
    """A table as a mapping of column names to arrays.

    A column of numbers is ``float64`` with NaN where a cell is empty; any other is text, and so are names of specimens. Columns are
    read-only.
    """

    def __init__(self, text: str) -> None:
        """Wrap the text of a CSV file, parsed on first access to a column."""
        self._text = text

    @cached_property
    def _columns(self) -> dict[str, npt.NDArray[Any]]:
        header, *rows = csv.reader(io.StringIO(self._text))
        cells = zip(*rows) if rows else [()] * len(header)
        return {name: _column(column, name in _NAMES) for name, column in zip(header, cells)}

    def __getitem__(self, name: str) -> npt.NDArray[Any]:
        return self._columns[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        """Number of columns."""
        return len(self._columns)

    @property
    def rows(self) -> int:
        """Number of rows."""
        return len(next(iter(self._columns.values()), ()))

    def to_numpy(self) -> npt.NDArray[Any]:
        """Return a structured array with the column names."""
        array = np.empty(self.rows, dtype=[(name, column.dtype) for name, column in self.items()])
        for name, column in self.items():
            array[name] = column
        return array

    def to_pandas(self) -> pandas.DataFrame:
        """Return a pandas data frame."""
        import pandas

        return pandas.DataFrame(self._columns)

    def to_polars(self) -> polars.DataFrame:
        """Return a polars data frame."""
        import polars

        return polars.DataFrame(self._columns)

    def to_csv(self, path: str | os.PathLike[str] | None = None) -> str:
        """Return the CSV text with all digits; also write it to ``path`` if given."""
        if path is not None:
            write_text(path, self._text)
        return self._text

    def __repr__(self) -> str:
        return f"Table({self.rows} rows: {', '.join(self)})"

    def _repr_html_(self) -> str:
        return str(self.to_pandas().to_html(max_rows=12))


_NAMES = ("specimen", "file")
"""Columns of names, which may look like numbers: 01 is not 1."""


def write_text(path: str | os.PathLike[str], text: str) -> None:
    """Write a file; raise ``FileError`` if the system refuses."""
    try:
        Path(path).write_text(text, encoding="utf-8")
    except OSError as error:
        raise FileError(f"{path}: cannot write: {error.strerror}", filename=str(path), errno=error.errno) from error


def _column(cells: tuple[str, ...], is_of_names: bool) -> npt.NDArray[Any]:
    column: npt.NDArray[Any]
    try:
        if is_of_names:
            raise ValueError
        column = np.array([float(cell) if cell else np.nan for cell in cells], dtype=np.float64)
    except ValueError:
        column = np.array(cells, dtype=np.str_)
    # A result is what was computed: whoever wants to change it takes a copy.
    column.flags.writeable = False
    return column
