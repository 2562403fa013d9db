"""How fluid a report page is: opens it in headless Chromium, zooms, hovers and scrolls as a hand does, and prints the times between frames.

    lapwing sim patrol --duration 5500s -o big.mcap                 # 110 MB
    lapwing check SPEC.rv big.mcap --report big.html
    .venv/bin/python crates/page/tests/browser/fluid.py big.html

Nothing is asserted: what a frame takes is a matter of the machine. At 60 frames a second it is 16.7 ms.
"""

import shutil
import sys
import time
from pathlib import Path

from playwright.sync_api import sync_playwright

START = """() => {
  window.frames_seen = [];
  let last = performance.now();
  const step = (now) => {
    if (!window.frames_seen) return;
    window.frames_seen.push(now - last);
    last = now;
    requestAnimationFrame(step);
  };
  requestAnimationFrame(step);
}"""
TAKE = "() => { const seen = window.frames_seen.slice(1); window.frames_seen = null; return seen; }"


def measured(page, name, act):
    page.evaluate(START)
    act()
    page.wait_for_timeout(400)
    frames = sorted(page.evaluate(TAKE))
    late = frames[min(len(frames) - 1, int(0.95 * len(frames)))]
    print(f"{name:<22}{len(frames):>5} frames, median {frames[len(frames) // 2]:6.1f} ms, 95 % {late:6.1f} ms, worst {frames[-1]:6.1f} ms")


def drag(page, box, start, end):
    at = lambda share: (box["x"] + box["width"] * share, box["y"] + box["height"] / 2)
    page.mouse.move(*at(start))
    page.mouse.down()
    for step in range(1, 21):
        page.mouse.move(*at(start + (end - start) * step / 20))
        page.wait_for_timeout(16)
    page.mouse.up()


def hover(page, box):
    for step in range(60):
        page.mouse.move(box["x"] + box["width"] * (0.1 + 0.8 * step / 60), box["y"] + box["height"] / 2)
        page.wait_for_timeout(16)


def scroll(page):
    for _ in range(30):
        page.mouse.wheel(0, 400)
        page.wait_for_timeout(16)



with sync_playwright() as playwright:
    browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
    page = browser.new_context(viewport={"width": 1400, "height": 900}).new_page()
    page.set_default_timeout(60_000)
    start = time.monotonic()
    page.goto(Path(sys.argv[1]).absolute().as_uri())
    lanes = page.locator("figure[data-chart=lanes]")
    lanes.locator(".nsewdrag").first.wait_for(state="attached")
    print(f"open and drawn after {time.monotonic() - start:.1f} s")
    page.wait_for_timeout(1000)
    seen = lambda: page.evaluate("() => document.querySelector('figure[data-chart=lanes] .js-plotly-plot').layout.xaxis.range")
    box = lanes.locator(".nsewdrag").first.bounding_box()
    whole = seen()
    measured(page, "zoom into the lanes", lambda: drag(page, box, 0.4, 0.6))
    assert seen() != whole, "nothing was zoomed"
    measured(page, "once more", lambda: drag(page, box, 0.3, 0.5))
    measured(page, "back, by a double click", lambda: page.mouse.dblclick(box["x"] + 200, box["y"] + box["height"] / 2))
    chart = page.locator("details.property[open] figure").first
    chart.scroll_into_view_if_needed()
    chart.locator(".nsewdrag").first.wait_for(state="attached")
    box = chart.locator(".nsewdrag").first.bounding_box()
    measured(page, "hover over a curve", lambda: hover(page, box))
    measured(page, "zoom into a curve", lambda: drag(page, box, 0.4, 0.6))
    measured(page, "scroll the page", lambda: scroll(page))
