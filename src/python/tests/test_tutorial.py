"""The tutorial runs as it stands and says what is stored in it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import nbclient
import nbformat

TUTORIAL = Path(__file__).resolve().parents[1] / "tutorial.ipynb"


def said(notebook: Any) -> list[str]:
    """What its cells print."""
    outputs = [output for cell in notebook.cells if cell.cell_type == "code" for output in cell.outputs]
    return [output.text for output in outputs if output.output_type == "stream"]


def test_the_tutorial_says_what_is_stored(tmp_path: Path) -> None:
    stored, fresh = (nbformat.read(TUTORIAL, as_version=4) for _ in range(2))
    nbclient.NotebookClient(fresh, timeout=90, resources={"metadata": {"path": str(tmp_path)}}).execute()
    assert said(fresh) == said(stored) and len(said(stored)) >= 6
