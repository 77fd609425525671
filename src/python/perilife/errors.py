"""Errors, with the messages of the command line."""

from __future__ import annotations

from functools import partial
from typing import Any


class PerilifeError(Exception):
    """Base class of all errors."""


class InputError(PerilifeError, ValueError):
    """Invalid input: file, line, key, value, problem and fix.

    Unavailable attributes are ``None``; the first ``line`` is 1.
    """

    def __init__(
        self,
        message: str,
        *,
        file: str | None = None,
        line: int | None = None,
        key: str | None = None,
        value: str | None = None,
        problem: str = "",
        remedy: str = "",
    ) -> None:
        super().__init__(message)
        self.file = file
        self.line = line
        self.key = key
        self.value = value
        self.problem = problem
        self.remedy = remedy


class MechanicsError(PerilifeError):
    """No convergence, a stopped run, or no valid result."""


class FileError(PerilifeError, OSError):
    """A file that cannot be read or written."""

    def __init__(self, message: str, *, filename: str | None = None, errno: int | None = None) -> None:
        super().__init__(message)
        self.filename = filename
        self.errno = errno

    def __reduce__(self) -> tuple[Any, ...]:
        # Without it an error out of another process lacks both.
        return partial(type(self), filename=self.filename, errno=self.errno), self.args

    def __str__(self) -> str:
        return str(self.args[0])
