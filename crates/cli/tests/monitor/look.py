"""Looks at the live page in headless Chromium, as a person would. Usage: look.py URL

Prints a line for each check (`ok …`), and beside that what the robot is to do: `do A;B` over and over from now on, `once A` one time, which is
answered with a line; `end` asks for Lapwing's end, and `bye` is the last word. The first check that fails ends it. Where `SHOTS` names a folder, pictures
are put there.
"""

import os
import re
import shutil
import sys
from pathlib import Path

from playwright.sync_api import expect, sync_playwright

URL = sys.argv[1]
SHOTS = os.environ.get("SHOTS")
PAST = Path(__file__).resolve().parents[3] / "page/assets/live/past.js"
expect.set_options(timeout=30_000)


def say(*words):
    print(*words, flush=True)


def once(what):
    say("once", what)
    sys.stdin.readline()


class Visit:
    """A page that is open, and what it said or asked for behind the scenes."""

    def __init__(self, browser, scheme="light", width=1400):
        self.context = browser.new_context(viewport={"width": width, "height": 1000}, color_scheme=scheme)
        self.page = self.context.new_page()
        self.page.set_default_timeout(30_000)
        self.said, self.asked, self.loads = [], set(), 0
        self.page.on("console", lambda message: self.said.append(f"{message.type}: {message.text}"))
        self.page.on("pageerror", lambda error: self.said.append(f"error: {error}"))
        self.page.on("dialog", lambda dialog: (self.said.append(f"dialog: {dialog.message}"), dialog.dismiss()))
        self.page.on("request", self.request)
        self.page.goto(URL)

    def request(self, request):
        self.asked.add(request.url.split("?")[0])
        self.loads += request.is_navigation_request()

    def is_clean(self):
        """It complained of nothing, was loaded once, and asked for nothing but how things stand."""
        assert self.said == [], self.said
        asked = {url for url in self.asked if not url.startswith("data:")}
        assert asked <= {URL, URL + "state.json"} and self.loads == 1, (asked, self.loads)

    def drawn(self, selector):
        """Waits until a path has something to show."""
        self.page.wait_for_function("s => [...document.querySelectorAll(s)].some((path) => path.getAttribute('d'))", arg=selector)


def shows_how_things_stand(visit, _):
    page = visit.page
    expect(page.locator("h1")).to_have_text("All 4 properties hold so far")
    expect(page.locator("#meta")).to_have_text(re.compile(r"for [\d.]+ s, \d+ messages, judged within .* 0 lost"))
    expect(page.locator("#lanes .row .label").nth(0)).to_have_text("calm")
    visit.drawn("#lanes path.fill-holds")
    assert page.locator("#lanes .row").count() == 5
    expect(page.locator("#topic-rows tr").first).to_contain_text("Hz")


def plots_signals(visit, _):
    card = visit.page.locator("details[data-name=calm]")
    visit.drawn("details[data-name=calm] path.stroke-0")
    expect(card.locator(".names")).to_have_text(re.compile("speed: 1.*> 2"))
    expect(card.locator("line.limit")).to_have_attribute("y1", re.compile(r"\d"))
    # What is no number is a lane with its state written in it.
    expect(visit.page.locator("details[data-name=polite] .state").last).to_have_text("hello")


def a_violation_appears_without_a_reload(visit, others):
    once("say /speed 3.5")
    for each in [visit, *others]:
        page = each.page
        expect(page.locator("h1")).to_have_text(re.compile("[1-3] of 4 properties violated"))
        expect(page.locator("details[data-name=calm] .badge")).to_contain_text("violated")
        expect(page.locator("#events li").filter(has=page.locator(".violation")).filter(has_text="calm").first).to_contain_text("never speed > 2")
        expect(page.locator("details[data-name=calm] .latest li").first).to_contain_text("speed = 3.5")
        each.drawn("#lanes .row:first-child path.marks")
        each.drawn("#lanes .row:first-child path.fill-violated")
        each.is_clean()


def an_illegal_move_is_drawn(visit, others):
    for each in [visit, *others]:
        card = each.page.locator("details[data-name=gear]")
        expect(card.locator("figure.diagram g.wrong text")).to_have_text(re.compile("illegal, "))
        expect(card.locator("figure.diagram li")).to_have_text(re.compile("^second → first: illegal, "))
        assert card.locator("figure.diagram path.arrow").count() == 2
        expect(card.get_by_role("img", name=re.compile("State diagram of gear: first to second .*; second to first"))).to_be_visible()


def a_deadline_that_passes_appears_too(visit, _):
    say("do say /speed 1.8;tell /word hello")
    expect(visit.page.locator("details[data-name=slow] .badge")).to_contain_text("violated")
    say("do say /speed 1;tell /word hello")


def what_a_robot_says_is_only_text(visit, _):
    say("do say /speed 1;tell /word <img src=x onerror=alert(1)>")
    expect(visit.page.locator("h1")).to_have_text("All 4 properties violated")
    expect(visit.page.locator("details[data-name=polite] .latest")).to_contain_text("<img src=x onerror=alert(1)>")
    assert visit.page.locator("img").count() == 0
    say("do say /speed 1;tell /word hello")


def it_can_be_held(visit, _):
    page = visit.page
    shown = page.locator("#shown")
    page.get_by_role("button", name="Hold").click()
    before, messages = shown.text_content(), page.locator("#meta").text_content()
    expect(page.locator("#meta")).not_to_have_text(messages)
    assert shown.text_content() == before, (before, shown.text_content())
    page.get_by_role("button", name="Hold").click()
    expect(shown).not_to_have_text(before)


def a_cursor_tells_values(visit, _):
    page = visit.page
    page.get_by_role("button", name="120 s").click()
    expect(page.get_by_role("button", name="120 s")).to_have_attribute("aria-pressed", "true")
    page.get_by_role("button", name="Hold").click()
    card = page.locator("details[data-name=calm]")
    path = card.locator("path.marks, path.stroke-0").last
    assert path.get_attribute("d")
    page.locator("#lanes").focus()
    seen = set()
    for _ in range(51):
        page.keyboard.press("ArrowLeft")
        seen.add(card.locator(".names span").first.text_content())
    assert "speed: 1" in seen and len(seen) >= 2, seen
    page.keyboard.press("Escape")
    page.get_by_role("button", name="Hold").click()


def what_cannot_be_seen_is_told(visit, _):
    say("do say /speed 1")
    once("leave /word")
    row = visit.page.locator("#topic-rows tr").filter(has_text="/word")
    expect(row.locator(".blind")).to_contain_text("nobody publishes it")
    expect(visit.page.locator("#events li").filter(has=visit.page.locator(".warning")).first).to_contain_text("/word")


def light_and_dark(_, others):
    seen = [other.page.evaluate("getComputedStyle(document.body).backgroundColor") for other in others[:2]]
    assert seen[0] != seen[1], seen
    others[0].page.locator(".theme").click()
    assert others[0].page.evaluate("getComputedStyle(document.body).backgroundColor") == seen[1]


def narrow(_, others):
    assert others[2].page.evaluate("document.documentElement.scrollWidth") <= 420


def the_browser_forgets_as_well(visit, _):
    """A day of looks, of which only what is in reach is kept."""
    kept = visit.page.evaluate("""source => {
      const Past = new Function(source + "; return Past;")();
      const past = new Past();
      for (let look = 0; look < 50000; look += 1) {
        const now = look * 0.25;
        const event = { type: "violation", name: "p", failed: now };
        const track = { name: "x", kind: "curve", points: [[now, look], [now + 0.1, -look]] };
        const fixed = look === 0 ? { name: "p", file: "f", plots: [], lanes: [] } : {};
        past.take({
          run: 1, revision: look + 1, since: look, now, reach: 120, events: [event], tracks: { t: track },
          properties: [{ ...fixed, changes: [[now, look % 2 ? "holds" : "violated"]] }],
        });
      }
      return [past.tracks.get("t").points.length, past.properties[0].changes.length, past.events.length];
    }""", PAST.read_text())
    assert kept[0] <= 964 and kept[1] <= 484 and kept[2] == 200, kept


def the_end_is_told(visit, _):
    visit.is_clean()
    say("end now")
    expect(visit.page.locator("#gone")).to_be_visible()
    expect(visit.page.locator("#gone")).to_contain_text("this is how things stood at")
    expect(visit.page.locator("h1")).to_contain_text("violated")


CHECKS = [
    shows_how_things_stand, plots_signals, a_violation_appears_without_a_reload, an_illegal_move_is_drawn, a_deadline_that_passes_appears_too, what_a_robot_says_is_only_text,
    it_can_be_held, a_cursor_tells_values, what_cannot_be_seen_is_told, light_and_dark, narrow, the_browser_forgets_as_well, the_end_is_told,
]

chromium = shutil.which("chromium")
assert chromium, "chromium is not installed"
with sync_playwright() as playwright:
    browser = playwright.chromium.launch(executable_path=chromium, args=["--no-sandbox"])
    visit = Visit(browser)
    others = [Visit(browser), Visit(browser, "dark"), Visit(browser, width=420)]
    for check in CHECKS:
        check(visit, others)
        if SHOTS:
            for scheme, each in zip(("light", "dark", "narrow"), others):
                each.page.screenshot(path=f"{SHOTS}/{check.__name__}-{scheme}.png", full_page=True)
        say("ok", check.__name__)
    browser.close()
say("bye")
