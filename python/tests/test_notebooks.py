"""The notebooks run from beginning to end; their stored outputs are what they print, and what they say in numbers they assert."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import nbformat
import pytest

PACKAGE = Path(__file__).resolve().parents[1]
HERE = PACKAGE / "notebooks"
NOTEBOOKS = ["bifurcation-diagram", "first-steps", "own-system", "regime-map"]
#: Seconds; with optimised code each takes less than ten, without some minutes.
PATIENCE = 900
#: Bytes of a file: what a forge still shows, and a clone takes along.
LARGEST = 300_000


def test_all_notebooks_are_tested() -> None:
    assert sorted(path.stem for path in HERE.glob("*.ipynb")) == NOTEBOOKS


@pytest.mark.parametrize("name", NOTEBOOKS)
def test_what_is_committed_is_valid_and_has_its_outputs(name: str) -> None:
    path = HERE / f"{name}.ipynb"
    notebook = nbformat.read(path, as_version=nbformat.NO_CONVERT)
    nbformat.validate(notebook)
    assert path.stat().st_size < LARGEST
    assert notebook.nbformat == 4 and notebook.metadata.kernelspec.name == "python3"
    code = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert code and all(cell.execution_count is None for cell in code)
    assert any("assert " in cell.source for cell in code)
    outputs = [output for cell in code for output in cell.outputs]
    assert any("image/png" in output.get("data", {}) for output in outputs)
    # Warnings and tracebacks name files of the machine that ran it.
    assert all(
        output.output_type != "error" and output.get("name") != "stderr" for output in outputs
    )
    # Names, and not numbers that another editor draws anew.
    assert all(not any(letter.isdigit() for letter in cell.id) for cell in notebook.cells)


@pytest.mark.parametrize("name", NOTEBOOKS)
def test_it_runs_and_prints_what_is_stored(name: str) -> None:
    ended = subprocess.run(
        [sys.executable, PACKAGE / "scripts" / "run-notebooks", "--check", name],
        capture_output=True,
        text=True,
        check=False,
        timeout=PATIENCE,
        env={**os.environ, "MPLBACKEND": "module://matplotlib_inline.backend_inline"},
    )
    assert ended.returncode == 0, ended.stderr[-4000:]


def test_they_are_chapters_of_the_book(tmp_path: Path) -> None:
    (tmp_path / "SUMMARY.md").write_text(
        "# Summary\n\n- [Notebooks](notebooks.md)\n- [Files](files.md)\n"
    )
    (tmp_path / "notebooks.md").write_text("[First steps](../python/notebooks/first-steps.ipynb)\n")
    script = PACKAGE / "scripts" / "render-notebooks"
    subprocess.run([sys.executable, script, tmp_path], check=True, capture_output=True)
    assert (tmp_path / "notebooks.md").read_text() == "[First steps](notebooks/first-steps.md)\n"
    summary = (tmp_path / "SUMMARY.md").read_text()
    for name in NOTEBOOKS:
        assert f"](notebooks/{name}.md)\n" in summary.partition("(files.md)")[0]
        page = (tmp_path / "notebooks" / f"{name}.md").read_text()
        links = re.findall(r"\]\(([^)]+)\)", page)
        assert any(link.endswith(".png") for link in links)
        for link in links:
            assert (tmp_path / "notebooks" / link).is_file(), f"{name}: {link}"
        # An empty line would end the markup of a table or a picture.
        for markup in re.findall(
            r'^<div class="table-wrapper".*?^</div>', page, re.DOTALL | re.MULTILINE
        ):
            assert not re.search(r"\n\s*\n", markup)
