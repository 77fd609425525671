"""Result classes: frozen dataclasses with tables, figures, checks and warnings."""

from __future__ import annotations

import os
import re
import tempfile
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import _perilife
from .errors import FileError
from .inputs import overrides
from .table import Table, write_text

if TYPE_CHECKING:
    from matplotlib.axes import Axes

StrPath = str | os.PathLike[str]


@dataclass(frozen=True)
class Progress:
    """Progress of a run."""

    share: float
    """Fraction done, 0 to 1 (of ``stage`` if given)."""
    cycles: float | None
    """Cycles so far; ``None`` of scenes, and before the first row."""
    crack_length_mm: float | None
    """Crack length, mm."""
    stage: str | None
    """Step before the first row: building the model, the solver, ..."""


@dataclass(frozen=True)
class _Result:
    """A result with its run: tables and files are made on request."""

    name: str
    """Name of the case."""
    warnings: tuple[str, ...]
    """Warnings."""
    result: dict[str, Any] = field(repr=False)
    """All figures, as in the JSON file of the command line."""
    summary: str = field(repr=False)
    """Summary, same text as the command line."""

    def __str__(self) -> str:
        return "\n".join([self.summary, *(f"warning: {warning}" for warning in self.warnings)])


class _Written:
    """A run of another process: its tables and files, saved into a new folder only."""

    def __init__(self, run: _perilife.Run | _Written) -> None:
        self._tables = run.tables()
        with tempfile.TemporaryDirectory() as scratch:
            folder = Path(scratch) / "run"
            run.save(folder)
            self._files = {file.relative_to(folder): file.read_bytes() for file in folder.rglob("*") if file.is_file()}

    def tables(self) -> list[tuple[str, str]]:
        return self._tables

    def save(self, folder: Path, force: bool = False) -> None:
        if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
            raise FileError(f"{folder}: is there already; name a new folder", filename=str(folder))
        for name, content in self._files.items():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            (folder / name).write_bytes(content)


@dataclass(frozen=True)
class _Run(_Result):
    _run: _perilife.Run | _Written = field(repr=False, compare=False)

    def __getstate__(self) -> dict[str, Any]:
        """Return the picklable state: tables and files, not the run itself."""
        return self.__dict__ | {"_run": self._run if isinstance(self._run, _Written) else _Written(self._run)}

    @cached_property
    def tables(self) -> dict[str, Table]:
        """All tables by file name without extension."""
        return {Path(name).stem: Table(text) for name, text in self._run.tables() if name.endswith(".csv")}

    def save(self, folder: StrPath, *, force: bool = False) -> Path:
        """Write the files of ``--out``; replace results of another input only with ``force``."""
        self._run.save(Path(folder), force)
        return Path(folder)


@dataclass(frozen=True)
class _Reported(_Run):
    def report(
        self,
        path: StrPath,
        *,
        data: StrPath | None = None,
        **items: str | None,
    ) -> Path:
        """Write one self-contained HTML page, to be printed and signed.

        ``data`` is a TOML file with a section ``[report]``; ``items`` are keys of that section, such as ``laboratory``,
        ``customer``, ``number``, ``operator``, ``reviewer``, ``date``, ``orientation``, ``machine`` and ``environment``.
        """
        with tempfile.TemporaryDirectory() as scratch:
            # A name may hold what a path means something by.
            folder = Path(scratch) / (re.sub(r"[^\w.-]+", "_", self.name).strip(".") or "run")
            self._run.save(folder)
            given = overrides({f"report.{key}": value for key, value in items.items() if value is not None})
            _perilife.report(folder, Path(path), None if data is None else Path(data), given)
        return Path(path)


@dataclass(frozen=True)
class Prediction(_Reported):
    """Predicted life with end of analysis, validity and accuracy."""

    life_cycles: float | None
    """Life N_f, cycles; ``None`` if nothing grows."""
    stop_reason: str
    """End of analysis, key."""
    stop_meaning: str
    """The same in words."""
    verdict: str
    """All checks together, in words."""
    verdict_kind: str
    """The same by name: ``valid``, ``reservations`` or ``not_valid``."""
    checks: tuple[dict[str, Any], ...]
    """Each check with name, verdict (passed, caution, not_checked, failed), effect on the life, words and remedy."""
    band: dict[str, Any] | None
    """Life of 5, 50 and 95 % of plates, if the law has scatter."""
    error_estimate_percent: float | None
    """Estimated numerical error of the life, percent."""

    @property
    def a_n(self) -> Table:
        """a-N curve: cycles, crack length, ΔK, da/dN, each tip, band."""
        return self.tables["a_n"]

    @property
    def crack_path(self) -> Table:
        """Crack path of each tip, initial crack first."""
        return self.tables["crack_path"]

    def plot(self, ax: Axes | None = None) -> Axes:
        """Plot crack length against cycles with the 90 % band."""
        ax = _axes(ax)
        table = self.a_n
        ax.plot(table["cycles"], table["crack_length_mm"], label=self.name)
        if "cycles_p05" in table:
            low, high, length = table["cycles_p05"], table["cycles_p95"], table["crack_length_mm"]
            ax.fill_betweenx(length, low, high, alpha=0.2, label="90 % band")
        return _labelled(ax, "Cycles", "Crack length, mm")


@dataclass(frozen=True)
class Calibration(_Reported):
    """A law fitted to readings, or several to rates."""

    a: float | None
    """A of the bond law at ``horizon_mm``; ``None`` for a fit without bonds."""
    p: float | None
    """Exponent p of the bond law."""
    horizon_mm: float | None
    """Horizon of A, mm."""
    paris_c_mm_per_cycle: float | None
    """C of da/dN = C ΔK^m, mm/cycle and MPa√m."""
    paris_m: float | None
    """Exponent m of da/dN = C ΔK^m."""
    paris_m_error: float | None
    """Standard error of m."""
    fitted: str = field(repr=False)
    """The law as ``fitted.toml``."""

    @property
    def readings(self) -> Table:
        """Every reading with ΔK, rate, marks, reason if excluded; for a fit to rates those rates."""
        return self.tables["readings" if "readings" in self.tables else "rates"]

    @property
    def curves(self) -> Table:
        """Measured and fitted cycles over crack length; for a fit to rates, measured and fitted rates."""
        return self.tables["fit_curves" if "fit_curves" in self.tables else "fit_rates"]

    def save(self, folder: StrPath, *, force: bool = False) -> Path:
        """Write the law to a ``.toml`` file, or all files to a folder."""
        if Path(folder).suffix.lower() != ".toml":
            return super().save(folder, force=force)
        write_text(folder, self.fitted)
        return Path(folder)

    def plot(self, ax: Axes | None = None) -> Axes:
        """Plot da/dN of the readings against ΔK with the law."""
        ax = _axes(ax)
        rates = self.tables["rates"]
        delta_k = rates["delta_k_mpa_sqrt_m"]
        ax.loglog(delta_k, rates["da_dn_mm_per_cycle"], ".", label="readings")
        if self.paris_c_mm_per_cycle is not None and self.paris_m is not None:
            ends = [delta_k.min(), delta_k.max()]
            law = f"{self.paris_c_mm_per_cycle:.3g} ΔK^{self.paris_m:.3f}"
            ax.loglog(ends, [self.paris_c_mm_per_cycle * k**self.paris_m for k in ends], label=law)
        return _labelled(ax, "ΔK, MPa√m", "da/dN, mm/cycle")


@dataclass(frozen=True)
class Factors(_Result):
    """Stress intensity factors of each crack tip at maximum load."""

    tips: Table
    """A row per tip and method: position, K_I, K_II, T-stress, handbook K_I."""

    def plot(self, ax: Axes | None = None) -> Axes:
        """Plot K_I of each tip by each method."""
        ax = _axes(ax)
        for method in dict.fromkeys(self.tips["method"]):
            is_by = self.tips["method"] == method
            ax.plot(self.tips["tip"][is_by], self.tips["k_i_mpa_sqrt_m"][is_by], "o", label=str(method))
        return _labelled(ax, "Tip", "K_I, MPa√m")


@dataclass(frozen=True)
class FactorSweep(_Result):
    """Stress intensity factors over crack length."""

    table: Table
    """A row per length and tip: position, K_I, K_II, T-stress, β, CMOD, load-line displacement, back-face strain."""
    beta: Table
    """β over crack length of the tip that grows farthest, for ``specimen.beta_file``."""
    lead_tip: int
    """Number of that tip."""

    def plot(self, ax: Axes | None = None) -> Axes:
        """Plot K_I of each tip against crack length."""
        ax = _axes(ax)
        for tip in dict.fromkeys(self.table["tip"]):
            is_its = self.table["tip"] == tip
            ax.plot(self.table["crack_length_mm"][is_its], self.table["k_i_mpa_sqrt_m"][is_its], label=f"tip {tip:.0f}")
        return _labelled(ax, "Crack length, mm", "K_I, MPa√m")


@dataclass(frozen=True)
class Fracture(_Run):
    """Fracture scene."""

    stop_reason: str
    """End of analysis, key."""
    stop_meaning: str
    """The same in words."""
    peak_load_n: float | None
    """Peak load, N."""

    @property
    def history(self) -> Table:
        """A row per recorded step: displacement, load, broken bonds, energies."""
        return self.tables["history"]

    @property
    def crack_path(self) -> Table:
        """Positions of each crack front."""
        return self.tables["crack_path"]

    def plot(self, ax: Axes | None = None) -> Axes:
        """Plot load against displacement."""
        ax = _axes(ax)
        ax.plot(self.history["displacement_mm"], self.history["load_n"], label=self.name)
        return _labelled(ax, "Displacement, mm", "Load, N")


@dataclass(frozen=True)
class Checked(_Result):
    """A validated input."""

    kind: str
    """``case``, ``calibration`` or ``fracture``."""
    understood: dict[str, str]
    """Interpretation of the input by label."""
    drawing: str = field(repr=False)
    """Specimen, cracks, loads and supports as SVG."""

    def _repr_svg_(self) -> str:
        return self.drawing


@dataclass(frozen=True)
class Material:
    """A material of the library."""

    name: str
    """Value of ``material.name``."""
    title: str
    """Alloy and condition."""
    youngs_modulus_gpa: float | None
    poisson_ratio: float | None
    yield_strength_mpa: float | None
    toughness_mpa_sqrt_m: float | None
    has_growth_data: bool
    """Has growth data for ``growth_law = "library"``."""


def _axes(ax: Axes | None) -> Axes:
    if ax is not None:
        return ax
    import matplotlib.pyplot

    return matplotlib.pyplot.subplots()[1]


def _labelled(ax: Axes, x: str, y: str) -> Axes:
    ax.set_xlabel(x)
    ax.set_ylabel(y)
    ax.legend()
    return ax
