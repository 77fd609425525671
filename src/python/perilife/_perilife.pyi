"""Compiled part of the package."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, final

__all__ = ["Run", "check", "materials", "read_table", "report", "run", "sif_sweep"]

@final
class Run:
    @property
    def result(self) -> str: ...
    @property
    def lines(self) -> list[str]: ...
    @property
    def warnings(self) -> list[str]: ...
    def tables(self) -> list[tuple[str, str]]: ...
    def save(self, folder: Path, force: bool = False) -> None: ...

def run(
    kind: str,
    source: Path | Mapping[str, Any],
    name: str,
    set: list[str],
    law: Mapping[str, Any] | None,
    files: dict[str, bytes],
    *,
    methods: list[str],
    wishes: dict[str, Any] | None,
    progress: Callable[[float, float | None, float | None, str | None], bool | None] | None,
) -> Run: ...
def sif_sweep(
    source: Path | Mapping[str, Any],
    name: str,
    set: list[str],
    lengths: str,
    progress: Callable[[float, float | None, float | None, str | None], bool | None] | None,
) -> tuple[str, str, int, list[str]]: ...
def check(
    source: Path | Mapping[str, Any], name: str, set: list[str], law: Mapping[str, Any] | None, files: dict[str, bytes]
) -> tuple[str, str]: ...
def read_table(file: Path) -> tuple[list[str], list[float], list[float], list[str]]: ...
def materials() -> list[tuple[str, str, float | None, float | None, float | None, float | None, bool]]: ...
def report(
    folder: Path, out: Path, laboratory: str | None, operator: str | None, reviewer: str | None, date: str | None
) -> None: ...
