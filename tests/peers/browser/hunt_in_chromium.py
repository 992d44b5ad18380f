"""Program of another environment: a person in Chromium, who plays a whole game by mouse, keyboard or touch.

Arguments: port of the gateway; "mouse", "keyboard" or "touch"; width and height of the page; folder for pictures. It
prints a JSON object: `ended`, the score, errors of the browser's console, and what axe-core finds on each page.
"""

import json
import sys
import time

from axe_core_python.selenium import Axe
from selenium import webdriver
from selenium.common.exceptions import WebDriverException
from selenium.webdriver.chrome.options import Options
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys

PATIENCE = 240.0
"""Seconds for the whole game."""


class Person:
    """Person in front of the page."""

    def __init__(self, port, how, width, height, folder):
        options = Options()
        options.binary_location = "/usr/bin/chromium"
        for flag in ("--headless=new", "--no-sandbox", "--mute-audio", "--disable-dev-shm-usage"):
            options.add_argument(flag)
        options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
        self.browser = webdriver.Chrome(options=options, service=Service("/usr/bin/chromedriver"))
        size = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": how == "touch"}
        self.browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
        if how == "touch":
            self.browser.execute_cdp_cmd("Emulation.setTouchEmulationEnabled", {"enabled": True})
        self.how, self.folder = how, folder
        self.seen, self.faults = set(), []
        self.browser.get(f"http://127.0.0.1:{port}/")

    def shown(self, selector):
        """The visible elements of a selector."""
        return [each for each in self.browser.find_elements(By.CSS_SELECTOR, selector) if each.is_displayed()]

    def press(self, element, key):
        """Press a button, or its key."""
        if self.how == "keyboard":
            self.browser.switch_to.active_element.send_keys(key)
        elif self.how == "touch":
            element.click()
        else:
            element.click()

    def look(self, page):
        """Check a page with axe-core, and take a picture, when it is seen for the first time."""
        if page in self.seen:
            return
        self.seen.add(page)
        self.browser.save_screenshot(f"{self.folder}/{self.how}-{page}.png")
        for fault in Axe().run(self.browser)["violations"]:
            targets = [node["target"] for node in fault["nodes"]][:3]
            self.faults.append(f"{page}: {fault['id']} ({fault['impact']}): {targets}")

    def step(self):
        """Do the next thing; return True at the end."""
        question = self.shown("dialog.question[open] footer button")
        if question:
            self.look("question")
            self.press(question[0], "y")
            return False
        names = self.shown(".names [role=option]")
        answers = self.shown(".pops footer button")
        if names:
            self.look("treasure")
            self.press(names[0], Keys.ARROW_DOWN)
            time.sleep(0.5)
            self.press(self.shown(".pops footer button")[0], Keys.ENTER)
        elif answers:
            self.look("over" if "ending" in self.shown(".pops > section")[0].get_attribute("class") else "dialogue")
            self.press(answers[0], Keys.ENTER)
        elif self.shown(".waiting button"):
            self.look("waiting")
            self.press(self.shown(".waiting button")[0], "w")
        elif tiles := [tile for tile in self.shown(".tile") if not tile.get_attribute("aria-disabled")]:
            self.look("rooms")
            self.press(tiles[0], tiles[0].text[0])
        elif cards := [card for card in self.shown(".card .face") if card.get_attribute("aria-pressed") != "true"]:
            self.look("driving")
            self.press(cards[0], Keys.TAB)
        elif self.thanks in [heading.text for heading in self.shown(".reading h1")]:
            self.look("thanks")
            return True
        elif begin := self.shown(".reading button.main"):
            self.look("start")
            self.press(begin[0], Keys.ENTER)
        return False

    thanks = "Thank you"


def main():
    port, how, width, height, folder = sys.argv[1:]
    person = Person(int(port), how, int(width), int(height), folder)
    ended, end, score = False, time.monotonic() + PATIENCE, ""
    while not ended and time.monotonic() < end:
        time.sleep(0.45)
        try:
            if person.shown(".score"):
                score = person.shown(".score")[0].text
            ended = person.step()
        except IndexError:
            pass  # The page has changed between two looks at it.
        except WebDriverException as moved:
            # The page has changed between a look at it and the press.
            if not any(word in str(moved) for word in ("stale", "interact", "intercept")):
                raise
    logged = [entry["message"] for entry in person.browser.get_log("browser") if entry["level"] == "SEVERE"]
    print(
        json.dumps(
            {"ended": ended, "score": score, "pages": sorted(person.seen), "errors": logged, "faults": person.faults}
        )
    )
    person.browser.quit()


main()
