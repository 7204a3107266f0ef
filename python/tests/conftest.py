"""What all tests share: the command that was built, and runs of it."""

from __future__ import annotations

import csv
import json
import os
import subprocess
from pathlib import Path
from typing import Any, Callable, cast

import pytest

REPOSITORY = Path(__file__).resolve().parents[2]
#: Another place of the command than where `cargo build` puts it.
VARIABLE = "TWINSLIP_BINARY"


def pytest_configure(config: pytest.Config) -> None:
    """The marks of SciPy's own tests."""
    for mark in ("fail_slow", "slow", "thread_unsafe"):
        config.addinivalue_line("markers", f"{mark}: SciPy's")


@pytest.fixture(scope="session")
def binary() -> Path:
    """The command. Where it is not there tests fail: they say nothing without it."""
    path = Path(os.environ.get(VARIABLE, REPOSITORY / "target" / "debug" / "twinslip"))
    if not path.is_file():
        pytest.fail(f"{path} is not there: run cargo build, or set {VARIABLE} to the command")
    return path


@pytest.fixture(scope="session")
def command(binary: Path) -> Callable[..., str]:
    """Runs the command with these words, and gives what it writes."""

    def run(*words: str) -> str:
        ended = subprocess.run(
            [str(binary), *words, "-q"], capture_output=True, text=True, check=False, timeout=300
        )
        assert ended.returncode == 0, ended.stderr
        return ended.stdout

    return run


@pytest.fixture(scope="session")
def made(command: Callable[..., str]) -> Callable[..., dict[str, Any]]:
    """The object that a command writes."""

    def run(*words: str) -> dict[str, Any]:
        return cast("dict[str, Any]", json.loads(command(*words, "--format", "json")))

    return run


@pytest.fixture(scope="session")
def rows(command: Callable[..., str]) -> Callable[..., tuple[list[str], list[list[float]]]]:
    """The columns and rows that a command writes."""

    def run(*words: str) -> tuple[list[str], list[list[float]]]:
        text = command(*words, "--format", "csv")
        lines = [line for line in text.splitlines() if not line.startswith("#")]
        columns, *others = csv.reader(lines)
        return columns, [[float(cell) for cell in row] for row in others]

    return run
