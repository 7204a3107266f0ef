"""The page as the widget of a notebook: its module in a page of another kind, wired to ``System.explore()`` of Python."""

import json
import queue
import sys

import pytest
from conftest import ROOT

pytest.importorskip("anywidget")
sys.path.insert(0, str(ROOT / "python"))
twinslip = pytest.importorskip("twinslip")

import comm  # noqa: E402
from comm.base_comm import BaseComm  # noqa: E402

#: A page with elements and styles of its own, which a widget must leave as they are.
NOTEBOOK = """<!DOCTYPE html>
<html><head><style>body { margin: 7px; }</style></head>
<body>
<main id="main"><header class="head"><h1 id="begin">begin</h1><button class="menu">Run</button></header>
<div class="column pane side message status"><label>Name <input type="text"></label><table><td>cell</td></table></div>
<dialog open>notes</dialog></main>
<div id="cell" style="width: WIDTHpx"></div>
</body></html>"""

#: A model of anywidget's, as much of it as the page uses.
MODEL = """
async ({ script, style, begin }) => {
  document.head.append(Object.assign(document.createElement("style"), { textContent: style }));
  const listeners = new Set();
  const model = {
    get: (name) => ({ begin })[name],
    on: (name, listener) => name === "msg:custom" && listeners.add(listener),
    off: (name, listener) => listeners.delete(listener),
    send: (content) => toKernel(content),
  };
  const take = async () => {
    for (const message of await fromKernel()) for (const listener of [...listeners]) listener(message, []);
    setTimeout(take, 20);
  };
  take();
  const address = URL.createObjectURL(new Blob([script], { type: "text/javascript" }));
  const widget = (await import(address)).default;
  globalThis.leave = await widget.render({ model, el: document.getElementById("cell") });
  globalThis.listeners = listeners;
}
"""

#: What the styles of the page come to in the elements of the notebook.
STYLES = """
() => [...document.querySelectorAll("html, body, body > :not(#cell), main *")].map((element) => {
  const style = getComputedStyle(element);
  return [element.tagName, ...[...style].filter((name) => !/block-size|inline-size|height|width|origin/.test(name)).map((name) => `${name}: ${style.getPropertyValue(name)}`)];
})
"""


class FakeComm(BaseComm):
    """Keeps what the widget sends until the page takes it."""

    def __init__(self, *arguments, **options):
        self.sent = queue.Queue()
        super().__init__(*arguments, **options)

    def publish_msg(self, msg_type, data=None, *_, **__):
        if msg_type == "comm_msg" and data["method"] == "custom":
            self.sent.put(data["content"])

    def take(self):
        messages = []
        while not self.sent.empty():
            messages.append(self.sent.get())
        return messages


class Notebook:
    """A page that shows a widget."""

    def __init__(self, page, widget, width):
        self.page, self.widget, self.asked, self.wrong = page, widget, [], []
        page.on("pageerror", lambda error: self.wrong.append(f"{error}"))
        page.on("console", lambda message: self.wrong.append(message.text) if message.type in ("error", "warning") else None)
        page.expose_function("toKernel", self.receive)
        page.expose_function("fromKernel", widget.comm.take)
        page.route("http://notebook.test/", lambda route: route.fulfill(body=NOTEBOOK.replace("WIDTH", str(width)), content_type="text/html"))
        page.goto("http://notebook.test/")
        self.before = page.evaluate(STYLES)
        page.evaluate(MODEL, {"script": widget._esm, "style": widget._css, "begin": widget.begin})

    def receive(self, content):
        self.asked.append(content)
        self.widget.comm.handle_msg({"content": {"data": {"method": "custom", "content": content}}, "buffers": []})

    def idle(self):
        self.page.locator(".twinslip[data-busy=true]").wait_for(state="attached")
        # Nothing for a while: between two answers it is not busy either.
        for _ in range(3):
            self.page.locator(".twinslip[data-busy=false]").wait_for(state="attached", timeout=120_000)
            self.page.wait_for_timeout(300)

    def last(self, command):
        """The options that a command was last asked with."""
        return [one["options"] for one in self.asked if one["type"] == "ask" and one["command"] == command][-1]


@pytest.fixture
def notebook(browser, monkeypatch):
    """Shows the widgets of systems in cells of some width; nothing may have gone wrong in the end."""
    monkeypatch.setattr(comm, "create_comm", FakeComm)
    shown, contexts = [], []

    def show(system, width=1300):
        context = browser.new_context(viewport={"width": 1400, "height": 900})
        contexts.append(context)
        shown.append(Notebook(context.new_page(), system.explore(), width))
        return shown[-1]

    yield show
    wrong = [text for one in shown for text in one.wrong]
    for one in shown:
        one.widget.close()
    for context in contexts:
        context.close()
    assert wrong == []


SLAB = twinslip.System(driving=10, stiffness=0.14)


def test_it_shows_the_diagram_and_a_click_answers(notebook):
    page = notebook(SLAB)
    page.idle()
    assert {"driving": 10, "stiffness": 0.14}.items() <= page.last("orbit").items()
    headline = page.page.locator(".pane-verdict .headline")
    assert headline.inner_text().lower() == "periodic"
    diagram = page.page.locator(".pane-diagram canvas").first
    assert diagram.get_attribute("aria-label")
    box = diagram.bounding_box()
    page.page.mouse.click(box["x"] + 0.9 * box["width"], box["y"] + 0.3 * box["height"])
    page.idle()
    clicked = page.last("orbit")
    assert clicked["driving"] > 20 and clicked["stiffness"] > 0.14
    there = SLAB.replace(driving=clicked["driving"], stiffness=clicked["stiffness"])
    equilibrium = next(iter(there.equilibria()))
    words = {"stable": "steady", "unstable": "periodic"}[str(equilibrium.verdict)]
    assert headline.inner_text().lower() in (words, "chaotic", "steady")
    # Nothing of it is in the address of the notebook.
    assert page.page.url == "http://notebook.test/"


def test_the_notebook_stays_as_it_is(notebook):
    page = notebook(SLAB)
    page.idle()
    page.page.get_by_role("button", name="Theme").click()
    page.page.wait_for_timeout(200)
    assert page.page.evaluate(STYLES) == page.before
    assert page.page.evaluate("Object.keys(document.documentElement.dataset)") == []


def test_columns_follow_the_width_of_the_cell(notebook):
    wide, narrow = notebook(SLAB, 1300), notebook(SLAB, 500)
    for page, columns in [(wide, 3), (narrow, 1)]:
        page.idle()
        tracks = page.page.evaluate("getComputedStyle(document.querySelector('.twinslip main')).gridTemplateColumns")
        assert len(tracks.split()) == columns
        width = page.page.evaluate("document.querySelector('.twinslip').scrollWidth - document.querySelector('.twinslip').clientWidth")
        assert width <= 0


def test_leaving_stops_and_two_views_do_not_mix(notebook):
    page = notebook(SLAB)
    page.page.wait_for_timeout(300)
    page.page.evaluate("leave()")
    page.page.wait_for_timeout(500)
    asked = {one["id"] for one in page.asked if one["type"] == "ask"}
    stopped = {one["id"] for one in page.asked if one["type"] == "stop"}
    assert stopped and stopped <= asked
    assert page.page.evaluate("listeners.size") == 0
    again = notebook(SLAB)
    again.idle()
    assert not asked & {one["id"] for one in again.asked}


def test_an_error_is_told(notebook):
    page = notebook(twinslip.System.from_file("lorenz"))
    page.idle()
    page.receive({"type": "ask", "id": "other", "command": "integrate", "options": {"system": "/etc/passwd", "until": 1}})
    [message] = [one for one in iter_messages(page) if one["id"] == "other"]
    assert "none of those that are built in" in json.dumps(message)


def iter_messages(page):
    """What comes for others than the page, which does not ask while it is not looked at."""
    kept = []
    end = 100
    while not any(one["id"] == "other" for one in kept) and end:
        kept += page.widget.comm.take()
        end -= 1
    return kept
