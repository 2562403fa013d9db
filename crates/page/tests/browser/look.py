"""Looks at report pages in headless Chromium, as a person would. Usage: look.py FOLDER, with the pages that main.rs writes.

Prints a line for each check; the first one that fails ends it.
"""

import shutil
import sys
from pathlib import Path

from playwright.sync_api import expect, sync_playwright

FOLDER = Path(sys.argv[1])


class Visit:
    """A page that is open, and what it said or asked for behind the scenes."""

    def __init__(self, browser, name, scheme="light", width=1400):
        self.context = browser.new_context(viewport={"width": width, "height": 900}, color_scheme=scheme)
        self.page = self.context.new_page()
        self.page.set_default_timeout(15_000)
        self.said, self.asked = [], []
        self.page.on("console", lambda message: self.said.append(f"{message.type}: {message.text}"))
        self.page.on("pageerror", lambda error: self.said.append(f"error: {error}"))
        self.page.on("dialog", lambda dialog: (self.said.append(f"dialog: {dialog.message}"), dialog.dismiss()))
        self.page.on("request", lambda request: self.asked.append(request.url))
        self.page.goto((FOLDER / name).as_uri())

    def __enter__(self):
        return self

    def __exit__(self, kind, *_):
        if kind is None:
            assert self.said == [], self.said
            asked = [url for url in self.asked if not url.startswith(("file:", "data:"))]
            assert asked == [], asked
            assert len(self.asked) == 1, self.asked
        self.context.close()

    def range(self, chart="lanes"):
        figure = f"figure[data-chart={chart}] .js-plotly-plot" if chart == "lanes" else f"figure[data-property='{chart}'] .js-plotly-plot"
        return self.page.evaluate("selector => document.querySelector(selector).layout.xaxis.range", figure)

    def drawn(self):
        self.page.wait_for_selector("figure[data-chart=lanes] .barlayer .point")
        self.page.wait_for_selector("figure[data-property='0'] .scatterlayer .js-line")


def lanes_and_curves(browser):
    with Visit(browser, "drive.html") as visit:
        visit.drawn()
        page = visit.page
        expect(page.get_by_role("heading", level=1)).to_have_text("3 of 6 properties failed, 1 could not be judged")
        labels = page.locator("figure[data-chart=lanes] .ytick text").all_text_contents()
        assert labels[0].startswith("4: never speed") and "driver" in labels and len(labels) == 6, labels
        # Five kinds of stretches, and a sign for each of four violations.
        assert page.locator("figure[data-chart=lanes] .barlayer .trace").count() == 5
        assert page.locator("figure[data-chart=lanes] .scatterlayer .point").count() == 4
        # Speed and its margin, the limit, and the three violations shaded.
        assert page.locator("figure[data-property='0'] .scatterlayer .js-line").count() >= 2
        assert page.locator("figure[data-property='0'] .shapelayer path").count() >= 4
        # What failed stands before what holds.
        names = page.locator("details.property h3 .name").all_text_contents()
        assert names[:2] == ["line 4", "driver"] and names[-1] == "line 6", names
        # The states of a machine are written in its lane.
        assert "drive" in page.locator("figure[data-property='4'] .barlayer").text_content()


def tooltip(browser):
    with Visit(browser, "drive.html") as visit:
        visit.drawn()
        page = visit.page
        chart = page.locator("figure[data-property='0']")
        chart.scroll_into_view_if_needed()
        box = chart.locator(".xy2 .bg, .subplot.xy2").first.bounding_box() or chart.bounding_box()
        page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
        hover = chart.locator(".hoverlayer")
        expect(hover).to_contain_text("speed")
        expect(hover).to_contain_text("m/s")
        expect(hover).to_contain_text("margin")


def a_click_zooms(browser):
    with Visit(browser, "drive.html") as visit:
        visit.drawn()
        page = visit.page
        assert visit.range() == [0, 30], visit.range()
        button = page.locator("details[data-property='0'] button[data-violation='1']")
        button.click()
        expect(button).to_have_attribute("aria-expanded", "true")
        expect(button.locator("xpath=../div[@class='evidence']")).to_contain_text("2.31")
        page.wait_for_function("document.querySelector('figure[data-property=\"0\"] .js-plotly-plot').layout.xaxis.range[0] > 10")
        for chart in ("lanes", "0"):
            from_, to = visit.range(chart)
            assert 11 < from_ < 12 and 12.36 < to < 13.5, (chart, from_, to)
        page.get_by_role("button", name="Whole recording").click()
        page.wait_for_function("document.querySelector('figure[data-chart=lanes] .js-plotly-plot').layout.xaxis.range[0] === 0")
        # The sign in the chart leads there as well.
        sign = page.locator("figure[data-chart=lanes] .scatterlayer .point").nth(2)
        box = sign.bounding_box()
        page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
        page.mouse.down()
        page.mouse.up()
        expect(page.locator("details[data-property='0'] button[data-violation='2']")).to_have_attribute("aria-expanded", "true")


def a_drawn_stretch_zooms(browser):
    with Visit(browser, "drive.html") as visit:
        visit.drawn()
        page = visit.page
        box = page.locator("figure[data-chart=lanes] .nsewdrag").bounding_box()
        at = lambda part: (box["x"] + box["width"] * part, box["y"] + box["height"] / 2)
        page.mouse.move(*at(0.5))
        page.mouse.down()
        page.mouse.move(*at(0.6), steps=5)
        page.mouse.up()
        page.wait_for_function("document.querySelector('figure[data-property=\"0\"] .js-plotly-plot').layout.xaxis.range[0] > 14")
        from_, to = visit.range("0")
        assert abs(from_ - 15) < 0.2 and abs(to - 18) < 0.2, (from_, to)


def keyboard(browser):
    with Visit(browser, "drive.html") as visit:
        visit.drawn()
        page = visit.page
        # From the top the keyboard gets to the tools and into the charts, in the order of the text.
        order = []
        for _ in range(12):
            page.keyboard.press("Tab")
            order.append(page.evaluate("document.activeElement.getAttribute('aria-label') || document.activeElement.textContent.trim()"))
        assert order[0] == "To the report" and order.index("Earlier") < order.index("Whole recording"), order
        assert any(label.startswith("Chart: a lane for each property") for label in order), order
        chart = page.locator("figure[data-property='0']")
        chart.focus()
        for _ in range(10):
            page.keyboard.press("ArrowRight")
        expect(chart.locator(".readout")).to_contain_text("At 6 s: holds, speed 1.16")
        page.keyboard.press("+")
        assert visit.range("0") == [7.5, 22.5], visit.range("0")
        page.keyboard.press("Shift+ArrowRight")
        assert visit.range("0")[0] > 11, visit.range("0")
        page.keyboard.press("0")
        assert visit.range("0") == [0, 30], visit.range("0")
        page.keyboard.press("n")
        page.keyboard.press("n")
        focused = page.evaluate("document.activeElement.textContent")
        assert focused.startswith("12 s"), focused
        assert 11 < visit.range("0")[0] < 12, visit.range("0")
        # Names of verdicts are words, not only colours.
        expect(page.locator("details[data-property='0'] summary")).to_contain_text("violated")


def light_and_dark(browser):
    background = "getComputedStyle(document.body).backgroundColor"
    text = "getComputedStyle(document.querySelector('figure[data-chart=lanes] .ytick text')).fill"
    seen = {}
    for scheme in ("light", "dark"):
        with Visit(browser, "drive.html", scheme) as visit:
            visit.drawn()
            seen[scheme] = (visit.page.evaluate(background), visit.page.evaluate(text))
            visit.page.locator(".theme").click()
            visit.page.wait_for_timeout(300)
            seen["not " + scheme] = (visit.page.evaluate(background), visit.page.evaluate(text))
    assert seen["light"] != seen["dark"] and seen["light"] == seen["not dark"] and seen["dark"] == seen["not light"], seen


def illegal_moves(browser):
    looks = """selector => { const style = getComputedStyle(document.querySelector(selector));
                 return [style.stroke, style.strokeDasharray, style.fill]; }"""
    seen = {}
    for scheme in ("light", "dark"):
        with Visit(browser, "drive.html", scheme) as visit:
            page = visit.page
            diagram = page.locator("details[data-property='4'] figure.diagram")
            expect(diagram).to_be_visible()
            # The other properties are no diagrams.
            assert page.locator("figure.diagram").count() == 1
            # What was drawn, what was done besides, and where the robot was lost.
            assert diagram.locator("path.arrow").count() == 3 and diagram.locator(".wrong path.arrow").count() == 2
            assert diagram.locator(".state, .initial").count() == 2 and diagram.locator(".nowhere").text_content().strip() == "undefined"
            drawn, wrong = page.evaluate(looks, ".drawing > svg > .arrow"), page.evaluate(looks, ".drawing .wrong .arrow")
            assert drawn[1] == "none" and wrong[1] != "none" and drawn[0] != wrong[0], (drawn, wrong)
            # Its head is there, and red as well.
            head = diagram.locator(".wrong path.arrow").first.get_attribute("marker-end").removeprefix("url(#").removesuffix(")")
            assert page.evaluate("id => document.getElementById(id).localName", head) == "marker", head
            assert page.evaluate(looks, f"#{head} path")[2] == wrong[0], head
            seen[scheme] = (drawn, wrong)
            page.locator(".theme").click()
            seen["not " + scheme] = (page.evaluate(looks, ".drawing > svg > .arrow"), page.evaluate(looks, ".drawing .wrong .arrow"))
            # Who does not see it hears it, and may read it below.
            told = page.get_by_role("img", name="State diagram of driver: idle to drive (speed > 0.5 m/s); drive to idle (illegal, once)")
            expect(told).to_have_count(1)
            assert diagram.locator("li").all_text_contents() == ["drive → idle: illegal, once", "drive → undefined: no state fits, 2 times"]
            assert diagram.locator(".wrong title").first.text_content() == "drive to idle: illegal, once"
            # It stands below the text and the charts, across both.
            text = page.locator("details[data-property='4'] .body > .text").bounding_box()
            chart, box = page.locator("figure[data-property='4']").bounding_box(), diagram.bounding_box()
            assert box["x"] == text["x"] and box["x"] + box["width"] == chart["x"] + chart["width"], (text, chart, box)
            assert box["y"] >= max(text["y"] + text["height"], chart["y"] + chart["height"]), (text, chart, box)
            # Where there is little room it is drawn smaller, but not so that nobody could read it.
            drawing, svg = diagram.locator(".drawing"), diagram.locator("svg")
            natural = float(svg.get_attribute("width"))
            for room in (0.9, 0.5):
                drawing.evaluate("(box, width) => { box.style.boxSizing = 'content-box'; box.style.width = width + 'px'; }", natural * room)
                width = svg.bounding_box()["width"]
                assert abs(width - natural * max(room, 0.75)) < 2, (width, natural, room)
    assert seen["light"] != seen["dark"] and seen["light"] == seen["not dark"] and seen["dark"] == seen["not light"], seen


def narrow(browser):
    with Visit(browser, "drive.html", width=420) as visit:
        visit.drawn()
        wide = visit.page.evaluate("document.documentElement.scrollWidth")
        assert wide <= 420, wide
        # In a stretch that is too short for its name there is none.
        chart = visit.page.locator("figure[data-property='4']")
        chart.scroll_into_view_if_needed()
        expect(chart.locator(".bartext").first).to_be_attached()
        heights = "texts => texts.filter((t) => t.textContent.trim()).map((t) => t.getBoundingClientRect().height)"
        shown = chart.locator(".bartext").evaluate_all(heights)
        assert shown and min(shown) > 6, shown


def hostile_names(browser):
    with Visit(browser, "hostile.html") as visit:
        visit.drawn()
        page = visit.page
        page.locator("details[data-property='0'] button[data-violation='1']").click()
        expect(page.locator("figure.diagram .wrong text").first).to_contain_text("</script><script>alert('edge')")
        assert page.locator("img, a[href]:not(.skip)").count() == 0
        expect(page.locator("details[data-property='0'] .name")).to_contain_text("</script><script>alert('name')")
        expect(page.locator("figure[data-property='0'] .annotation-text").first).to_contain_text("</script><script>alert('track')")
        chart = page.locator("figure[data-property='0']")
        box = chart.bounding_box()
        page.mouse.move(box["x"] + box["width"] * 0.6, box["y"] + 110)
        expect(chart.locator(".hoverlayer")).to_contain_text("</script>")


def several_recordings(browser):
    with Visit(browser, "several.html") as visit:
        page = visit.page
        expect(page.get_by_role("heading", level=1)).to_have_text("2 of 3 recordings failed")
        rows = page.locator(".index tbody tr")
        assert rows.count() == 3
        page.get_by_role("checkbox").check()
        assert rows.locator("visible=true").count() == 2
        page.get_by_role("button", name="runs/2024-11-03/drive.mcap").first.click()
        visit.drawn()
        expect(page.get_by_role("heading", level=1)).to_have_text("3 of 6 properties failed, 1 could not be judged")
        page.go_back()
        expect(page.locator(".index")).to_be_visible()
        assert page.locator("article.run").count() == 0
        visit.asked = visit.asked[:1]


def without_scripts(browser):
    context = browser.new_context(java_script_enabled=False)
    page = context.new_page()
    page.goto((FOLDER / "drive.html").as_uri())
    expect(page.get_by_role("heading", level=1)).to_be_visible()
    expect(page.locator("details[data-property='0'] .evidence").first).to_contain_text("2.09")
    expect(page.locator("figure.diagram svg")).to_be_visible()
    expect(page.locator("figure.diagram g.wrong").first).to_contain_text("illegal, once")
    context.close()


CHECKS = [
    lanes_and_curves, tooltip, a_click_zooms, a_drawn_stretch_zooms, keyboard, light_and_dark, illegal_moves, narrow, hostile_names, several_recordings,
    without_scripts,
]

chromium = shutil.which("chromium")
assert chromium, "chromium is not installed"
with sync_playwright() as playwright:
    browser = playwright.chromium.launch(executable_path=chromium, args=["--no-sandbox"])
    for check in CHECKS:
        check(browser)
        print("ok", check.__name__, flush=True)
    browser.close()
