"""The page as the widget of a notebook: its module in a page of another kind, wired to ``System.explore()`` of Python."""

import queue
import threading
import time

import pytest

pytest.importorskip("anywidget")
twinslip = pytest.importorskip("twinslip")

import comm  # noqa: E402
from comm.base_comm import BaseComm  # noqa: E402

#: A page that has not come so far by then hangs.
PATIENCE = 120.0
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
() => [...document.querySelectorAll("html, body, body > :not(#cell), body > :not(#cell) *")].map((element) => {
  const style = getComputedStyle(element);
  return [element.tagName, ...[...style].filter((name) => !/block-size|inline-size|height|width|origin/.test(name)).map((name) => `${name}: ${style.getPropertyValue(name)}`)];
})
"""


class FakeComm(BaseComm):
    """Keeps what the widget sends until the page takes it, the objects of answers, and how they have ended."""

    def __init__(self, *arguments, **options):
        self.sent, self.ended, self.objects = queue.Queue(), {}, {}
        super().__init__(*arguments, **options)

    def publish_msg(self, msg_type, data=None, *_, **__):
        if msg_type == "comm_msg" and data["method"] == "custom":
            self.sent.put(data["content"])

    def take(self):
        messages = []
        while not self.sent.empty():
            message = self.sent.get()
            messages.append(message)
            self.objects.update({message["id"]: line["object"] for line in message["lines"] if "object" in line})
            last = message["lines"][-1]
            if "ended" in last or "error" in last:
                self.ended[message["id"]] = last
        return messages


class Notebook:
    """A page that shows a widget."""

    def __init__(self, page, widget, width):
        self.page, self.widget, self.asked, self.wrong = page, widget, [], []
        page.on("pageerror", lambda error: self.wrong.append(f"{error} {error.stack}"))
        page.on("console", lambda message: self.wrong.append(message.text) if message.type in ("error", "warning") else None)
        page.expose_function("toKernel", self.receive)
        page.expose_function("fromKernel", widget.comm.take)
        page.route("http://notebook.test/", lambda route: route.fulfill(body=NOTEBOOK.replace("WIDTH", str(width)), content_type="text/html"))
        page.goto("http://notebook.test/")
        self.before = page.evaluate(STYLES)
        page.evaluate(MODEL, {"script": widget._esm, "style": widget._css, "begin": widget.begin})
        self.verdict = page.locator(".pane-verdict .headline").first

    def receive(self, content):
        """Hands a message of the page to the widget."""
        self.asked.append(content)
        self.widget.comm.handle_msg({"content": {"data": {"method": "custom", "content": content}}, "buffers": []})

    def wait(self, come):
        """Waits until this is true, while messages go to and fro."""
        end = time.monotonic() + PATIENCE
        while not come():
            assert time.monotonic() < end, self.page.inner_text("body")[:3000]
            self.page.wait_for_timeout(50)

    def questions(self, command):
        """All that this command was asked."""
        return [one for one in self.asked if one["type"] == "ask" and one["command"] == command]

    def answered(self, command, count=1):
        """Waits for the answer to the last question for a command, which was asked so many times at least; its options."""
        is_there = lambda: len(self.questions(command)) >= count and self.questions(command)[-1]["id"] in self.widget.comm.ended
        self.wait(is_there)
        self.page.wait_for_timeout(300)
        self.wait(is_there)
        return self.questions(command)[-1]["options"]


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
    page.answered("integrate")
    assert {"driving": 10, "stiffness": 0.14}.items() <= page.answered("orbit").items()
    assert page.verdict.inner_text().lower() == "periodic"
    diagram = page.page.locator(".pane-diagram canvas").first
    assert diagram.get_attribute("aria-label")
    asked = len(page.questions("orbit"))
    box = diagram.bounding_box()
    page.page.mouse.click(box["x"] + 0.9 * box["width"], box["y"] + 0.2 * box["height"])
    clicked = page.answered("orbit", asked + 1)
    assert clicked["driving"] > 100 and clicked["stiffness"] > 0.14
    there = SLAB.replace(driving=clicked["driving"], stiffness=clicked["stiffness"])
    page.answered("equilibria", asked + 1)
    shown = page.widget.comm.objects[page.questions("equilibria")[-1]["id"]]["result"]["equilibria"]
    assert [one["stress"]["value"] for one in shown] == [one.stress.value for one in there.equilibria()]
    page.wait(lambda: page.verdict.inner_text().lower() == "steady")
    # The address is the notebook's.
    assert page.page.url == "http://notebook.test/"


def test_the_notebook_stays_as_it_is(notebook):
    page = notebook(SLAB)
    page.answered("orbit")
    page.page.get_by_role("button", name="Theme").click()
    page.page.get_by_role("button", name="Glossary").click()
    page.page.locator(".twinslip dialog[open]").get_by_role("button", name="Close").click()
    assert page.page.evaluate(STYLES) == page.before
    assert page.page.evaluate("Object.keys(document.documentElement.dataset)") == []


def test_its_theme_is_that_of_the_notebook(notebook):
    page = notebook(SLAB)
    page.answered("equilibria")
    theme = page.page.get_by_role("button", name="Theme")
    scheme = lambda: page.page.evaluate("getComputedStyle(document.querySelector('.twinslip')).colorScheme")
    # A notebook that doesn't say leaves it to the browser.
    assert scheme() == "light dark"
    for is_light, expected in [("false", "dark"), ("true", "light")]:
        page.page.evaluate(f"document.body.dataset.jpThemeLight = '{is_light}'")
        for _ in range(3):
            theme.click()
        assert theme.inner_text() == "Theme: auto"
        assert scheme() == expected


def test_columns_follow_the_width_of_the_cell(notebook):
    for width, columns in [(1300, 3), (900, 2), (500, 1)]:
        page = notebook(SLAB, width)
        page.answered("equilibria")
        tracks = page.page.evaluate("getComputedStyle(document.querySelector('.twinslip main')).gridTemplateColumns")
        assert len(tracks.split()) == columns
        assert page.page.evaluate("(({ scrollWidth, clientWidth }) => scrollWidth - clientWidth)(document.querySelector('.twinslip'))") <= 0


def test_a_view_that_is_left_stops(notebook):
    page = notebook(SLAB)
    page.answered("model")
    page.wait(lambda: page.questions("locus"))
    page.page.evaluate("leave()")
    page.page.wait_for_timeout(500)
    asked = {one["id"] for one in page.asked if one["type"] == "ask"}
    stopped = {one["id"] for one in page.asked if one["type"] == "stop"}
    assert stopped and asked - stopped <= set(page.widget.comm.ended)
    assert page.page.evaluate("listeners.size") == 0
    assert threads() == []
    # The names of its questions are its own: another view has others.
    again = notebook(SLAB)
    again.answered("model")
    assert not asked & {one["id"] for one in again.asked}


def threads():
    return [thread for thread in threading.enumerate() if thread.name == "twinslip explore"]


def test_what_is_wrong_is_told_on_the_page(notebook):
    page = notebook(twinslip.System.from_file("lorenz"))
    page.answered("integrate")
    field = page.page.get_by_label("Start")
    field.fill("1, 2")
    field.press("Enter")
    page.wait(lambda: page.page.locator(".problem:visible, .message:visible").count())
