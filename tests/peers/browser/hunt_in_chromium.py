"""Program of another environment: a person in Chromium, who plays a whole game by mouse, keyboard or touch.

Arguments: port of the gateway; "mouse", "keyboard" or "touch"; width and height of the page; folder for pictures. It
prints a JSON object: `ended`, the score, errors of the browser's console, and what axe-core finds on each page.
"""

import json
import sys
import time

from driven_chromium import CHANGES, DrivenChromium
from selenium.webdriver.common.keys import Keys

PATIENCE = 240.0
"""Seconds for the whole game."""


class Player(DrivenChromium):
    """Person in front of the page."""

    def __init__(self, port, how, width, height, folder):
        super().__init__(how, width, height)
        self.folder, self.seen = folder, set()
        self.browser.get(f"http://127.0.0.1:{port}/")

    def press_or_type(self, element, key):
        """Press a button, or its key."""
        if self.how == "keyboard":
            self.type(key)
        else:
            self.press(element)

    def look(self, page):
        """Check a page with axe-core, and take a picture, when it is seen for the first time."""
        if page in self.seen:
            return
        self.seen.add(page)
        self.browser.save_screenshot(f"{self.folder}/{self.how}-{page}.png")
        self.judge(page)

    def step(self):
        """Do the next thing; return True at the end."""
        question = self.shown("dialog.question[open] footer button")
        if question:
            self.look("question")
            self.press_or_type(question[0], "y")
            return False
        names = self.shown(".names [role=option]")
        answers = self.shown(".pops footer button")
        if names:
            self.look("treasure")
            self.press_or_type(names[0], Keys.ARROW_DOWN)
            time.sleep(0.5)
            self.press_or_type(self.shown(".pops footer button")[0], Keys.ENTER)
        elif answers:
            self.look("over" if "ending" in self.shown(".pops > section")[0].get_attribute("class") else "dialogue")
            self.press_or_type(answers[0], Keys.ENTER)
        elif self.shown(".waiting button"):
            self.look("waiting")
            self.press_or_type(self.shown(".waiting button")[0], "w")
        elif tiles := [tile for tile in self.shown(".tile") if not tile.get_attribute("aria-disabled")]:
            self.look("rooms")
            self.press_or_type(tiles[0], tiles[0].text[0])
        elif cards := [card for card in self.shown(".card .face") if card.get_attribute("aria-pressed") != "true"]:
            self.look("driving")
            self.press_or_type(cards[0], Keys.TAB)
        elif self.thanks in [heading.text for heading in self.shown(".reading h1")]:
            self.look("thanks")
            return True
        elif begin := self.shown(".reading button.main"):
            self.look("start")
            self.press_or_type(begin[0], Keys.ENTER)
        return False

    thanks = "Thank you"


def main():
    port, how, width, height, folder = sys.argv[1:]
    person = Player(int(port), how, int(width), int(height), folder)
    ended, end, score = False, time.monotonic() + PATIENCE, ""
    while not ended and time.monotonic() < end:
        time.sleep(0.45)
        try:
            if person.shown(".score"):
                score = person.shown(".score")[0].text
            ended = person.step()
        except (*CHANGES, IndexError):
            pass  # The page has changed between two looks at it.
    result = {"ended": ended, "score": score, "pages": sorted(person.seen)}
    print(json.dumps({**result, "errors": person.errors, "faults": person.faults}))
    person.browser.quit()


main()
