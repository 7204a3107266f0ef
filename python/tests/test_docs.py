"""The examples of the pages run, page by page."""

from __future__ import annotations

import doctest
import re
import warnings
from pathlib import Path

import pytest

import twinslip

REPOSITORY = Path(__file__).resolve().parents[2]
TASKS = [
    "brute-force-diagram",
    "coming-from-scipy",
    "python-beside-scipy",
    "python-functions-as-systems",
]
PAGES = [
    "README.md",
    "python/README.md",
    "docs/python.md",
    *(f"docs/tasks/{task}.md" for task in TASKS),
]


@pytest.mark.parametrize("page", PAGES)
def test_examples_of_pages_run(page: str, capsys: pytest.CaptureFixture[str]) -> None:
    text = (REPOSITORY / page).read_text()
    blocks = re.findall(r"^```python\n(.*?)^```", text, re.MULTILINE | re.DOTALL)
    assert blocks, f"{page} has no example"
    names: dict[str, object] = {}
    for block in blocks:
        exec(compile(block, page, "exec"), names)
    # What a comment behind a call of print says is printed.
    printed = capsys.readouterr().out
    for said in re.findall(r"print\([^#\n]*\)\s+# ([^\n]*)", "".join(blocks)):
        assert said.split(", ...")[0] in printed, said


def test_examples_of_docstrings() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        failed, tried = doctest.testmod(twinslip)
    assert tried > 0 and failed == 0
