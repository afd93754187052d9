"""The notebooks: they run, and their pictures are those that they show."""

from __future__ import annotations

import base64
import pathlib

import lightloom
import nbclient
import nbformat
import pytest

FOLDER = pathlib.Path(__file__).parents[3] / "docs/notebooks"
MOST = 0.05
"""The greatest mean ꟻLIP between a picture and the one that is stored: drivers round otherwise, and a light may go elsewhere."""


def pictures(notebook: nbformat.NotebookNode) -> list[bytes]:
    """Returns the pictures of all cells, as PNG files."""
    outputs = (output for cell in notebook.cells for output in cell.get("outputs", []))
    return [base64.b64decode(output.data["image/png"]) for output in outputs if "image/png" in output.get("data", {})]


@pytest.mark.parametrize("name", sorted(path.stem for path in FOLDER.glob("*.ipynb")))
def test_a_notebook_shows_what_it_computes(name: str, folder: pathlib.Path) -> None:
    notebook = nbformat.read(FOLDER / f"{name}.ipynb", 4)
    stored = pictures(notebook)
    nbclient.NotebookClient(notebook, timeout=500, resources={"metadata": {"path": str(folder)}}).execute()
    found = pictures(notebook)
    assert len(found) == len(stored) > 0
    for i, (ours, theirs) in enumerate(zip(found, stored)):
        (folder / "ours.png").write_bytes(ours)
        (folder / "theirs.png").write_bytes(theirs)
        both = lightloom.read("ours.png"), lightloom.read("theirs.png")
        assert lightloom.flip(*both, display=True).mean() < MOST, f"picture {i}"
