"""The tutorial runs as it stands and says what is stored in it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import nbclient
import nbformat

TUTORIAL = Path(__file__).resolve().parents[1] / "tutorial.ipynb"


def said(notebook: Any) -> list[str]:
    """What its cells print, each stream by itself: on a busy machine they come in other pieces."""
    cells = [[output for output in cell.outputs if output.output_type == "stream"] for cell in notebook.cells if cell.cell_type == "code"]
    texts = ["".join(output.text for output in cell if output.name == stream) for cell in cells for stream in ("stdout", "stderr")]
    return [text for text in texts if text]


def test_the_tutorial_says_what_is_stored(tmp_path: Path) -> None:
    stored, fresh = (nbformat.read(TUTORIAL, as_version=4) for _ in range(2))
    nbclient.NotebookClient(fresh, timeout=90, resources={"metadata": {"path": str(tmp_path)}}).execute()
    assert said(fresh) == said(stored) and len(said(stored)) >= 6
