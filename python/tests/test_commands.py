"""Every command from Python gives the numbers of the command line, to the bit."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import twinslip
from twinslip import System

SLAB = System(driving=10, stiffness=0.14)
NEAR = System(driving=0.2, stiffness=0.05)
LORENZ = System.from_file("lorenz")
SI = System(
    "dieterich-ruina", interfaces=1, driving=1e-9, stiffness=1e9, si=True, slip_length=1e-5,
    direct_effect=0.010, evolution_effect=0.015, normal_stress=50e6, shear_modulus=3e10,
    shear_wave_speed=3e3, time_unit="year",
)  # fmt: skip

CASES = {
    "law": (lambda: System().law(points=20), "law --points 20"),
    "law-range": (
        lambda: System("bounded").law(range=(1e-2, 1e2), points=7),
        "law --law bounded --from 1e-2 --to 1e2 --points 7",
    ),
    "integrate": (
        lambda: SLAB.integrate(start=[9.95, 0.002, 0.00199], until=20.0),
        "integrate --driving 10 --stiffness 0.14 --start 9.95,0.002,0.00199 --until 20",
    ),
    "integrate-points": (
        lambda: SLAB.integrate(until=20.0, points=11, rtol=1e-12, estimate_error=True),
        "integrate --driving 10 --stiffness 0.14 --until 20 --points 11 --rtol 1e-12 --estimate-error",
    ),
    "integrate-events": (
        lambda: NEAR.integrate(until=2000, events=True, every=100),
        "integrate --driving 0.2 --stiffness 0.05 --until 2000 --events --every 100",
    ),
    "integrate-program": (
        lambda: SLAB.integrate(until=30, program=[(10, 1.0), ((15, 20), 5.0), (25, 0)]),
        "integrate --driving 10 --stiffness 0.14 --until 30 --program 10:1,15-20:5,25:0",
    ),
    "integrate-many": (
        lambda: System(driving=10, stiffness=0.14, interfaces=20).integrate(
            start="spread:0.01:3", until=2, draw={"healing_time": (50, 200, "log")}, seed=4
        ),
        "integrate --driving 10 --stiffness 0.14 --interfaces 20 --start spread:0.01:3 --until 2 "
        "--draw healing_time=50:200log --seed 4",
    ),
    "integrate-own": (
        lambda: LORENZ.integrate(until=2, method="rodas5p"),
        "integrate --system lorenz --until 2 --method rodas5p",
    ),
    "integrate-si": (
        lambda: SI.integrate(until=50, points=9),
        "integrate --law dieterich-ruina --interfaces 1 --driving 1e-9 --stiffness 1e9 --si --slip-length 1e-5 "
        "--direct-effect 0.010 --evolution-effect 0.015 --normal-stress 50e6 --shear-modulus 3e10 "
        "--shear-wave-speed 3e3 --time-unit year --until 50 --points 9",
    ),
    "equilibria": (lambda: SLAB.equilibria(), "equilibria --driving 10 --stiffness 0.14"),
    "equilibria-unequal": (
        lambda: System(driving=10, stiffness=0.14, residual_strength_2=0.002).equilibria(),
        "equilibria --driving 10 --stiffness 0.14 --set residual_strength_2=0.002",
    ),
    "equilibria-box": (
        lambda: LORENZ.equilibria(box={"x": (-20, 20), "y": (-20, 20), "z": (-1, 50)}),
        "equilibria --system lorenz --box x=-20:20,y=-20:20,z=-1:50",
    ),
    "equilibria-clusters": (
        lambda: System(driving=10, stiffness=0.14, interfaces=5).equilibria(),
        "equilibria --driving 10 --stiffness 0.14 --interfaces 5",
    ),
    "orbit": (
        lambda: SLAB.orbit(symmetry="asymmetric"),
        "orbit --driving 10 --stiffness 0.14 --symmetry asymmetric",
    ),
    "orbit-points": (
        lambda: SLAB.orbit(symmetry="asymmetric", points=9, crosscheck="none"),
        "orbit --driving 10 --stiffness 0.14 --symmetry asymmetric --points 9 --crosscheck none",
    ),
    "section": (
        lambda: SLAB.section(returns=100, lyapunov=True),
        "section --driving 10 --stiffness 0.14 --returns 100 --lyapunov",
    ),
    "branch": (
        lambda: SLAB.branch("equilibria", range=(0.05, 300)),
        "branch equilibria --stiffness 0.14 --from 0.05 --to 300",
    ),
    "branch-orbits": (
        lambda: SLAB.branch("orbits", along="driving", range=(1, 3), symmetry="symmetric"),
        "branch orbits --stiffness 0.14 --from 1 --to 3 --symmetry symmetric",
    ),
    "branch-own": (
        lambda: LORENZ.branch("equilibria", along="r", range=(0.5, 30), start=(0, 0, 0)),
        "branch equilibria --system lorenz --along r --from 0.5 --to 30 --start 0,0,0",
    ),
    "locus": (
        lambda: SLAB.locus("hopf", driving=(0.1, 100), stiffness=(0.05, 0.3)),
        "locus hopf --driving-range 0.1:100 --stiffness-range 0.05:0.3",
    ),
    "locus-within": (
        lambda: SLAB.locus(
            "pitchfork", within=("driving", "residual_strength"), driving=(1, 100),
            residual_strength=(5e-4, 0.2),
        ),
        "locus pitchfork --stiffness 0.14 --in driving,residual_strength --range driving=1,100 "
        "--range residual_strength=5e-4,0.2",
    ),
    "sweep": (
        lambda: System().sweep(driving=(0.14, 0.5, 3), stiffness=(0.05, 0.15, 2, "log")),
        "sweep --driving 0.14:0.5:3 --stiffness 0.05:0.15:2log",
    ),
    "sweep-grid": (
        lambda: LORENZ.sweep(grid={"r": (10, 30, 3)}),
        "sweep --system lorenz --grid r=10:30:3",
    ),
}  # fmt: skip


def command_line(binary: Path, text: str) -> dict[str, Any]:
    done = subprocess.run(
        [str(binary), *text.split(), "--format", "json", "--quiet"],
        capture_output=True,
        check=False,
    )
    assert done.returncode in (0, 3), done.stderr.decode()
    found: dict[str, Any] = json.loads(done.stdout)
    return found


def flat(rows: list[dict[str, Any]]) -> dict[str, list[Any]]:
    """Rows as columns, bounds in columns of their own."""
    columns: dict[str, list[Any]] = {}
    for i, row in enumerate(rows):
        for name, value in row.items():
            if isinstance(value, Mapping):
                pairs = [(name, value["value"]), (f"{name}_uncertainty", value["uncertainty"])]
            else:
                pairs = [(name, value)]
            for key, cell in pairs:
                column = columns.setdefault(key, [None] * i)
                column += [None] * (i - len(column))
                column.append(cell)
    return columns


def same(found: Any, expected: Any, where: str) -> None:
    """That what Python has is what JSON has, to the bit."""
    if isinstance(expected, Mapping):
        if set(expected) == {"value", "uncertainty"}:
            if expected["value"] is None:
                assert found is None, where
                return
            assert found.value == expected["value"], where
            assert (
                expected["uncertainty"] is None or found.uncertainty == expected["uncertainty"]
            ), where
            return
        assert set(found) == set(expected), where
        for name, value in expected.items():
            same(found[name], value, f"{where}.{name}")
    elif isinstance(expected, list):
        assert len(found) == len(expected), where
        complex_numbers = isinstance(found, np.ndarray) and found.dtype.kind == "c"
        for i, value in enumerate(expected):
            if complex_numbers:
                assert [found[i].real, found[i].imag] == value, where
            else:
                same(found[i], value, f"{where}[{i}]")
    else:
        assert found == expected, where


@pytest.mark.filterwarnings("ignore::twinslip.UndecidedWarning")
@pytest.mark.parametrize("name", CASES)
def test_numbers_are_those_of_the_command_line(name: str, binary: Path) -> None:
    make, text = CASES[name]
    result = make()
    expected = command_line(binary, text)
    rows = flat(expected["result"].pop("rows", []))
    for key in ("model", "units", "numerics", "result"):
        same(getattr(result, key), expected[key], key)
    assert set(result.columns) >= set(rows)
    for column, cells in rows.items():
        values = result[column]
        missing = np.ma.getmaskarray(values)
        assert len(values) == len(cells), column
        for value, hidden, cell in zip(np.ma.getdata(values), missing, cells):
            assert hidden == (cell is None), column
            # What is a word in one row of a sweep, as "2;1", is no number in the others of its JSON.
            assert hidden or value == cell or str(value) == cell, column
    empty = set(result.columns) - set(rows)
    assert all(np.ma.getmaskarray(result[column]).all() for column in empty), empty


def test_every_command_has_its_arguments() -> None:
    """What the methods take is what the command line takes."""
    import inspect

    from twinslip import _core, _words

    left_out = {
        "output", "format", "force", "quiet", "explain", "plot", "plot_events", "resume",
        "checkpoint", "checkpoint_steps", "shard", "plot_parameters", "plot_law", "plot_holds",
        "plot_records", "report", "look",
    }  # fmt: skip
    for command, _ in _core.commands():
        taken = set(inspect.signature(getattr(System, command)).parameters) - {"self", "progress"}
        known = set(_words.options(command)) - left_out
        own = {"sweep": {"driving", "stiffness"}, "locus": {"driving", "stiffness"}}
        own["fit"] = {"stiffness"}
        known -= set(_words.model_options()) - own.get(command, set())
        if command == "law":
            known -= {"data"}
        if command in ("branch", "law"):
            known = known - {"from_", "to"} | {"range"}
        if command == "locus":
            known = known - {"driving_range", "stiffness_range", "driving", "stiffness"} | {
                "ranges"
            }
        assert taken == known, command
    model = set(inspect.signature(System.__init__).parameters) - {"self", "parameters"}
    assert model == set(_words.model_options()) - {"set"}


def test_scenes_run_as_their_commands(binary: Path) -> None:
    result = twinslip.run("fig13")
    assert type(result).__name__ == "Trajectory"
    done = subprocess.run(
        [str(binary), "run", "fig13", "--format", "json", "--quiet"],
        capture_output=True,
        check=True,
    )
    expected = json.loads(done.stdout)["result"]
    same(result.final, expected["final"], "final")
    assert len(result) == len(expected["rows"])
    assert "fig12" in twinslip.scenes()
    with pytest.raises(twinslip.InputError) as told:
        twinslip.run("fig21")
    assert told.value.field == "scene" and "fig12" in str(told.value)


def test_the_paper_is_reproduced_as_by_the_command(binary: Path, tmp_path: Path) -> None:
    twinslip.reproduce(tmp_path / "a", only="fig01")
    subprocess.run(
        [str(binary), "reproduce", "--only", "fig01", "--out", str(tmp_path / "b"), "--quiet"],
        check=True,
    )
    ours = (tmp_path / "a" / "fig01.csv").read_text().splitlines()
    theirs = (tmp_path / "b" / "fig01.csv").read_text().splitlines()
    assert ours == theirs
    again = twinslip.reproduce(tmp_path / "a", only="fig01")
    assert any("up to date" in line for line in again)
    twinslip.figure(1, tmp_path / "c")
    assert (tmp_path / "c" / "fig01.svg").exists()
    with pytest.raises(twinslip.InputError):
        twinslip.figure(99, tmp_path)
