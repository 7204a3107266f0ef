"""The notebooks run from beginning to end; what they say in numbers they assert."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import nbformat
import pytest

HERE = Path(__file__).resolve().parents[1] / "notebooks"
NOTEBOOKS = ["bifurcation-diagram", "first-steps", "own-system", "regime-map"]
#: Seconds; with optimised code each takes less than ten, without some minutes.
PATIENCE = 900


def test_all_notebooks_are_tested() -> None:
    assert sorted(path.stem for path in HERE.glob("*.ipynb")) == NOTEBOOKS


@pytest.mark.parametrize("name", NOTEBOOKS)
def test_what_is_committed_is_valid_and_has_no_outputs(name: str) -> None:
    notebook = nbformat.read(HERE / f"{name}.ipynb", as_version=nbformat.NO_CONVERT)
    nbformat.validate(notebook)
    assert notebook.nbformat == 4 and notebook.metadata.kernelspec.name == "python3"
    code = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert code and all(cell.outputs == [] and cell.execution_count is None for cell in code)
    assert any("assert " in cell.source for cell in code)
    # Names, and not numbers that another editor draws anew.
    assert all(not any(letter.isdigit() for letter in cell.id) for cell in notebook.cells)


@pytest.mark.parametrize("name", NOTEBOOKS)
def test_it_runs(name: str, tmp_path: Path) -> None:
    ended = subprocess.run(
        [
            sys.executable,
            "-m",
            "nbconvert",
            "--execute",
            "--to",
            "html",
            f"--ExecutePreprocessor.timeout={PATIENCE}",
            "--output-dir",
            str(tmp_path),
            str(HERE / f"{name}.ipynb"),
        ],
        capture_output=True,
        text=True,
        check=False,
        timeout=PATIENCE,
        env={**os.environ, "MPLBACKEND": "module://matplotlib_inline.backend_inline"},
    )
    assert ended.returncode == 0, ended.stderr[-4000:]
    page = (tmp_path / f"{name}.html").read_text(encoding="utf-8")
    assert "data:image/png" in page
