"""Chromium for programs of another environment: one browser, and a person who uses it by mouse, keyboard or touch."""

import os
import signal
from contextlib import suppress
from pathlib import Path

from axe_core_python.selenium import Axe
from selenium import webdriver
from selenium.common.exceptions import (
    ElementClickInterceptedException,
    ElementNotInteractableException,
    StaleElementReferenceException,
)
from selenium.webdriver.chrome.options import Options
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.support.ui import WebDriverWait

TIMEOUT = 60.0
"""Seconds for each step."""
CHANGES = (StaleElementReferenceException, ElementClickInterceptedException, ElementNotInteractableException)
"""Errors after a change of the page between a look at it and a press."""
MOST_STOPS = 80
"""Greatest number of presses of Tab until something has the focus."""
FLAGS = ("--headless=new", "--no-sandbox", "--mute-audio", "--disable-dev-shm-usage")
KEYS = {"Esc": Keys.ESCAPE, "Space": Keys.SPACE, "Up": Keys.ARROW_UP, "Down": Keys.ARROW_DOWN}
SHOWN = """
const all = [...document.querySelectorAll(arguments[0])];
return all.filter((each) => each.checkVisibility({ visibilityProperty: true }));
"""
FOCUS_IS_SEEN = """
const style = getComputedStyle(document.activeElement);
return (style.outlineStyle !== "none" && parseFloat(style.outlineWidth) > 0) || style.boxShadow !== "none";
"""
PLACE = """
const [target, across] = arguments;
target.scrollIntoView({ block: "center", behavior: "instant" });
const box = target.getBoundingClientRect();
const at = { x: box.x + across * box.width, y: box.y + box.height / 2 };
const top = document.elementFromPoint(at.x, at.y);
const covered = !!top && !target.contains(top) && !top.contains(target) && top.outerHTML.slice(0, 200);
return { ...at, gone: !box.width, covered };
"""
"""Script that returns a place on an element, whether it is gone, and what covers it there; false if nothing does."""


class DrivenChromium:
    """Chromium with a person in front of it.

    Args:
        how: "mouse", "keyboard" or "touch"; with "touch", the page is shown as on a phone.
        profile: folder of the browser's profile; a new one by default.

    Attributes:
        browser: driver of the browser.
        faults: faults of the pages so far: what axe-core finds, and what the person cannot reach.
    """

    def __init__(self, how="mouse", width=1280, height=800, profile=None):
        options = Options()
        options.binary_location = "/usr/bin/chromium"
        for flag in (*FLAGS, *([f"--user-data-dir={profile}"] if profile else [])):
            options.add_argument(flag)
        options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
        self.browser = webdriver.Chrome(options=options, service=Service("/usr/bin/chromedriver"))
        self.how, self.faults, self._covered = how, [], False
        self.resize(width, height)
        if how == "touch":
            self.browser.execute_cdp_cmd("Emulation.setTouchEmulationEnabled", {"enabled": True})

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.browser.quit()

    def kill(self):
        """Kill the browser."""
        driver = self.browser.service.process.pid
        # Any thread of the driver may have started it.
        started = [each.read_text().split() for each in Path(f"/proc/{driver}/task").glob("*/children")]
        os.kill(int(next(process for processes in started for process in processes)), signal.SIGKILL)
        with suppress(Exception):
            self.browser.service.stop()

    def resize(self, width, height, look="light"):
        """Give the page a size in pixels, and light or dark colors."""
        size = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": self.how == "touch" or width < 500}
        self.browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
        feature = {"features": [{"name": "prefers-color-scheme", "value": look}]}
        self.browser.execute_cdp_cmd("Emulation.setEmulatedMedia", feature)

    def run(self, script, *arguments):
        """Return the result of a script in the page."""
        return self.browser.execute_script(script, *arguments)

    def until(self, happened, seconds=TIMEOUT):
        """Wait for something; return it."""
        return WebDriverWait(self.browser, seconds, 0.05, CHANGES).until(lambda _browser: happened())

    def text(self, selector):
        """Return the visible text of a selector."""
        return "".join(each.text for each in self.browser.find_elements(By.CSS_SELECTOR, selector))

    def shown(self, selector):
        """Return the visible elements of a selector."""
        return self.run(SHOWN, selector)

    @property
    def errors(self):
        """Errors of the browser's console."""
        return [entry["message"] for entry in self.browser.get_log("browser") if entry["level"] == "SEVERE"]

    def judge(self, name):
        """Note what axe-core finds on the page, and whether it is wider than the window."""
        for fault in Axe().run(self.browser)["violations"]:
            targets = [node["target"] for node in fault["nodes"]][:3]
            self.faults.append(f"{name}: {fault['id']} ({fault['impact']}): {targets}")
        if self.run("return document.documentElement.scrollWidth > innerWidth"):
            self.faults.append(f"{name}: wider than the window")

    # What the person does

    def press(self, element, across=0.5):
        """Press an element, at a part of its width from the left.

        Raises:
            ElementClickInterceptedException: something covers it; if it still does at the next press, note a fault.
            ElementNotInteractableException: it is not shown any more.
        """
        if self.how == "keyboard":
            self.reach(element)
            self.type(Keys.SPACE)
            return
        place = self.run(PLACE, element, across)
        if place["gone"]:
            raise ElementNotInteractableException("the page has changed")
        covered = place["covered"] and f"{element.get_attribute('outerHTML')[:200]} is covered by {place['covered']}"
        before, self._covered = self._covered, covered
        if covered and covered != before:
            raise ElementClickInterceptedException(covered)  # Something may have come up since the last look.
        if covered:
            self.faults.append(covered)
        if self.how == "touch":
            points = [{"x": place["x"], "y": place["y"]}]
            for kind, touched in (("touchStart", points), ("touchEnd", [])):
                self.browser.execute_cdp_cmd("Input.dispatchTouchEvent", {"type": kind, "touchPoints": touched})
        else:
            offset = round((across - 0.5) * element.rect["width"])
            ActionChains(self.browser, duration=0).move_to_element_with_offset(element, offset, 0).click().perform()

    def press_first(self, selector):
        """Press the first visible element of a selector, if there is one."""
        for element in self.shown(selector)[:1]:
            self.press(element)

    def type(self, keys):
        """Press keys in the element that has the focus."""
        self.browser.switch_to.active_element.send_keys(keys)

    def press_key(self, name):
        """Press a key as the page names it, such as "Ctrl+K"."""
        *held, key = name.split("+")
        pressed = KEYS.get(key) or getattr(Keys, key.upper(), key.lower())
        chain = ActionChains(self.browser, duration=0)
        for each in held:
            chain.key_down(getattr(Keys, {"Ctrl": "CONTROL"}.get(each, each.upper())))
        chain.send_keys(pressed)
        for each in held:
            chain.key_up(getattr(Keys, {"Ctrl": "CONTROL"}.get(each, each.upper())))
        chain.perform()

    def reach(self, element, key=Keys.TAB):
        """Press a key until an element has the focus; note a fault if it does not get there, or is not marked."""
        for _ in range(MOST_STOPS):
            if self.browser.switch_to.active_element == element:
                if not self.run(FOCUS_IS_SEEN):
                    self.faults.append(f"the focus is not visible on {element.get_attribute('outerHTML')[:200]}")
                return
            self.type(key)
        self.faults.append(f"the keyboard does not reach {element.get_attribute('outerHTML')[:200]}")
        raise TimeoutError(self.faults[-1])
