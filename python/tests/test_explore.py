"""The page of ``twinslip explore`` as a widget: its parts, and questions and answers through a comm that is no kernel's."""

from __future__ import annotations

import itertools
import json
import queue
import subprocess
import sys
import textwrap
import threading
import time
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from twinslip import InputError, System

pytest.importorskip("anywidget")

import comm
from comm.base_comm import BaseComm

SLAB = System(driving=10, stiffness=0.14)
#: The options of that system, as the page has them.
OPTIONS = {"driving": 10, "stiffness": 0.14}
#: A run that nobody waits for.
LONG = {**OPTIONS, "until": 1e9, "points": 100000, "max_steps": 10**7}
#: Seconds; what takes longer hangs.
PATIENCE = 60.0

#: Where programs run: not beside the sources of the package, which they would import.
HERE = Path(__file__).parent


class FakeComm(BaseComm):  # type: ignore[misc,unused-ignore]
    """A comm that keeps what the widget sends."""

    def __init__(self, *arguments: Any, **options: Any) -> None:
        self.opened: dict[str, Any] = {}
        self.sent: queue.Queue[dict[str, Any]] = queue.Queue()
        super().__init__(*arguments, **options)

    def publish_msg(self, msg_type: str, data: Any = None, *_: Any, **__: Any) -> None:
        # A kernel writes it as JSON, which has no NaN.
        data = json.loads(json.dumps(data, allow_nan=False))
        if msg_type == "comm_open":
            self.opened = data["state"]
        elif msg_type == "comm_msg" and data["method"] == "custom":
            self.sent.put(data["content"])


class Page:
    """The page of a widget, as far as messages go."""

    def __init__(self, system: System, **options: Any) -> None:
        self.widget: Any = system.explore(**options)
        self.comm: Any = self.widget.comm
        self.state = self.comm.opened
        self._came: dict[Any, list[dict[str, Any]]] = {}
        self._numbers = itertools.count()

    def send(self, content: Any) -> None:
        data = {"method": "custom", "content": content}
        self.comm.handle_msg({"content": {"data": data}, "buffers": []})

    def ask(self, number: Any, command: str, options: Any, background: bool = False) -> None:
        asked = {"command": command, "options": options, "background": background}
        self.send({"type": "ask", "id": number, **asked})

    def batch(self, seconds: float = PATIENCE) -> dict[str, Any]:
        """The next message."""
        message: dict[str, Any] = self.comm.sent.get(timeout=seconds)
        assert message["type"] == "lines" and message["lines"]
        self._came.setdefault(message["id"], []).extend(message["lines"])
        return message

    def answer(self, number: Any) -> list[dict[str, Any]]:
        """The lines of an answer, when all are there."""
        while not (number in self._came and is_last(self._came[number][-1])):
            self.batch()
        lines = self._came.pop(number)
        assert not any(map(is_last, lines[:-1]))
        return lines

    def asked(self, command: str, options: Any) -> list[dict[str, Any]]:
        """The answer to a question that is asked alone."""
        number = f"alone {next(self._numbers)}"
        self.ask(number, command, options)
        return self.answer(number)


def is_last(line: dict[str, Any]) -> bool:
    return "ended" in line or "error" in line


def table(lines: list[dict[str, Any]]) -> dict[str, list[Any]]:
    """The columns of an answer by their names."""
    names = next(line["columns"] for line in lines if "columns" in line)
    rows = [row for line in lines for row in line.get("rows", [])]
    return {name: [row[i] for row in rows] for i, name in enumerate(names)}


def result(lines: list[dict[str, Any]]) -> Any:
    return next(line["object"]["result"] for line in lines if "object" in line)


def answering() -> list[threading.Thread]:
    return [thread for thread in threading.enumerate() if thread.name == "twinslip explore"]


def computing() -> int:
    """The threads of this process that compute, or wait for a computation."""
    number = 0
    for task in Path("/proc/self/task").iterdir():
        # A thread may end between being listed and being read.
        with suppress(FileNotFoundError, ProcessLookupError):
            number += (task / "comm").read_text().startswith("twinslip")
    return number


def wait_for(come: Any) -> None:
    end = time.monotonic() + PATIENCE
    while not come():
        assert time.monotonic() < end
        time.sleep(0.01)


@pytest.fixture(autouse=True)
def _no_kernel(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Widgets have comms of ours; none leaves a thread behind."""
    monkeypatch.setattr(comm, "create_comm", FakeComm)
    yield
    import ipywidgets

    ipywidgets.Widget.close_all()
    assert answering() == []


def test_the_widget_has_the_page() -> None:
    page = Page(SLAB)
    assert (
        page.state["_esm"].rstrip().endswith("export default { render: twinslipExplore.render };")
    )
    assert ".twinslip" in page.state["_css"]
    begin = json.loads(page.state["begin"])
    assert begin["options"] == OPTIONS and begin["scene"] is None
    assert "lorenz" in begin["systems"] and begin["example"] and begin["glossary"]
    assert page.widget.layout.height is None
    # A notebook is told where to show it.
    shown = page.widget._repr_mimebundle_()
    assert "application/vnd.jupyter.widget-view+json" in shown[0]


def test_its_height() -> None:
    assert SLAB.explore(height=600).layout.height == "600px"
    assert SLAB.explore(height="80vh").layout.height == "80vh"
    for wrong in (0, -1.0, [3], float("nan")):
        with pytest.raises(InputError, match="height") as told:
            SLAB.explore(height=wrong)  # type: ignore[arg-type]
        assert told.value.field == "height"


def begun(system: System) -> Any:
    return json.loads(Page(system).state["begin"])["options"]


def test_it_begins_with_any_system(tmp_path: Path) -> None:
    assert begun(System()) == {}
    unequal = begun(System(driving=10, stiffness=0.14, residual_strength_2=0.002))
    assert unequal["set"] == ["residual_strength_2=0.002"]
    measured = begun(System(interfaces=1, driving="1nm/s", slip_length="10um"))
    assert measured["si"] is True and measured["driving"] == 1e-9 and measured["interfaces"] == 1
    assert begun(System.from_file("lorenz", r=24)) == {"system": "lorenz", "set": ["r=24.0"]}
    # Files are read here: the page knows none.
    own = System.from_function(lambda x, p: [x[1], -p.k * x[0]], ["x", "v"], {"k": 2.0})
    text = own._given["system"]
    (tmp_path / "own.toml").write_text(text)
    assert begun(own)["system"] == text
    assert begun(System.from_file(tmp_path / "own.toml"))["system"].rstrip() == text.rstrip()


def test_what_is_wrong_is_raised_where_it_is_made(tmp_path: Path) -> None:
    for system, field in [
        (System(driving=-1, stiffness=1), "driving"),
        (System("spinodl", driving=1, stiffness=1), "law"),
        (System(driving=1, stiffness=1, nonsense=3), "nonsense"),
        (System.from_file(tmp_path / "nowhere.toml"), "system"),
    ]:
        with pytest.raises(InputError) as told:
            system.explore()
        assert told.value.field == field


def test_numbers_are_those_of_the_methods_to_the_last_bit() -> None:
    page = Page(SLAB)
    orbit = SLAB.orbit()
    told = result(page.asked("orbit", OPTIONS))["orbit"]
    assert told["period"] == {
        "value": orbit.period.value,
        "uncertainty": orbit.period.uncertainty,
    }
    assert [one["ln_abs"] for one in told["log_multipliers"]] == [
        {"value": one.ln_abs.value, "uncertainty": one.ln_abs.uncertainty}
        for one in orbit.log_multipliers
    ]
    run = SLAB.integrate(until=20.0, points=1001)
    columns = table(page.asked("integrate", {**OPTIONS, "until": 20, "points": 1001}))
    assert len(columns["time"]) == 1001
    for name, values in columns.items():
        assert np.array_equal(np.array(values), run[name]), name
    branch = SLAB.branch("equilibria", along="driving", range=(0.05, 300))
    options = {"stiffness": 0.14, "of": "equilibria", "along": "driving=0.05:300"}
    columns = table(page.asked("branch", options))
    assert np.array_equal(np.array(columns["stress"]), np.asarray(branch["stress"]))


def test_a_model_describes_itself() -> None:
    model = result_of_model(Page(System.from_file("lorenz")).asked("model", {"system": "lorenz"}))
    assert [state["name"] for state in model["states"]] == ["x", "y", "z"]
    assert {"r", "s"} <= {parameter["name"] for parameter in model["parameters"]}


def result_of_model(lines: list[dict[str, Any]]) -> Any:
    assert lines[-1] == {"ended": "done"}
    return lines[0]["object"]


def test_lines_come_while_it_computes_and_stop_ends_it() -> None:
    before = computing()
    page = Page(SLAB)
    page.ask(7, "integrate", LONG)
    first = page.batch()
    assert first["id"] == 7 and "columns" in first["lines"][0]
    while not any("rows" in line for line in page.batch()["lines"]):
        pass
    assert len(answering()) == 1
    page.send({"type": "stop", "id": 7})
    wait_for(lambda: not answering())
    # Its computation ends, too, and what was sent before is all that comes.
    # Threads of computations before may have ended meanwhile.
    wait_for(lambda: computing() <= before)
    while not page.comm.sent.empty():
        assert not any(map(is_last, page.batch()["lines"]))


def test_lines_come_in_batches() -> None:
    page = Page(SLAB)
    began = time.monotonic()
    page.ask(1, "integrate", {**LONG, "until": 1e5, "points": 20000})
    batches = 0
    while not any(map(is_last, page.batch()["lines"])):
        batches += 1
    assert batches <= (time.monotonic() - began) / 0.04 + 1


def test_errors_are_lines() -> None:
    page = Page(SLAB)
    for command, options, field, words in [
        ("fit", {}, "command", "must be one of"),
        (None, {}, "command", "must be one of"),
        ("integrate", OPTIONS, "until", "until"),
        ("integrate", {**OPTIONS, "until": -1}, "until", "positive"),
        ("integrate", {**OPTIONS, "untill": 1}, "untill", "did you mean"),
        ("integrate", {**OPTIONS, "until": [{}]}, "until", "number"),
        ("orbit", 5, None, "no JSON object"),
        ("orbit", {"x": "y" * 2**20}, None, "longer"),
        ("model", {"driving": -1}, "driving", "positive"),
    ]:
        [line] = page.asked(command, options)  # type: ignore[arg-type]
        error = line["error"]
        assert error["kind"] == "input" and error["field"] == field, line
        assert words in error["message"]
    # A computation that fails keeps its rows.
    lines = page.asked("integrate", {**OPTIONS, "until": 1e4, "max_steps": 50})
    assert lines[-1]["error"]["kind"] == "numerical" and table(lines)["time"]


def test_no_option_names_a_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "own.toml").write_text(System.from_file("lorenz").explore().begin)
    before = sorted(tmp_path.iterdir())
    page = Page(SLAB)
    for options in [
        {"output": "out.csv"},
        {"plot": "out.svg"},
        {"events": "events.csv"},
        {"checkpoint": "here"},
        {"resume": "out.csv"},
        {"format": "json"},
        {"force": True},
        {"system": "own.toml"},
        {"system": str(tmp_path / "own.toml")},
        {"law": "own.toml"},
        {"program": "program.csv"},
        {"ensemble": "fit.json"},
        {"threads": 3},
    ]:
        [line] = page.asked("integrate", {**OPTIONS, "until": 1, **options})
        assert line["error"]["kind"] == "input", options
        assert line["error"]["field"] == next(iter(options))
    assert sorted(tmp_path.iterdir()) == before


def test_messages_that_are_none_are_not_answered() -> None:
    page = Page(SLAB)
    for content in [None, 5, [], {}, {"type": "ask"}, {"type": "ask", "id": None}, {"id": 3}]:
        page.send(content)
    page.send({"type": "stop", "id": 12})
    assert page.asked("equilibria", OPTIONS)[-1] == {"ended": "done"}
    assert page.comm.sent.empty()


def test_many_questions_at_once() -> None:
    page = Page(SLAB)
    for number in range(40):
        page.ask(number, "equilibria", {**OPTIONS, "driving": 1 + number}, number % 3 == 0)
    told = [result(page.answer(number))["equilibria"][0]["stress"] for number in range(40)]
    assert len({json.dumps(one) for one in told}) == 40
    # More are refused, each in a line.
    for number in range(100):
        page.ask(number, "integrate", LONG)
    refused = 0
    while refused < 30:
        message = page.batch()
        if is_last(message["lines"][-1]):
            assert "wait already" in message["lines"][-1]["error"]["message"]
            refused += 1
    page.widget.close()
    assert answering() == []


def test_a_widget_that_is_closed_or_shown_again_stops() -> None:
    before = computing()
    for leave in [
        lambda page: page.widget._repr_mimebundle_(),
        lambda page: page.comm.handle_close({}),
        lambda page: page.widget.close(),
    ]:
        page = Page(SLAB)
        page.ask(1, "integrate", LONG)
        page.ask(2, "integrate", LONG, True)
        page.batch()
        leave(page)
        assert answering() == []
        # Threads of computations before may have ended meanwhile.
        wait_for(lambda: computing() <= before)
    # A page that is still there is told, and may ask again.
    page = Page(SLAB)
    page.ask(1, "integrate", LONG)
    page.batch()
    page.widget._repr_mimebundle_()
    assert page.answer(1)[-1]["error"]["kind"] == "stopped"
    assert page.asked("equilibria", OPTIONS)[-1] == {"ended": "done"}


def test_widgets_do_not_mix() -> None:
    one, other = Page(SLAB), Page(System.from_file("lorenz"))
    one.ask(1, "equilibria", OPTIONS)
    other.ask(1, "equilibria", {"system": "lorenz"})
    assert "stress" in result(one.answer(1))["equilibria"][0]
    assert "stress" not in result(other.answer(1))["equilibria"][0]


def test_without_anywidget_it_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delitem(sys.modules, "twinslip._explore", raising=False)
    monkeypatch.setitem(sys.modules, "anywidget", None)
    with pytest.raises(ImportError, match=r"^explore needs anywidget: pip install anywidget"):
        SLAB.explore()


def test_a_program_ends_while_the_page_asks() -> None:
    program = textwrap.dedent("""
        import threading
        from twinslip import System
        widget = System(driving=10, stiffness=0.14).explore()
        options = dict(driving=10, stiffness=0.14, until=1e9, points=100000, max_steps=10**7)
        for number in range(20):
            widget._receive(widget, dict(type="ask", id=number, command="integrate", options=options), [])
        print(sum(thread.name == "twinslip explore" for thread in threading.enumerate()))
    """)
    ended = subprocess.run(
        [sys.executable, "-c", program],
        capture_output=True,
        text=True,
        check=False,
        timeout=100,
        cwd=HERE,
    )
    assert (ended.returncode, ended.stdout, ended.stderr) == (0, "20\n", "")
