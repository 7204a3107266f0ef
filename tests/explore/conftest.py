"""The page of ``twinslip explore`` in Chromium: a server for each test file, a fresh browser page for each test."""

import os
import pathlib
import re
import shutil
import subprocess
import time

import pytest
from playwright.sync_api import sync_playwright

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = os.environ.get("TWINSLIP", str(ROOT / "target/release/twinslip"))
SHOTS = pathlib.Path(os.environ.get("TWINSLIP_SHOTS", ROOT / "target/explore-shots"))
#: A page that has not come so far by then hangs.
PATIENCE = 300.0


class Server:
    """A running ``twinslip explore``."""

    def __init__(self, *options):
        words = [PROGRAM, "explore", "--no-browser", "--port", "0", *options]
        self.process = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        line = self.process.stdout.readline()
        self.address = re.search(r"http://127\.0\.0\.1:\d+/[0-9a-f]+/", line).group(0)

    def close(self):
        self.process.kill()
        self.process.wait()


class Explored:
    """A page of explore, with what it complained about."""

    def __init__(self, page, address):
        self.page, self.wrong = page, []
        page.on("pageerror", lambda error: self.wrong.append(f"{error} {error.stack}"))
        page.on("console", lambda message: self.wrong.append(message.text) if message.type in ("error", "warning") else None)
        page.goto(address)

    def value(self, expression):
        """The value of an expression of the page."""
        return self.page.evaluate(expression)

    def wait(self, expression):
        """Waits until the expression is true; the page's policy lets no one else evaluate it."""
        end = time.monotonic() + PATIENCE
        while time.monotonic() < end:
            if self.value(expression):
                return
            time.sleep(0.05)
        raise AssertionError(f"never: {expression}\n{self.page.inner_text('body')[:3000]}")

    def idle(self, curves=False):
        """Waits until all of the points is answered, and all curves and branches too if they are asked for."""
        behind = "" if curves else " && !/^(locus|branch|map|bands)/.test(slot)"
        works = f"[...twinslip.engine.current].some(([slot, one]) => one.busy{behind})"
        still = f"globalThis.twinslip?.points && !twinslip.questions.asked && !({works})"
        self.wait(still)
        # What waits for the page to settle begins by then.
        self.page.wait_for_timeout(300)
        self.wait(still)

    def pane(self, name, index=0):
        """A pane by its name."""
        return self.page.locator(f".pane-{name}").nth(index)

    def place(self, x, y):
        """The place in the window of values in the diagram."""
        at = self.value(f"(() => {{ const d = twinslip.diagram; const b = d.canvas.getBoundingClientRect(); const p = d.hits.toPixel({x}, {y}); return [b.left + p.x, b.top + p.y]; }})()")
        return tuple(at)

    def click(self, x, y):
        """Clicks the diagram at these values and waits for all answers."""
        self.page.mouse.click(*self.place(x, y))
        self.idle()

    def answer(self, slot):
        """The answer that is shown of a slot: command, options, columns, rows, object."""
        parts = "({ command: a.command, options: a.options, columns: a.columns, rows: a.rows, object: a.object, error: a.error, says: a.says })"
        return self.value(f"(() => {{ const a = twinslip.engine.current.get({slot!r}).answer; return {parts}; }})()")

    def taken_away(self, name, item, index=0):
        """What an item of a pane's menu shows."""
        pane = self.pane(name, index)
        pane.locator("button.menu").click()
        pane.get_by_role("menuitem", name=item).click()
        dialog = self.page.locator("dialog[open]")
        text = dialog.locator("pre").inner_text()
        dialog.get_by_role("button", name="Close").click()
        return text

    def downloaded(self, act):
        """The content of the file that an act hands out."""
        with self.page.expect_download() as waiting:
            act()
        return pathlib.Path(waiting.value.path()).read_bytes()

    def shot(self, name):
        """Keeps a picture of the page."""
        SHOTS.mkdir(parents=True, exist_ok=True)
        self.page.screenshot(path=SHOTS / f"{name}.png", full_page=True)


@pytest.fixture(scope="session")
def browser():
    with sync_playwright() as player:
        chromium = player.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
        yield chromium
        chromium.close()


@pytest.fixture(scope="session")
def slab():
    """The server of two interfaces."""
    server = Server()
    yield server
    server.close()


@pytest.fixture
def explored(browser):
    """Opens addresses; nothing may have gone wrong in the end."""
    contexts, pages = [], []

    def open_page(address, width=1400, height=900, **options):
        context = browser.new_context(viewport={"width": width, "height": height}, accept_downloads=True, **options)
        context.set_default_timeout(1000 * PATIENCE)
        contexts.append(context)
        pages.append(Explored(context.new_page(), address))
        return pages[-1]

    yield open_page
    wrong = [text for page in pages for text in page.wrong]
    for context in contexts:
        context.close()
    assert wrong == []


@pytest.fixture
def served():
    """Starts servers of other systems."""
    servers = []

    def start(*options):
        servers.append(Server(*options))
        return servers[-1]

    yield start
    for server in servers:
        server.close()
