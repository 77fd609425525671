"""What comes of a call: frozen dataclasses with tables, figures and what the user should know."""

from __future__ import annotations

import json
import os
import re
import tempfile
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import _perilife
from .errors import FileError
from .table import Table, write_text

if TYPE_CHECKING:
    from matplotlib.axes import Axes

StrPath = str | os.PathLike[str]


@dataclass(frozen=True)
class Progress:
    """How far a run is."""

    share: float
    """Share of the way to its end, 0 to 1; of ``stage`` where that is given."""
    cycles: float | None
    """Cycles so far; ``None`` of scenes, and before the first row."""
    crack_length_mm: float | None
    """Crack length."""
    stage: str | None
    """What is done before there is a row: laying points, building the solver, ..."""


@dataclass(frozen=True)
class _Result:
    """A result that keeps its run, so that tables are made and files are written when they are asked for."""

    name: str
    """Name of the case."""
    warnings: tuple[str, ...]
    """What the user should know."""
    result: dict[str, Any] = field(repr=False)
    """All figures, as the JSON file of the command line has them."""
    summary: str = field(repr=False)
    """The result in the words of the command line."""

    def __str__(self) -> str:
        return "\n".join([self.summary, *(f"warning: {warning}" for warning in self.warnings)])


class _Written:
    """A run in another process: its tables, and the files that it writes, into a new folder only."""

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
        """What is pickled: a run itself cannot leave its process, its tables and files can."""
        return self.__dict__ | {"_run": self._run if isinstance(self._run, _Written) else _Written(self._run)}

    @cached_property
    def tables(self) -> dict[str, Table]:
        """All tables by the names of their files without ending."""
        return {Path(name).stem: Table(text) for name, text in self._run.tables() if name.endswith(".csv")}

    def save(self, folder: StrPath, *, force: bool = False) -> Path:
        """Writes what the command line writes into ``--out``; results of another input are replaced by ``force`` alone."""
        self._run.save(Path(folder), force)
        return Path(folder)


@dataclass(frozen=True)
class _Reported(_Run):
    def report(
        self,
        path: StrPath,
        *,
        data: StrPath | None = None,
        **items: str,
    ) -> Path:
        """Write one self-contained HTML page, to be printed and signed.

        ``data`` is a TOML file with a section ``[report]``; ``items`` are keys of that section, such as ``laboratory``,
        ``customer``, ``number``, ``operator``, ``reviewer``, ``date``, ``orientation``, ``machine`` and ``environment``.
        """
        with tempfile.TemporaryDirectory() as scratch:
            # A name may hold what a path means something by.
            folder = Path(scratch) / (re.sub(r"[^\w.-]+", "_", self.name).strip(".") or "run")
            self._run.save(folder)
            overrides = [f"report.{key}={json.dumps(value, ensure_ascii=False)}" for key, value in items.items()]
            _perilife.report(folder, Path(path), None if data is None else Path(data), overrides)
        return Path(path)


@dataclass(frozen=True)
class Prediction(_Reported):
    """A run of cycles: its life, why it ended, how far it can be trusted."""

    life_cycles: float | None
    """Cycles to the end; ``None`` where nothing grows."""
    stop_reason: str
    """Why the run ended, by name."""
    stop_meaning: str
    """The same in words."""
    verdict: str
    """What the life stands on, in words."""
    checks: tuple[dict[str, Any], ...]
    """Each check with name, verdict, effect on the life, words and remedy."""
    band: dict[str, Any] | None
    """Cycles that 5, 50 and 95 % of specimens take, where the law is a fit whose scatter is known."""
    error_estimate_percent: float | None
    """Bound of the error of the life as a solution of this case, percent."""

    @property
    def a_n(self) -> Table:
        """The curve: cycles, crack length, ΔK, da/dN, every tip, the band."""
        return self.tables["a_n"]

    @property
    def crack_path(self) -> Table:
        """The way of every tip, initial crack first."""
        return self.tables["crack_path"]

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draws crack length over cycles, with the band of 90 % of specimens."""
        ax = _axes(ax)
        table = self.a_n
        ax.plot(table["cycles"], table["crack_length_mm"], label=self.name)
        if "cycles_p05" in table:
            low, high, length = table["cycles_p05"], table["cycles_p95"], table["crack_length_mm"]
            ax.fill_betweenx(length, low, high, alpha=0.2, label="90 % of specimens")
        return _labelled(ax, "Cycles", "Crack length, mm")


@dataclass(frozen=True)
class Calibration(_Reported):
    """A law fitted to readings, or several to rates."""

    a: float | None
    """A of the life of bonds at ``horizon_mm``; ``None`` of a fit without bonds."""
    p: float | None
    """Exponent of A."""
    horizon_mm: float | None
    """Horizon that A belongs to."""
    paris_c_mm_per_cycle: float | None
    """C of da/dN = C ΔK^m, mm/cycle and MPa√m."""
    paris_m: float | None
    """m of the same."""
    paris_m_error: float | None
    """Its standard error."""
    fitted: str = field(repr=False)
    """The law as ``fitted.toml``."""

    @property
    def readings(self) -> Table:
        """Every reading with ΔK, rate, marks and why it was left out; of a fit to rates the rates that it took."""
        return self.tables["readings" if "readings" in self.tables else "rates"]

    @property
    def curves(self) -> Table:
        """Measured and fitted cycles over crack length; of a fit to rates measured and fitted rates."""
        return self.tables["fit_curves" if "fit_curves" in self.tables else "fit_rates"]

    def save(self, folder: StrPath, *, force: bool = False) -> Path:
        """Writes the law into a ``.toml`` file, or all that the command line writes into a folder."""
        if Path(folder).suffix.lower() != ".toml":
            return super().save(folder, force=force)
        write_text(folder, self.fitted)
        return Path(folder)

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draws da/dN of the readings over ΔK, with the law."""
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
    """Stress intensity factors of every crack tip at maximum load."""

    tips: Table
    """A row for every tip and method: place, K_I, K_II, T-stress, the value of the handbook."""

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draws K_I of every tip by every method."""
        ax = _axes(ax)
        for method in dict.fromkeys(self.tips["method"]):
            is_by = self.tips["method"] == method
            ax.plot(self.tips["tip"][is_by], self.tips["k_i_mpa_sqrt_m"][is_by], "o", label=str(method))
        return _labelled(ax, "Tip", "K_I, MPa√m")


@dataclass(frozen=True)
class FactorSweep(_Result):
    """Stress intensity factors over crack length."""

    table: Table
    """A row for every length and tip: place, K_I, K_II, T-stress, β, CMOD, load-line displacement, back-face strain."""
    beta: Table
    """β over its own length of the tip that grows farthest, as ``specimen.beta_file`` reads it."""
    lead_tip: int
    """Its number."""

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draws K_I of every tip over crack length."""
        ax = _axes(ax)
        for tip in dict.fromkeys(self.table["tip"]):
            is_its = self.table["tip"] == tip
            ax.plot(self.table["crack_length_mm"][is_its], self.table["k_i_mpa_sqrt_m"][is_its], label=f"tip {tip:.0f}")
        return _labelled(ax, "Crack length, mm", "K_I, MPa√m")


@dataclass(frozen=True)
class Fracture(_Run):
    """A scene without cycles."""

    stop_reason: str
    """Why it ended, by name."""
    stop_meaning: str
    """The same in words."""
    peak_load_n: float | None
    """Largest load."""

    @property
    def history(self) -> Table:
        """A row for every recorded step: displacement, load, broken bonds, energies."""
        return self.tables["history"]

    @property
    def crack_path(self) -> Table:
        """Where every crack front stood."""
        return self.tables["crack_path"]

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draws load over displacement."""
        ax = _axes(ax)
        ax.plot(self.history["displacement_mm"], self.history["load_n"], label=self.name)
        return _labelled(ax, "Displacement, mm", "Load, N")


@dataclass(frozen=True)
class Checked(_Result):
    """An input that was understood without running it."""

    kind: str
    """``case``, ``calibration`` or ``fracture``."""
    understood: dict[str, str]
    """What was understood, by its name."""
    drawing: str = field(repr=False)
    """Specimen, cracks, loads and supports as SVG."""

    def _repr_svg_(self) -> str:
        return self.drawing


@dataclass(frozen=True)
class Material:
    """A material of the library."""

    name: str
    """As ``material.name`` takes it."""
    title: str
    """What it is."""
    youngs_modulus_gpa: float | None
    poisson_ratio: float | None
    yield_strength_mpa: float | None
    toughness_mpa_sqrt_m: float | None
    has_growth_data: bool
    """Whether ``growth_law = "library"`` finds a law for it."""


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
