"""What people do with the page: click, drag, slide, compare, undo, other systems, phone, keyboard, saved pages."""

import json
import pathlib
import re
import time
import xml.etree.ElementTree as tree

import pytest

OWN = """name = "Brusselator"
states = ["x", "y"]
[parameters]
a = 1.0
b = 3.0
[rates]
x = "a + x^2*y - (b + 1)*x"
y = "b*x - x^2*y"
[start]
x = 1.0
y = 1.0
"""


def test_the_first_page_is_whole(slab, explored):
    page = explored(slab.address)
    page.idle(curves=True)
    assert page.pane("verdict").locator(".headline").inner_text().lower() == "periodic"
    assert page.value("[...twinslip.diagram.curves.keys()].length") >= 5
    # No pane is without a drawing, and all say in words what they show.
    blank = page.value("twinslip.allPanes.filter((p) => p.canvas && p.element.offsetParent && !p.description && !p.turnable).map((p) => p.title)")
    assert blank == []
    unnamed = page.value("[...document.querySelectorAll('canvas:not([aria-hidden])')].filter((c) => !c.getAttribute('aria-label')).length")
    assert unnamed == 0
    page.shot("first")


def test_a_click_and_a_drag_move_the_point(slab, explored):
    page = explored(slab.address)
    page.idle(curves=True)
    page.click(100, 0.3)
    values = page.value("twinslip.values()")
    assert values["driving"] == pytest.approx(100, rel=0.03) and values["stiffness"] == pytest.approx(0.3, rel=0.03)
    begin, end = page.place(100, 0.3), page.place(0.1, 0.1)
    page.page.mouse.move(*begin)
    page.page.mouse.down()
    for i in range(1, 21):
        page.page.mouse.move(*(b + (e - b) * i / 20 for b, e in zip(begin, end)))
        page.page.wait_for_timeout(30)
    page.page.mouse.up()
    page.idle()
    values = page.value("twinslip.values()")
    assert values["driving"] == pytest.approx(0.1, rel=0.03) and values["stiffness"] == pytest.approx(0.1, rel=0.03)
    # One step back undoes the whole drag.
    page.page.get_by_role("button", name="Undo").click()
    page.idle()
    assert page.value("twinslip.values().driving") == pytest.approx(100, rel=0.03)
    page.page.get_by_role("button", name="Redo").click()
    page.idle()
    assert page.value("twinslip.values().driving") == pytest.approx(0.1, rel=0.03)
    assert page.value("performance.getEntriesByName('twinslip drag').length") > 0


def test_keys_move_the_point_and_undo(slab, explored):
    page = explored(slab.address)
    page.idle()
    before = page.value("twinslip.values()")
    page.page.locator(".pane-diagram canvas").first.focus()
    page.page.keyboard.press("ArrowRight")
    page.page.keyboard.press("Shift+ArrowUp")
    page.idle()
    after = page.value("twinslip.values()")
    assert after["driving"] > before["driving"] and after["stiffness"] > before["stiffness"]
    page.page.keyboard.press("Control+z")
    page.page.keyboard.press("Control+z")
    page.idle()
    assert page.value("twinslip.values()") == before


def test_sliders_and_fields(slab, explored):
    page = explored(slab.address)
    page.idle()
    slider = page.page.get_by_role("slider", name=re.compile("^Healing time"))
    slider.focus()
    page.page.keyboard.press("ArrowRight")
    page.idle()
    assert page.value("twinslip.values().healing_time") > 100
    field = page.page.get_by_role("textbox", name=re.compile("^Healing time.*value"))
    field.fill("200")
    field.press("Enter")
    page.idle(curves=True)
    assert page.answer("run:0")["options"]["healing_time"] == 200
    assert page.answer("locus:hopf")["options"]["healing_time"] == 200
    field.fill("many")
    field.press("Enter")
    page.wait("!document.querySelector('.message').hidden")
    assert page.value("twinslip.values().healing_time") == 200


def test_si_units_are_the_same_point(slab, explored):
    page = explored(slab.address)
    page.idle()
    page.page.get_by_label("SI units").check()
    page.idle()
    assert page.value("twinslip.model.si")
    assert page.value("twinslip.values().driving") == pytest.approx(1e-5, rel=1e-12)
    assert page.pane("verdict").locator(".headline").inner_text().lower() == "periodic"
    field = page.page.get_by_role("textbox", name=re.compile("^Driving velocity.*value"))
    field.fill("20um/s")
    field.press("Enter")
    page.idle()
    assert page.value("twinslip.values().driving") == pytest.approx(2e-5, rel=1e-12)
    page.page.get_by_label("SI units").uncheck()
    page.idle()
    assert page.value("twinslip.values().driving") == pytest.approx(20, rel=1e-12)


def test_what_is_0_to_begin_with_has_its_size_in_si(slab, explored):
    page = explored(slab.address)
    page.idle()
    field = page.page.get_by_role("textbox", name=re.compile("^Radiation damping.*value"))
    field.fill("1e-4")
    field.press("Enter")
    page.idle()
    page.page.get_by_label("SI units").check()
    page.idle()
    # a sigma / V*, with a = 0.0349, sigma = 1 MPa, V* = 1 um/s.
    assert page.value("twinslip.values().damping") == pytest.approx(1e-4 * 0.0349 * 1e6 / 1e-6, rel=1e-12)


def test_another_law_and_symmetry(slab, explored):
    page = explored(slab.address)
    page.idle()
    page.page.get_by_label("Law", exact=True).select_option("regularised-ageing")
    page.idle()
    assert page.answer("run:0")["options"]["law"] == "regularised-ageing"
    page.page.get_by_label("Law", exact=True).select_option("spinodal")
    page.idle()
    page.page.get_by_label("Symmetry", exact=True).select_option("symmetric")
    page.idle()
    assert page.answer("orbit:0")["object"]["result"]["orbit"]["symmetry"] == "symmetric"


def test_two_points_side_by_side(slab, explored):
    page = explored(slab.address)
    page.idle()
    page.page.get_by_role("button", name="Compare").click()
    page.idle()
    page.click(100, 0.3)
    assert page.value("twinslip.values(0).driving") == 10
    assert page.value("twinslip.values(1).driving") == pytest.approx(100, rel=0.03)
    assert page.answer("run:1")["options"]["driving"] == page.value("twinslip.values(1).driving")
    assert page.pane("run", 1).is_visible()
    page.shot("compared")
    page.page.get_by_role("button", name="Compare").click()
    page.idle()
    assert not page.pane("run", 1).is_visible()


def test_a_start_is_picked_in_the_portrait(slab, explored):
    page = explored(slab.address)
    page.idle()
    portrait = page.pane("portrait")
    portrait.locator("select").nth(2).select_option("")
    page.idle()
    portrait.get_by_role("button", name="Pick start").click()
    portrait.locator("canvas").first.click(position={"x": 200, "y": 120})
    page.idle()
    start = page.value("twinslip.scene.start")
    assert len(start) == 3
    first = page.answer("run:0")
    row = dict(zip(first["columns"], first["rows"][0]))
    assert row["stress"] == pytest.approx(start[0], rel=1e-12)
    assert row["state_1"] == pytest.approx(start[1], rel=1e-12)


def test_a_program_is_drawn_by_hand(slab, explored):
    page = explored(slab.address)
    page.idle()
    page.page.get_by_text("Program of V_H").click()
    box = page.page.locator("canvas.program").bounding_box()
    path = [(0.05, 0.5), (0.3, 0.5), (0.35, 0.9), (0.6, 0.9), (0.65, 0.3), (0.95, 0.3)]
    at = lambda x, y: (box["x"] + x * box["width"], box["y"] + (1 - y) * box["height"])
    page.page.mouse.move(*at(*path[0]))
    page.page.mouse.down()
    for x, y in path[1:]:
        page.page.mouse.move(*at(x, y), steps=10)
    page.page.mouse.up()
    page.idle()
    assert page.value("twinslip.scene.program").count(":") >= 3
    run = page.answer("run:0")
    assert run["error"] is None and "driving" in run["columns"]
    page.page.get_by_role("button", name="Clear").click()
    page.idle()
    assert "program" not in page.answer("run:0")["options"]


def test_a_built_in_system_and_own_equations(slab, explored):
    page = explored(slab.address)
    page.idle()
    page.page.get_by_label("System", exact=True).select_option("lorenz")
    page.idle()
    assert page.value("twinslip.model.states.length") == 3
    assert page.pane("verdict").locator(".headline").inner_text().lower() == "chaotic"
    assert "Lyapunov exponent" in page.pane("verdict").inner_text()
    page.shot("lorenz")
    page.page.get_by_label("System", exact=True).select_option("own")
    page.idle()
    page.page.get_by_label("Equations of the system").fill(OWN)
    page.page.get_by_role("button", name="Use these equations").click()
    page.idle()
    assert page.value("twinslip.model.parameters.map((p) => p.name)") == ["a", "b"]
    page.idle(curves=True)
    # Hopf at b = 1 + a^2 (Prigogine and Lefever 1968).
    hopf = page.answer("branch:y:equilibria")
    rows = [dict(zip(hopf["columns"], row)) for row in hopf["rows"]]
    assert [row["b"] for row in rows if row["label"] == "HB"] == [pytest.approx(2.0, abs=1e-9)]
    assert "limit" in page.pane("verdict").inner_text() or "periodic" in page.pane("verdict").inner_text().lower()
    page.page.get_by_label("Equations of the system").fill(OWN.replace("x^2*y - (b", "x^^2*y - (b"))
    page.page.get_by_role("button", name="Use these equations").click()
    page.wait("!document.querySelector('.message').hidden")
    # What was there stays.
    assert page.value("twinslip.model.parameters.length") == 2


def test_a_forced_system_has_no_equilibria(served, explored):
    page = explored(served("--system", "duffing").address)
    page.idle(curves=True)
    # Holmes (1979) has chaos at these parameters.
    verdict = page.pane("verdict")
    assert verdict.locator(".headline").inner_text().lower() == "chaotic"
    assert "equilibri" not in page.page.inner_text("body")
    assert page.value("[...twinslip.engine.current.keys()].filter((slot) => slot.includes('equilibria'))") == []
    # As many multipliers as variables: their product is exp(-delta T).
    orbit = page.answer("orbit:0")["object"]["result"]["orbit"]
    logs = [one["ln_abs"]["value"] for one in orbit["log_multipliers"]]
    assert sum(logs) == pytest.approx(-0.25 * 2 * 3.141592653589793, rel=1e-9)
    assert page.pane("spectrum").locator("tbody tr").count() == 2
    assert page.answer("locus:period-doubling")["rows"]
    page.shot("duffing")


def test_a_server_of_an_own_system(served, explored, tmp_path):
    (tmp_path / "own.toml").write_text(OWN)
    page = explored(served("--system", str(tmp_path / "own.toml")).address)
    page.idle()
    assert page.value("twinslip.model.title") == "Brusselator"
    assert page.answer("orbit:0")["object"]["result"]["orbit"]["verdict"] == "stable"


def test_a_system_far_from_zero(served, explored, tmp_path):
    far = OWN.replace("x^2*y", "(x - 1e6)^2*(y - 5e6)").replace("(b + 1)*x", "(b + 1)*(x - 1e6)").replace('"b*x', '"b*(x - 1e6)')
    far = far.replace("x = 1.0", "x = 1000001.0").replace("y = 1.0", "y = 5000001.0")
    (tmp_path / "far.toml").write_text(far)
    page = explored(served("--system", str(tmp_path / "far.toml")).address)
    page.idle()
    page.wait("twinslip.engine.current.get('equilibria:0').answer.options.box")
    page.idle()
    lo, hi = page.answer("equilibria:0")["options"]["box"].split(",")[0].split("=")[1].split(":")
    assert 1e6 - 10 < float(lo) < float(hi) < 1e6 + 10
    assert len(page.answer("equilibria:0")["object"]["result"]["equilibria"]) == 1
    assert page.pane("verdict").locator(".headline").inner_text().lower() == "periodic"


def test_a_map_of_regimes(slab, explored):
    page = explored(slab.address)
    page.idle()
    page.pane("diagram").get_by_role("button", name="Map of regimes").click()
    page.idle(curves=True)
    assert page.value("twinslip.diagram.description.cells !== null")
    page.shot("map")


def test_zooming_computes_the_curves_there(slab, explored):
    page = explored(slab.address)
    page.idle()
    page.page.locator(".pane-diagram canvas").first.hover()
    for _ in range(4):
        page.page.mouse.wheel(0, -200)
    page.page.wait_for_timeout(500)
    page.idle(curves=True)
    lo, hi = page.value("twinslip.scene.ranges.driving")
    assert hi / lo < 1e6
    assert page.answer("locus:hopf")["options"]["in"].startswith(f"driving={lo:g}"[:12])


def test_the_address_brings_it_all_back(slab, explored, served):
    page = explored(slab.address)
    page.idle()
    page.click(100, 0.3)
    address = page.value("location.href")
    again = explored(address)
    again.idle()
    assert again.value("twinslip.values()") == page.value("twinslip.values()")
    # The part behind # is for any server.
    other = explored(served("--driving", "1").address + "#" + address.split("#")[1])
    other.idle()
    assert other.answer("run:0")["rows"] == page.answer("run:0")["rows"]


@pytest.mark.parametrize("hash", ["#scene=%7B", "#scene=null", "#scene=%7B%22axes%22%3A%7B%22x%22%3A%22nonsense%22%7D%2C%22points%22%3A%5B%7B%7D%5D%7D", "#" + "x" * 5000])
def test_addresses_of_nobody(slab, explored, hash):
    page = explored(slab.address + hash)
    page.idle()
    assert page.value("twinslip.values().driving") == 10


def test_pictures_and_numbers_are_taken_away(slab, explored):
    page = explored(slab.address)
    page.idle(curves=True)
    panes = ["diagram", "alongs.x", "alongs.y", "points[0].run", "points[0].portrait", "points[0].returns", "points[0].spectrum"]
    for pane in panes:
        svg = page.value(f"twinslip.{pane}.svg()")
        assert tree.fromstring(svg).tag.endswith("svg"), pane
        assert "NaN" not in svg and "undefined" not in svg, pane
        csv = page.value(f"twinslip.{pane}.csv()")
        assert csv.startswith("# twinslip ") and csv.count("\n") > 5, pane
    # A browser lets a page hand out some ten files in a row.
    for name in ["diagram", "run", "portrait"]:

        def take(item):
            page.pane(name).locator("button.menu").click()
            page.pane(name).get_by_role("menuitem", name=item).click()

        png = page.downloaded(lambda: take("Picture (PNG)"))
        assert png.startswith(b"\x89PNG") and len(png) > 2000, name
        assert tree.fromstring(page.downloaded(lambda: take("Picture (SVG)"))).tag.endswith("svg"), name
        assert page.downloaded(lambda: take("Numbers (CSV)")).startswith(b"# twinslip "), name


def test_a_saved_page_needs_no_server(served, explored, tmp_path):
    server = served()
    page = explored(server.address)
    page.idle()
    page.click(100, 0.1)
    page.idle(curves=True)
    html = page.downloaded(lambda: page.page.get_by_role("button", name="Save page").click())
    run = page.answer("run:0")
    server.close()
    (tmp_path / "saved.html").write_bytes(html)
    saved = explored((tmp_path / "saved.html").as_uri())
    saved.idle()
    assert saved.answer("run:0")["rows"] == run["rows"]
    assert saved.pane("diagram").is_visible() and saved.value("twinslip.diagram.curves.size") >= 5
    assert saved.page.locator(".side input").first.is_disabled()
    saved.shot("saved")


def test_two_clients_at_once(slab, explored):
    one, two = explored(slab.address), explored(slab.address)
    one.idle()
    two.idle()
    one.click(100, 0.3)
    two.click(1, 0.1)
    assert one.value("twinslip.values().driving") != two.value("twinslip.values().driving")
    assert one.answer("run:0")["options"]["driving"] == one.value("twinslip.values().driving")
    assert two.answer("run:0")["options"]["driving"] == two.value("twinslip.values().driving")


@pytest.mark.parametrize("width", [360, 768, 1280])
def test_it_fits_phones_and_desktops(slab, explored, width):
    page = explored(slab.address, width=width)
    page.idle(curves=True)
    assert page.value("document.documentElement.scrollWidth") <= width
    page.shot(f"wide-{width}")
    page.page.set_viewport_size({"width": 1000, "height": 700})
    page.page.wait_for_timeout(300)
    assert page.value("document.documentElement.scrollWidth") <= 1000


def test_dark(slab, explored):
    page = explored(slab.address, color_scheme="dark")
    page.idle()
    background = page.value("getComputedStyle(document.querySelector('.pane')).backgroundColor")
    assert max(map(int, re.findall(r"\d+", background)[:3])) < 80
    page.shot("dark")


def test_labels_say_what_they_mean(slab, explored):
    page = explored(slab.address)
    page.idle(curves=True)
    page.page.get_by_role("button", name="Glossary").click()
    glossary = page.page.locator("dialog[open]")
    assert "Hopf bifurcation" in glossary.inner_text()
    glossary.get_by_role("button", name="Close").click()
    hopf = page.value("(() => { const a = twinslip.engine.current.get('locus:hopf').answer; const k = a.columns.indexOf('stiffness'); const r = a.rows.reduce((one, other) => (other[k] > one[k] ? other : one)); return [r[a.columns.indexOf('driving')], r[a.columns.indexOf('stiffness')]]; })()")
    page.page.mouse.move(*page.place(*hopf))
    page.page.wait_for_timeout(100)
    assert "Hopf" in page.pane("diagram").locator(".tip").inner_text()


def test_every_control_is_named(slab, explored):
    """Screen readers have a name for all that can be used."""
    page = explored(slab.address)
    page.idle()
    unnamed = page.value("""[...document.querySelectorAll('button, input, select, textarea, a')].filter((one) => {
        const label = one.getAttribute('aria-label') || one.textContent.trim() || one.closest('label')?.textContent.trim() || one.title;
        return !label;
    }).map((one) => one.outerHTML.slice(0, 100))""")
    assert unnamed == []


def test_a_closed_page_stops_its_work(served, browser):
    server = served("--driving", "0.05", "--stiffness", "0.001")
    context = browser.new_context()
    page = context.new_page()
    page.goto(server.address)
    page.wait_for_timeout(1500)
    context.close()
    spent = lambda: sum(map(int, pathlib.Path(f"/proc/{server.process.pid}/stat").read_text().rsplit(")")[1].split()[11:13]))
    for _ in range(100):
        before = spent()
        time.sleep(0.2)
        if spent() - before <= 1:
            return
    raise AssertionError("the server goes on computing")


def test_a_fit_brings_bands(slab, explored):
    fit = pathlib.Path(__file__).parents[1] / "data/fit-spinodal.json"
    page = explored(slab.address)
    page.idle(curves=True)
    page.page.get_by_text("A fit (fit.json)").click()
    page.page.get_by_label("A fit to load").set_input_files(fit)
    page.idle(curves=True)
    assert page.pane("bands").is_visible()
    assert page.answer("bands")["error"] is None
    known = json.loads(fit.read_text())["result"]["fit"]["parameters"]
    assert page.value("twinslip.values().evolution_effect") == next(one["value"] for one in known if one["name"] == "evolution_effect")
    page.pane("diagram").get_by_role("button", name="Map of regimes").click()
    page.idle(curves=True)
    probable = page.answer("map")
    assert probable["error"] is None and any(name.startswith("probability_") for name in probable["columns"])
    page.shot("fit")
