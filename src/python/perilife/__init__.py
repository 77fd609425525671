"""Fatigue crack growth: from test data to the life of a part with its scatter band.

Quantities carry their unit in their name (mm, MPa, N, MPa√m, mm/cycle). A case is the path of a TOML file, or a dict of the same
tables: ``{"specimen": {"kind": "middle_tension", "width_mm": 100.0, ...}, "material": {...}, "loading": {...}}``; paths in a dict
are relative to the current folder. ``set={"model.spacing_mm": 0.5}`` overrides keys, as ``--set`` does.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from . import _perilife
from .errors import FileError, InputError, MechanicsError, PerilifeError
from .inputs import Readings, csv_of, overrides
from .results import Calibration, Checked, Factors, FactorSweep, Fracture, Material, Prediction, Progress, StrPath
from .table import Table

__all__ = [
    "Calibration",
    "Case",
    "Checked",
    "FactorSweep",
    "Factors",
    "FileError",
    "Fracture",
    "InputError",
    "Law",
    "Material",
    "MechanicsError",
    "PerilifeError",
    "Prediction",
    "Progress",
    "Readings",
    "Table",
    "calibrate",
    "check",
    "fracture",
    "materials",
    "predict",
    "read_table",
    "sif",
    "sif_sweep",
]

Case = StrPath | Mapping[str, Any]
"""Path of a TOML file, or its tables."""
Law = Calibration | StrPath | Mapping[str, Any]
"""A calibration, a ``fitted.toml``, or keys of ``[fatigue]``."""
_Callback = Callable[[Progress], bool | None]


def calibrate(
    readings: Readings,
    *,
    specimen: Mapping[str, Any] | None = None,
    material: Mapping[str, Any] | None = None,
    loading: Mapping[str, Any] | None = None,
    model: Mapping[str, Any] | None = None,
    fit: Mapping[str, Any] | None = None,
    measured: Mapping[str, Any] | None = None,
    name: str = "calibration",
    set: Mapping[str, Any] | None = None,
    progress: _Callback | None = None,
) -> Calibration:
    """Fit a crack growth law to test data.

    Parameters
    ----------
    readings
        Data frame of pandas or polars, dict of columns (``specimen``, ``cycles``, ``crack_length_mm``, loads), path of a table
        (CSV, text, ``.xlsx``), a list of these, or path of a calibration file, which has all sections itself. Rates of
        da/dN against ΔK: ``calibrate([], measured={"rates": ["rates.csv"]}, material=...)``.
    specimen, material, loading, model, fit, measured
        Sections of a calibration file; ``measured`` sets columns and units that the headers do not state.
    set
        Keys to override, ``{"section.key": value}``.
    progress
        Callback with a :class:`Progress`; ``False`` stops the run.

    Returns
    -------
    Calibration
        The law with its errors, readings and curves.
    """
    source: Case
    files: dict[str, bytes] = {}
    sections = {"specimen": specimen, "material": material, "loading": loading, "model": model, "fit": fit}
    if isinstance(readings, (str, os.PathLike)) and Path(readings).suffix == ".toml":
        if measured is not None or any(section is not None for section in sections.values()):
            raise TypeError("a calibration file has its own sections; override keys of it by set")
        source = readings
    else:
        names, files = csv_of(readings)
        of_rates = measured is not None and "rates" in measured
        if measured is not None and "files" in measured:
            raise TypeError("the tables are the argument readings; remove files from measured")
        if bool(names) == of_rates:
            raise TypeError("give readings, or an empty list of them and measured={'rates': [...]}")
        source = {"measured": {**({"files": names} if names else {}), **(measured or {})}, **sections}
    run = _run("calibration", source, name, set, None, files, progress=progress)
    result = json.loads(run.result)
    # Of a fit to rates these are constants of the law that was chosen, which may have others.
    constants = result.get("constants", {})
    paris = constants if constants.keys() == {"paris_c_mm_per_cycle", "paris_m"} else result
    return Calibration(
        **_common(run, result, _name(source, name)),
        _run=run,
        a=result.get("a"),
        p=result.get("p"),
        horizon_mm=result.get("horizon_mm"),
        paris_c_mm_per_cycle=paris.get("paris_c_mm_per_cycle"),
        paris_m=paris.get("paris_m"),
        paris_m_error=result.get("standard_errors", {}).get("paris_m") if paris is constants else result.get("paris_m_error"),
        fitted=dict(run.tables())["fitted.toml"],
    )


def predict(
    case: Case,
    *,
    law: Law | None = None,
    name: str = "case",
    set: Mapping[str, Any] | None = None,
    measured: StrPath | None = None,
    error_estimate: bool = True,
    cross_check: bool = False,
    residual_strength: bool = False,
    sensitivities: bool = False,
    inspect_from_mm: float | None = None,
    factor: float = 3.0,
    tip: int | None = None,
    pod: tuple[float, float] | None = None,
    progress: _Callback | None = None,
) -> Prediction:
    """Predict crack growth and life of a case.

    Parameters
    ----------
    law
        Replaces the law of the case.
    measured
        Table of readings of this plate: updates its remaining life.
    error_estimate, cross_check
        Estimate the numerical error; add the life by the other method.
    residual_strength, sensitivities
        Add the residual strength curve; the life at other load, initial crack length and law.
    inspect_from_mm, factor, tip
        Detectable crack length, mm, of tip number ``tip`` (default: governing tip); factor of the inspection interval.
    pod
        Crack lengths found with 50 and 90 % probability, mm or with a unit; requires ``inspect_from_mm``.
    progress
        Callback with a :class:`Progress`; ``False`` stops the run.
    """
    if pod is not None and inspect_from_mm is None:
        raise ValueError(f"pod = {pod}: requires inspect_from_mm")
    if tip is not None and (inspect_from_mm is None or tip < 0):
        raise ValueError(f"tip = {tip}: is a tip number from 0 and requires inspect_from_mm")
    wishes: dict[str, Any] = {
        "error_estimate": error_estimate,
        "cross_check": cross_check,
        "residual_strength": residual_strength,
        "sensitivities": sensitivities,
        "inspect_from_mm": inspect_from_mm,
        "factor": factor,
        "tip": tip,
        "pod": None if pod is None else ",".join(str(length) for length in pod),
        "measured": None if measured is None else Path(measured),
    }
    run = _run("prediction", case, name, set, law, {}, wishes=wishes, progress=progress)
    result = json.loads(run.result)
    return Prediction(
        **_common(run, result, _name(case, name)),
        _run=run,
        life_cycles=result["life_cycles"],
        stop_reason=result["stop_reason"],
        stop_meaning=result["stop_meaning"],
        verdict=result["verdict"],
        checks=tuple(result["checks"]),
        band=result["band"],
        error_estimate_percent=result["error_estimate_percent"],
    )


def sif(
    case: Case,
    *,
    methods: str | Sequence[str] = (),
    name: str = "case",
    set: Mapping[str, Any] | None = None,
    progress: _Callback | None = None,
) -> Factors:
    """Compute stress intensity factors of each crack tip at maximum load, by all methods or those named."""
    run = _run("sif", case, name, set, None, {}, methods=methods, progress=progress)
    result = json.loads(run.result)
    columns = ["k_i_mpa_sqrt_m", "k_ii_mpa_sqrt_m", "t_stress_mpa"]
    rows = [
        [number, tip["x_mm"], tip["y_mm"], method, *map(found.get, columns), tip["handbook_k_i_mpa_sqrt_m"]]
        for number, tip in enumerate(result.get("tips", []))
        for method, found in tip["methods"].items()
    ]
    header = ["tip", "x_mm", "y_mm", "method", *columns, "handbook_k_i_mpa_sqrt_m"]
    lines = [",".join("" if cell is None else str(cell) for cell in row) for row in [header, *rows]]
    return Factors(**_common(run, result, _name(case, name)), tips=Table("\n".join(lines)))


def sif_sweep(
    case: Case,
    lengths_mm: str | tuple[float, float, float],
    *,
    name: str = "case",
    set: Mapping[str, Any] | None = None,
    progress: _Callback | None = None,
) -> FactorSweep:
    """Compute K, T, β and compliance over crack length along the crack path.

    ``lengths_mm`` are first, last and step, or the text ``"first:last:step"`` of ``perilife sif --sweep``, in the convention of the
    specimen. ``beta.to_csv(path)`` of the result is read by ``specimen.beta_file`` and by AFGROW.
    """
    lengths = lengths_mm if isinstance(lengths_mm, str) else ":".join(str(float(length)) for length in lengths_mm)
    table, beta, lead, warnings = _perilife.sif_sweep(_source(case), name, overrides(set), lengths, _told(progress))
    rows = Table(table)
    reached = dict.fromkeys(rows["crack_length_mm"])
    summary = f"K at {len(reached)} lengths from {min(reached):g} to {max(reached):g} mm"
    return FactorSweep(_name(case, name), tuple(warnings), {"lead_tip": lead}, summary, rows, Table(beta), lead)


def fracture(
    scene: Case,
    *,
    name: str = "scene",
    set: Mapping[str, Any] | None = None,
    progress: _Callback | None = None,
) -> Fracture:
    """Run a fracture scene (static, quasi-static or dynamic)."""
    run = _run("scene", scene, name, set, None, {}, progress=progress)
    result = json.loads(run.result)
    return Fracture(
        **_common(run, result, _name(scene, name)),
        _run=run,
        stop_reason=result["stop_reason"],
        stop_meaning=result["stop_meaning"],
        peak_load_n=result["peak_load_n"],
    )


def check(case: Case, *, law: Law | None = None, name: str = "case", set: Mapping[str, Any] | None = None) -> Checked:
    """Validate an input; return its interpretation and a drawing."""
    keys, files = _law(law)
    text, drawing = _perilife.check(_source(case), name, overrides(set), keys, files)
    result = json.loads(text)
    understood: dict[str, str] = result["understood"]
    return Checked(
        name=result["name"],
        warnings=tuple(result["warnings"]),
        result=result,
        summary="\n".join(f"{what:<12} {words}" for what, words in understood.items()),
        kind=result["kind"],
        understood=understood,
        drawing=drawing,
    )


def materials() -> tuple[Material, ...]:
    """List the materials of the library."""
    return tuple(Material(*row) for row in _perilife.materials())


def read_table(path: StrPath) -> Table:
    """Read a table of test data into the columns ``specimen``, ``cycles`` and ``crack_length_mm``.

    To fit a law, pass the path to :func:`calibrate`, which also uses loads and remarks.
    """
    specimens, cycles, lengths, _ = _perilife.read_table(Path(path))
    columns = {"specimen": specimens, "cycles": cycles, "crack_length_mm": lengths}
    return Table(csv_of(columns)[1]["readings.csv"].decode())


def _run(
    kind: str,
    source: Case,
    name: str,
    set: Mapping[str, Any] | None,
    law: Law | None,
    files: dict[str, bytes],
    *,
    methods: str | Sequence[str] = (),
    wishes: dict[str, Any] | None = None,
    progress: _Callback | None = None,
) -> _perilife.Run:
    keys, of_law = _law(law)
    return _perilife.run(
        kind,
        _source(source),
        name,
        overrides(set),
        keys,
        files | of_law,
        methods=[methods] if isinstance(methods, str) else list(methods),
        wishes=wishes,
        progress=_told(progress),
    )


def _told(progress: _Callback | None) -> Callable[[float, float | None, float | None, str | None], bool | None] | None:
    return None if progress is None else (lambda *figures: progress(Progress(*figures)))


def _source(case: Case) -> Path | Mapping[str, Any]:
    return case if isinstance(case, Mapping) else Path(case)


def _name(case: Case, name: str) -> str:
    return name if isinstance(case, Mapping) else Path(case).stem


def _law(law: Law | None) -> tuple[Mapping[str, Any] | None, dict[str, bytes]]:
    """Keys of ``[fatigue]`` of a law, and the files they name."""
    if law is None or isinstance(law, Mapping):
        return law, {}
    if isinstance(law, Calibration):
        return {"fitted": "fitted.toml"}, {"fitted.toml": law.fitted.encode()}
    return {"fitted": str(Path(law).absolute())}, {}


def _common(run: _perilife.Run, result: dict[str, Any], name: str) -> dict[str, Any]:
    return {"name": name, "warnings": tuple(run.warnings), "result": result, "summary": "\n".join(run.lines)}
