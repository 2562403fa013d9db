"""Looks at pages of matches in headless Chromium. Usage: look.py FOLDER, with the pages that main.rs writes.

Prints a line for each check; the first one that fails ends it. With a second argument it leaves pictures in that folder.
"""

import shutil
import sys
from pathlib import Path

from playwright.sync_api import expect, sync_playwright

FOLDER = Path(sys.argv[1])
PICTURES = Path(sys.argv[2]) if len(sys.argv) > 2 else None


class Visit:
    """A page that is open, and what it said or asked for behind the scenes."""

    def __init__(self, browser, name, scheme="light", width=1300):
        self.context = browser.new_context(viewport={"width": width, "height": 1000}, color_scheme=scheme)
        self.page = self.context.new_page()
        self.page.set_default_timeout(15_000)
        self.said, self.asked = [], []
        self.page.on("console", lambda message: self.said.append(f"{message.type}: {message.text}"))
        self.page.on("pageerror", lambda error: self.said.append(f"error: {error}"))
        self.page.on("request", lambda request: self.asked.append(request.url))
        self.page.goto((FOLDER / name).as_uri())

    def __enter__(self):
        return self

    def __exit__(self, kind, *_):
        if kind is None:
            # The browser advises those who read a canvas, which only this script does.
            said = [line for line in self.said if "willReadFrequently" not in line]
            assert said == [], said
            assert len(self.asked) == 1, self.asked
        self.context.close()

    def state(self):
        return self.page.locator("#state").text_content()

    def seek(self, seconds):
        self.page.locator("#seek").evaluate("(seek, at) => { seek.value = at; seek.dispatchEvent(new Event('input')); }", seconds)

    def colour(self, canvas, x, y):
        """The colour of a point of a canvas; x and y are shares of its width and height."""
        script = """([id, x, y]) => {
            const canvas = document.getElementById(id);
            const at = [Math.floor(x * (canvas.width - 1)), Math.floor(y * (canvas.height - 1))];
            return Array.from(canvas.getContext('2d').getImageData(at[0], at[1], 1, 1).data).slice(0, 3);
        }"""
        return self.page.evaluate(script, [canvas, x, y])

    def picture(self, name):
        if PICTURES:
            self.page.screenshot(path=str(PICTURES / f"{name}.png"))


def healthy(browser):
    with Visit(browser, "healthy.html") as visit:
        page = visit.page
        expect(page.locator("#about")).to_have_text("No fault. Seed 1. The ball is in the goal.")
        expect(page.locator("#violations li")).to_have_text(["none"])
        expect(page.locator("#properties tr")).to_have_count(7)
        expect(page.locator("#properties .holds")).to_have_count(7)
        assert visit.state() == "init"
        end = float(page.locator("#seek").get_attribute("max"))
        assert 15 < end < 60, end
        seen = []
        for share in range(0, 101):
            visit.seek(end * share / 100)
            if not seen or seen[-1] != visit.state():
                seen.append(visit.state())
        assert seen[-3:] == ["dribble_to_goal", "kick_ball_to_goal", "game_over"] or seen[-2:] == ["dribble_to_goal", "kick_ball_to_goal"], seen
        assert "turn_to_goal" in seen and "goto_ball" in seen, seen
        # The bar has the colours of two states.
        visit.seek(0)
        assert visit.colour("bar", 0.1, 0.6) != visit.colour("bar", 0.6, 0.6)


def faulty(browser):
    with Visit(browser, "ball-off.html") as visit:
        page = visit.page
        expect(page.locator("#about")).to_contain_text("Fault: ball-off")
        first = page.locator("#violations button").first
        expect(first).to_contain_text("always_ir")
        expect(page.locator("#properties .violated").first).to_be_visible()
        at = float(first.text_content().split(" s")[0])
        end = float(page.locator("#seek").get_attribute("max"))
        # A mark above the bar, where the violation is.
        red, green, _ = visit.colour("bar", at / end, 0.13)
        assert red > 150 and green < 100, (red, green)
        first.click()
        expect(page.locator("#clock")).to_have_text(f"{at:.2f} s")
        expect(page.locator("#violations li").first).to_have_class("past")
        visit.picture("ball-off")


def violated_at_the_end(browser):
    with Visit(browser, "taken.html") as visit:
        last = float(visit.page.locator("#violations button").last.text_content().split(" s")[0])
        assert last > float(visit.page.locator("#seek").get_attribute("max")) - 0.1, last
        # Its mark is there as a whole: the tip stands half its width from the end.
        width = visit.page.evaluate("document.getElementById('bar').width")
        red, green, _ = visit.colour("bar", (width - 10) / (width - 1), 20 / 73)
        assert red > 150 and green < 100, (red, green)
        visit.picture("taken")


def animation(browser):
    with Visit(browser, "healthy.html") as visit:
        page = visit.page
        page.select_option("#speed", "4")
        page.get_by_role("button", name="Play").click()
        expect(page.get_by_role("button", name="Pause")).to_be_visible()
        page.wait_for_function("() => parseFloat(document.getElementById('clock').textContent) > 1")
        page.get_by_role("button", name="Pause").click()
        stopped = page.locator("#clock").text_content()
        page.wait_for_timeout(200)
        assert page.locator("#clock").text_content() == stopped
        page.locator("body").press(" ")
        expect(page.get_by_role("button", name="Pause")).to_be_visible()
        visit.picture("healthy")


def dark_and_small(browser):
    with Visit(browser, "ball-off.html", scheme="dark", width=420) as visit:
        page = visit.page
        assert sum(visit.colour("field", 0.02, 0.02)) < 250
        assert page.evaluate("document.documentElement.scrollWidth <= window.innerWidth")
        visit.picture("dark")


program = shutil.which("chromium")
assert program, "chromium is not installed"
with sync_playwright() as playwright:
    chromium = playwright.chromium.launch(executable_path=program, args=["--no-sandbox"])
    for check in (healthy, faulty, violated_at_the_end, animation, dark_and_small):
        check(chromium)
        print("ok", check.__name__, flush=True)
    chromium.close()
