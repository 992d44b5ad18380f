"""Program of another environment: a person in Chromium, who takes part in a whole study by mouse, keyboard or touch.

Arguments: port of the gateway; "mouse", "keyboard" or "touch"; width and height of the page; the answers, a JSON list
with an object for each page with questions, in order: item to answer; folder for pictures. It prints a JSON object:
`code`, the completion code; `pages`, the names of all pages; `marks`, the values of marked lines; `errors` of the
browser's console; `faults`, see `DrivenChromium`.
"""

import json
import sys
import time
from contextlib import suppress

from driven_chromium import CHANGES, TIMEOUT, DrivenChromium
from selenium.common.exceptions import TimeoutException
from selenium.webdriver.common.keys import Keys

LOOKING = 0.45
"""Seconds for which a person looks at a page before acting, because pages ignore earlier presses."""
TOUCH_AGAIN = 10.0
"""Seconds without an effect after which a person touches a button again."""
DISAGREEING = ("Why not room", "I still want")
"""Parts of the answers of a person who does not agree."""
INSISTING = (*DISAGREEING, "I want this", "Go to room")
"""Parts of the answers of a person who persuades."""
SHEETS = 3
"""Number of sheets that buttons above a page open: instructions, settings, and the question whether to stop."""
MOST_REGIONS = 12
"""Greatest number of presses of F6 until a region has the focus."""


class StudyPerson(DrivenChromium):
    """Person who reads, answers and plays."""

    def __init__(self, port, how, width, height, answers, folder):
        super().__init__(how, width, height)
        self.answers, self.folder = answers, folder
        self.pages, self.marks, self.has_read, self.kind = [], {}, set(), ""
        self.went_back = self.is_back = self.has_looked_around = False
        self.has_disagreed = self.insists = self.has_played = False
        self.browser.get(f"http://127.0.0.1:{port}/")

    def look(self, name):
        """Check a page, and take a picture of it, when it is seen for the first time."""
        if name not in self.pages:
            self.pages.append(name)
            self.browser.save_screenshot(f"{self.folder}/{self.how}-{len(self.pages):02}-{name.replace(' ', '-')}.png")
            self.judge(name)

    def take_part(self):
        """Go through the study; return the completion code."""
        while True:
            time.sleep(LOOKING)
            try:
                if self.shown(".game .playing"):
                    self.play()
                elif self.shown(".waiting-page") or not self.shown(".reading:not(#first) h1"):
                    pass
                elif self.shown(".item"):
                    self.fill_in()
                elif buttons := self.shown(".reading footer button"):
                    self.read(buttons)
                elif code := self.shown(".code"):
                    self.look("end")
                    return code[0].text.replace(" ", "")
            except (*CHANGES, IndexError):
                pass  # The page has changed between two looks at it.

    def leave(self, button):
        """Press a button until the page has changed. A slow browser drops touches, so a person touches again."""
        article = self.shown(".reading")[0]
        for seconds in (TOUCH_AGAIN, TIMEOUT) if self.how == "touch" else (TIMEOUT,):
            self.press(button)
            with suppress(TimeoutException):
                self.until(lambda: not self.shown(".reading") or self.shown(".reading")[0] != article, seconds)
                return
        raise TimeoutError(f"the page did not change: {self.text('.reading')[:200]}")

    # Pages

    def read(self, buttons):
        """Read a text, and go on; open all sheets once."""
        heading = self.text(".reading h1")
        self.look(heading)
        if not self.has_looked_around and len(self.shown("#strip .acts button")) == SHEETS:
            self.has_looked_around = True
            for number in range(SHEETS):
                self.press(self.shown("#strip .acts button")[number])
                self.look(f"sheet {number}")
                self.press(self.shown("dialog[open] footer button")[-1])
        self.leave(buttons[0])

    def fill_in(self):
        """Answer the questions of a page; on the second page of a form, go back once."""
        names = [each.get_attribute("id").removeprefix("item-") for each in self.shown(".question-text")]
        self.look(f"form {' '.join(names)}")
        go, back = self.shown(".reading footer .main")[0], self.shown(".reading footer button:not(.main)")
        if back and not self.went_back:
            self.went_back = self.is_back = True
            self.leave(back[0])
        elif self.is_back:
            self.is_back = False
            self.leave(go)
        else:
            answers = self.answers.pop(0)
            assert sorted(names) == sorted(answers), (names, answers)
            for name in names:
                self.answer(name, answers[name])
            self.look(f"answers {' '.join(names)}")
            self.leave(go)

    def answer(self, name, answer):
        """Answer a question; None leaves it without an answer."""
        (item,) = [each for each in self.shown(".item") if each.find_elements("id", f"item-{name}")]
        scale = item.find_element("css selector", ".field").get_attribute("class").split()[-1]
        if answer is None:
            return
        if answer == "timed out":
            self.until(lambda: not item.find_element("css selector", "input").is_enabled())
        elif answer == "not applicable":
            self.press(item.find_elements("css selector", "[role=checkbox]")[-1])
        elif scale == "analogue":
            self.mark(name, item.find_element("css selector", "input"), answer)
        elif scale in {"text", "number"}:
            box = item.find_element("css selector", "input, textarea")
            self.reach(box) if self.how == "keyboard" else self.press(box)
            self.type(str(answer))
        else:
            for value in answer if isinstance(answer, list) else [answer]:
                self.choose(item, next(
                    each for each in item.find_elements("css selector", "[data-value]")
                    if each.get_attribute("data-value") == str(value)
                ))  # fmt: skip

    def choose(self, item, option):
        """Choose an answer; with the keyboard, go to the first one by Tab and on by arrow keys."""
        if self.how != "keyboard":
            self.press(option)
            return
        self.reach(item.find_element("css selector", "[data-value]"))
        self.reach(option, Keys.ARROW_DOWN)
        self.type(Keys.SPACE)

    def mark(self, name, line, share):
        """Mark a line at a share of its length, and note the value."""
        if self.how == "keyboard":
            self.reach(line)
            self.type(Keys.ARROW_RIGHT)  # It marks the middle.
            least, most = (float(line.get_attribute(each)) for each in ("min", "max"))
            while float(line.get_attribute("value")) < least + share * (most - least):
                self.type(Keys.ARROW_RIGHT)
        else:
            self.press(line, share)
        self.marks[name] = float(line.get_attribute("value"))

    # Games

    def play(self):
        """Do the next thing in a game."""
        back = self.shown("#strip .to-do button")
        if back and not back[0].get_attribute("aria-disabled"):
            self.look("practice is done")
            self.press_in_game(back[0])
            return
        self.kind = "practice" if back else "trial"
        for selector, deed in (
            ("dialog.help[open] footer button", self.close_help),
            ("dialog.question[open] footer button", self.confirm),
            (".names [role=option]", self.name_treasure),
            (".pops > :nth-child(1) footer button", self.answer_robot),
            (".pops .verdict", self.close_verdict),
            (".pops > :nth-child(3) footer button", self.leave_game),
            (".waiting button", self.go_on),
            (".tile:not([aria-disabled])", self.go_on),
            (".card .face[aria-pressed=false]", self.go_on),
        ):
            if found := self.shown(selector):
                deed(found)
                return

    def press_in_game(self, element):
        """Press a button; with the keyboard, by its key, or after going there by F6 and arrow keys."""
        if self.how != "keyboard":
            self.press(element)
            return
        is_tile = "tile" in element.get_attribute("class")
        named = element.find_elements("css selector", ".label" if is_tile else "kbd")
        if named and (key := named[0].get_attribute("textContent")):
            self.press_key(key)
            return
        within = "return arguments[0].closest('.region, #strip').contains(document.activeElement)"
        for _ in range(MOST_REGIONS):
            if self.run(within, element):
                break
            self.press_key("F6")
        self.reach(element, Keys.ARROW_DOWN)
        self.type(Keys.ENTER)

    def close_help(self, buttons):
        self.look("rules")
        self.press_in_game(buttons[0])

    def confirm(self, buttons):
        self.look("question")
        self.press_in_game(buttons[0])

    def name_treasure(self, names):
        """Choose a name, and ask the robot for its own."""
        self.look(f"{self.kind} treasure")
        if self.how == "keyboard":
            self.type(Keys.ARROW_DOWN)
        else:
            self.press(names[0])
        self.press_in_game(self.shown(".pops > :nth-child(2) footer button")[1])

    def answer_robot(self, answers):
        """Agree in practice and about names; in the trial, disagree about the first room, and insist on the next."""
        self.look(f"{self.kind} dialogue")
        labels = [each.find_element("css selector", ".label").text for each in answers]
        chosen = 0
        if self.kind == "trial" and "go to room" in self.text(".pops > :nth-child(1) h2"):
            parts = INSISTING if self.insists else DISAGREEING
            wanted = [index for part in parts for index, label in enumerate(labels) if part in label]
            chosen = wanted[0] if wanted else 0 if self.insists else -1
            self.has_disagreed |= chosen == -1
        self.press_in_game(answers[chosen])

    def close_verdict(self, _verdict):
        self.look(f"{self.kind} verdict")
        self.has_played = self.insists
        self.press_in_game(self.shown(".pops > :nth-child(2) header button")[0])

    def leave_game(self, buttons):
        self.look(f"{self.kind} is over")
        self.press_in_game(buttons[0])

    def go_on(self, buttons):
        """Choose a room, or what waits; read the rules first, and end the trial after a treasure."""
        self.look(f"{self.kind} rooms")
        *_, rules, end = self.shown(".tools button")
        if self.kind not in self.has_read:
            self.has_read.add(self.kind)
            self.press_in_game(rules)
        elif self.has_played and self.kind == "trial":
            self.press_in_game(end)
        else:
            self.insists = self.has_disagreed
            self.press_in_game(buttons[0])


def main(port, how, width, height, answers, folder):
    with StudyPerson(int(port), how, int(width), int(height), json.loads(answers), folder) as person:
        code = person.take_part()
        result = {"code": code, "pages": person.pages, "marks": person.marks}
        print(json.dumps({**result, "errors": person.errors, "faults": person.faults}))


main(*sys.argv[1:])
