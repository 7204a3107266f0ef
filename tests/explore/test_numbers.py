"""What the page shows are the numbers of the command line."""

import json
import random
import shlex
import subprocess

from conftest import PROGRAM

#: Twenty points of the (V_H, K) diagram, drawn once.
POINTS = [(10 ** random.Random(i).uniform(-1.5, 3), random.Random(100 + i).uniform(0.03, 0.45)) for i in range(20)]


def commanded(line, folder=None):
    """The object of a command line."""
    words = shlex.split(line)
    assert words[0] == "twinslip"
    done = subprocess.run([PROGRAM, *words[1:], "--format", "json", "-q"], capture_output=True, text=True, cwd=folder)
    return json.loads(done.stdout) if done.stdout else None


def flat(row):
    """A row of an object by the names of columns: a number with its bound is two."""
    named = {}
    for name, value in row.items():
        if isinstance(value, dict):
            named[name], named[f"{name}_uncertainty"] = value["value"], value["uncertainty"]
        else:
            named[name] = value
    return named


def assert_same(answer, told):
    """The answer of the page and the object of the command line are equal, bit for bit."""
    result = dict(told["result"])
    rows = result.pop("rows", None)
    shown = dict(answer["object"]["result"])
    shown.pop("rows", None)
    assert shown == result
    if rows is not None and answer["columns"]:
        assert len(answer["rows"]) == len(rows)
        for cells, row in zip(answer["rows"], rows):
            named = flat(row)
            for name, cell in zip(answer["columns"], cells):
                if name in named:
                    assert cell == named[name], name


def test_twenty_clicked_points(slab, explored):
    page = explored(slab.address)
    page.idle()
    for x, y in POINTS:
        page.click(x, y)
        for slot, pane in [("run:0", "run"), ("equilibria:0", "spectrum"), ("section:0", "returns")]:
            answer = page.answer(slot)
            line = page.taken_away(pane, "Command line")
            told = commanded(line)
            if answer["error"]:
                assert told is None
            else:
                assert_same(answer, told)
        orbit = page.answer("orbit:0")
        told = commanded(page.value("(() => { const a = twinslip.engine.current.get('orbit:0').answer; return twinslip.points[0].verdict.commandText(a); })()"))
        assert (told is None) == (orbit["error"] is not None)
        if told:
            assert_same(orbit, told)


def test_curves_and_branches(slab, explored):
    page = explored(slab.address)
    page.idle(curves=True)
    for slot in ["locus:hopf", "locus:pitchfork", "locus:period-doubling", "branch:x:equilibria", "branch:x:orbits", "branch:y:orbits"]:
        line = page.value(f"(() => {{ const a = twinslip.engine.current.get({slot!r}).answer; return twinslip.diagram.commandText(a); }})()")
        assert_same(page.answer(slot), commanded(line))


def test_scene_and_python_lines(slab, explored, tmp_path):
    """The scene file runs, and gives what the command line gives."""
    page = explored(slab.address)
    page.idle()
    (tmp_path / "scene.toml").write_text(page.taken_away("run", "Scene"))
    done = subprocess.run([PROGRAM, "run", "scene.toml", "--format", "json", "-q"], capture_output=True, text=True, cwd=tmp_path, check=True)
    assert_same(page.answer("run:0"), json.loads(done.stdout))
    lines = page.taken_away("run", "Python")
    compile(lines, "lines", "exec")
    assert "twinslip.System(" in lines and ".integrate(" in lines
