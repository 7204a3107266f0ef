"""The examples of the pages run, page by page."""

from __future__ import annotations

import doctest
import inspect
import re
import warnings
from pathlib import Path
from typing import Any

import pytest

import twinslip

REPOSITORY = Path(__file__).resolve().parents[2]
TASKS = [
    "brute-force-diagram",
    "coming-from-scipy",
    "large-systems",
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


def public() -> dict[str, Any]:
    """The functions of the package, and the methods of its classes that are defined there."""
    found = {}
    for name in twinslip.__all__:
        one = getattr(twinslip, name)
        if inspect.isfunction(one):
            found[name] = one
        elif inspect.isclass(one):
            for method, body in inspect.getmembers(one):
                own = (getattr(body, "__module__", None) or "").startswith("twinslip")
                if own and callable(body) and not method.startswith("_"):
                    found[f"{name}.{method}"] = body
    return found


@pytest.mark.parametrize("name", sorted(public()))
def test_docstrings_have_their_sections(name: str) -> None:
    signature = inspect.signature(public()[name])
    text = (inspect.getdoc(public()[name]) or "").replace("\\_", "_")
    names = [parameter for parameter in signature.parameters if parameter != "self"]
    if names:
        assert "\nParameters\n----------\n" in text, name
    # Names on a line of their own, several with commas between them.
    lines = re.findall(r"^(\*{0,2}\w+(?:, \*{0,2}\w+)*)(?: : .*)?$", text, re.MULTILINE)
    documented = {one.strip("*") for line in lines for one in line.split(", ")}
    assert not set(names) - documented, name
    if signature.return_annotation not in ("None", inspect.Signature.empty):
        assert "\nReturns\n-------\n" in text, name


def test_examples_of_docstrings() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        failed, tried = doctest.testmod(twinslip)
    assert tried > 0 and failed == 0
