"""Program of another environment: a person in Chromium who looks at a recording in the player, opened from disk.

Arguments: the page; "mouse" or "touch"; width and height of the page; "light" or "dark"; folder for pictures. It prints
a JSON object with what the page shows after each step, errors of the browser's console, and what axe-core finds.
"""

import json
import sys
import time

from axe_core_python.selenium import Axe
from selenium import webdriver
from selenium.webdriver.chrome.options import Options
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys

TIMEOUT = 30.0
"""Maximum number of seconds until something is shown."""
SHOWN = """
const all = (selector, within = document) => [...within.querySelectorAll(selector)];
const numbers = (mark) => mark.getAttribute("transform").match(/-?[0-9.]+/g).map(Number);
const texts = (selector, within) => all(selector, within).map((each) => each.textContent);
const plot = (figure) => [figure.querySelector("h3").firstChild.data, texts(".values b", figure)];
const slider = document.querySelector(".timeline input");
return {
  at: Number(slider.value),
  from: Number(slider.min),
  duration: Number(slider.max),
  ticks: texts("figure .plot .tick[text-anchor=middle]"),
  robots: all(".map g.robot").map(numbers),
  plots: Object.fromEntries(all("figure").map(plot)),
  active: texts(".entry[aria-current] .words"),
  playing: document.querySelector(".icon.main").getAttribute("aria-label"),
  wider: document.documentElement.scrollWidth > document.documentElement.clientWidth,
};
"""
"""Script that returns what the page shows."""


def main():
    page, how, width, height, scheme, folder = sys.argv[1:]
    options = Options()
    options.binary_location = "/usr/bin/chromium"
    for flag in ("--headless=new", "--no-sandbox", "--mute-audio", "--disable-dev-shm-usage"):
        options.add_argument(flag)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    browser = webdriver.Chrome(options=options, service=Service("/usr/bin/chromedriver"))
    size = {"width": int(width), "height": int(height), "deviceScaleFactor": 1, "mobile": how == "touch"}
    browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
    preferred = {
        "prefers-color-scheme": scheme,
        "prefers-reduced-motion": "reduce" if how == "touch" else "no-preference",
    }
    features = [{"name": name, "value": value} for name, value in preferred.items()]
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": features})
    if how == "touch":
        browser.execute_cdp_cmd("Emulation.setTouchEmulationEnabled", {"enabled": True})
    steps = {}

    def look(name, until=lambda shown: True):
        """Store what the page shows as soon as a condition is met."""
        end = time.monotonic() + TIMEOUT
        while True:
            # The map moves robots in the next picture.
            browser.execute_async_script("requestAnimationFrame(() => requestAnimationFrame(arguments[0]))")
            steps[name] = browser.execute_script(SHOWN)
            if until(steps[name]):
                return
            if time.monotonic() > end:
                raise TimeoutError(f"{name}: {steps[name]}")

    def length(shown):
        return shown["duration"] - shown["from"]

    def keys(text):
        browser.find_element(By.TAG_NAME, "body").send_keys(text)

    browser.get(f"file://{page}")
    end = time.monotonic() + TIMEOUT
    while not browser.find_element(By.ID, "transport").is_displayed() and time.monotonic() < end:
        time.sleep(0.05)
    look("start")
    browser.find_element(By.CSS_SELECTOR, ".icon.main").click()
    look("playing", lambda shown: shown["at"] > 0.3)
    browser.find_element(By.CSS_SELECTOR, ".icon.main").click()
    look("paused", lambda shown: shown["playing"] != steps["playing"]["playing"])
    keys(Keys.HOME)
    keys(Keys.ARROW_RIGHT)
    look("five seconds")
    slider = browser.find_element(By.CSS_SELECTOR, ".timeline input")
    browser.execute_script("arguments[0].scrollIntoView()", slider)
    slider.click()  # in the middle
    look("middle")
    keys("]")
    look("next event")
    entries = browser.find_elements(By.CSS_SELECTOR, ".entry")
    browser.execute_script("arguments[0].scrollIntoView({block: 'center'})", entries[-1])
    entries[-1].click()
    look("last entry")
    keys(Keys.END)
    look("end")
    keys("1")
    look("followed")
    keys("i")
    look("zoomed")
    if how == "mouse":
        plot = "document.querySelector('figure .plot')"
        browser.execute_script(f"{plot}.scrollIntoView({{block: 'center'}})")
        box = browser.execute_script(f"return {plot}.getBoundingClientRect().toJSON()")
        middle = {"x": box["x"] + box["width"] / 2, "y": box["y"] + box["height"] / 2}
        wheel = {"type": "mouseWheel", "modifiers": 2, "deltaX": 0, "deltaY": -100, **middle}
        browser.execute_cdp_cmd("Input.dispatchMouseEvent", wheel)
        look("by wheel", lambda shown: length(shown) < 0.9 * length(steps["zoomed"]))
    keys("oooo")
    keys(Keys.END)
    look("whole again")
    browser.save_screenshot(f"{folder}/player-{how}-{scheme}.png")
    faults = [
        f"{fault['id']} ({fault['impact']}): {[node['target'] for node in fault['nodes']][:3]}"
        for fault in Axe().run(browser)["violations"]
    ]
    logged = [entry["message"] for entry in browser.get_log("browser") if entry["level"] in ("SEVERE", "WARNING")]
    print(json.dumps({"steps": steps, "errors": logged, "faults": faults}))
    browser.quit()


main()
