"""What editors and checkers of types are told is what is there."""

from __future__ import annotations

import ast
import inspect
import subprocess
import sys
from pathlib import Path

import pytest

import twinslip
from twinslip import _core

PACKAGE = Path(twinslip.__file__).parent
SOURCES = Path(__file__).resolve().parents[1]


def run(where: Path, *words: str) -> None:
    ended = subprocess.run(
        [sys.executable, *words], capture_output=True, text=True, cwd=where, check=False
    )
    assert ended.returncode == 0, ended.stdout + ended.stderr


def test_types_are_complete() -> None:
    run(SOURCES, "-m", "mypy", "--strict", "twinslip", "scripts/write-commands")


def test_types_of_the_compiled_part_are_those_of_the_module(tmp_path: Path) -> None:
    run(tmp_path, "-m", "mypy.stubtest", "twinslip._core")


def test_every_name_of_the_compiled_part_is_typed() -> None:
    tree = ast.parse((PACKAGE / "_core.pyi").read_text())
    typed: dict[str, set[str]] = {}
    for node in tree.body:
        if isinstance(node, ast.ClassDef):
            typed[node.name] = {one.name for one in node.body if isinstance(one, ast.FunctionDef)}
        elif isinstance(node, ast.FunctionDef):
            typed[node.name] = set()
    public = {name for name in dir(_core) if not name.startswith("__")}
    assert public == set(_core.__all__)
    assert public == set(typed)
    for name, members in typed.items():
        if inspect.isclass(getattr(_core, name)):
            there = {member for member in vars(getattr(_core, name)) if not member.startswith("__")}
            assert there == {member for member in members if not member.startswith("__")}, name


def test_commands_are_written_from_the_options() -> None:
    if twinslip.sundials() is None:
        pytest.skip("their help names the methods of SUNDIALS")
    run(SOURCES, "scripts/write-commands", "--check")


def test_every_public_name_is_documented() -> None:
    for name in twinslip.__all__:
        thing = getattr(twinslip, name)
        if name == "__version__":
            continue
        # Its own, not that of a class above it.
        assert vars(thing).get("__doc__") if inspect.isclass(thing) else inspect.getdoc(thing), name
        if inspect.isclass(thing):
            for member, value in vars(thing).items():
                if not member.startswith("_") and (
                    inspect.isfunction(value) or isinstance(value, property)
                ):
                    assert inspect.getdoc(value), f"{name}.{member}"
    assert (PACKAGE / "py.typed").exists()
