"""How fast the page of explore answers, by the clock of the browser, as a table in Markdown.

Run it on an idle machine: ``target/explore-python/bin/python tests/explore/times.py``.
"""

import shutil
import statistics
import time

from conftest import Explored, Server
from playwright.sync_api import sync_playwright

#: Pages that are opened anew, and places of a drag on each.
PAGES, PLACES = 5, 60
SYSTEMS = [("two interfaces", []), ("SI", ["--si"]), ("Lorenz", ["--system", "lorenz"])]


def measured(browser, options):
    """First paint, first answer, answers to drags, and the time until all curves are there, in milliseconds."""
    paint, curves, drags = [], [], []
    for _ in range(PAGES):
        server = Server(*options)
        context = browser.new_context(viewport={"width": 1400, "height": 900})
        page = Explored(context.new_page(), server.address)
        page.idle(curves=True)
        entries = lambda name, field: page.value(f"performance.getEntriesByName({name!r}).map((one) => one.{field})")
        paint += entries("first-contentful-paint", "startTime")
        curves += entries("twinslip curves", "duration")
        box = page.page.locator(".pane-diagram canvas").first.bounding_box()
        at = lambda part: (box["x"] + box["width"] * (0.2 + 0.6 * part), box["y"] + box["height"] * (0.3 + 0.4 * part))
        page.page.mouse.move(*at(0))
        page.page.mouse.down()
        for i in range(PLACES):
            page.page.mouse.move(*at(i / PLACES))
            time.sleep(0.03)
        page.page.mouse.up()
        page.idle()
        drags += entries("twinslip drag", "duration")
        context.close()
        server.close()
    return paint, curves, drags


def main():
    print("| system | first paint | answer to a drag, median | 95 of 100 | all curves |")
    print("|---|---|---|---|---|")
    with sync_playwright() as player:
        browser = player.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
        for name, options in SYSTEMS:
            paint, curves, drags = measured(browser, options)
            late = statistics.quantiles(drags, n=20)[-1] if len(drags) > 1 else float("nan")
            median = statistics.median(drags) if drags else float("nan")
            whole = f"{statistics.median(curves) / 1000:.1f} s" if curves else "-"
            print(f"| {name} | {statistics.median(paint):.0f} ms | {median:.0f} ms | {late:.0f} ms | {whole} |", flush=True)
        browser.close()


if __name__ == "__main__":
    main()
