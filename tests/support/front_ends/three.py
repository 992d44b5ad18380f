"""The same hunt in the window, in the browser and at the terminal, with the same acts at the same moments."""

import json
import re
from collections.abc import Callable
from typing import Any

from tests.support.front_ends.at_browser import BrowserPerson
from tests.support.front_ends.at_terminal import TerminalPerson, deeds_on
from tests.support.front_ends.at_window import WindowPerson
from tests.support.front_ends.person import Person
from tests.support.front_ends.shown import Deed, Shown
from tests.support.hunts.study_without_simulator import StudyWithoutSimulator
from thbridge.dialogue.wording.texts import NamedRoom, Texts
from thbridge.study.study_file import Study
from ui.model.playing.screen import Act, Confirm, PickName

TICKS = 20
"""Ticks of a step: content that has appeared can then be answered."""

NUMBER = 98765
"""Number in a text at whose place any number is read."""


class ThreeFrontEnds:
    """A person at each front end, all three of whom do the same.

    Attributes:
        faults: what differed so far: the number of the step, the act, and the differences.
    """

    def __init__(self, study: Study) -> None:
        self.window, self.browser, self.terminal = WindowPerson(study), BrowserPerson(study), TerminalPerson(study)
        self.people: tuple[Person, ...] = (self.window, self.browser, self.terminal)
        self.faults: list[tuple[int, Act | None, object]] = []
        self.steps = 0
        self._picked: str | None = None
        # Command of an act that the other front ends ask to confirm.
        self._held = ""

    @property
    def page(self) -> dict[str, Any]:
        """Tree of the browser's page."""
        return self.browser.tree

    @property
    def shown(self) -> Shown:
        """What the browser shows."""
        return self.browser.shown()

    def outside(self, change: Callable[[StudyWithoutSimulator], None]) -> None:
        """Change all three games from outside."""
        for person in self.people:
            change(person.game)

    def step(self, act: Act | None = None) -> None:
        """Do an act at all front ends, let the games go on, and compare. If None, only wait."""
        self.steps += 1
        printed = len(self.terminal.lines)
        refused = act is not None and act in self.shown.offers and not self.shown.offers[act].possible
        reason = self.shown.offers[act].hint if act is not None and refused else ""
        if act is not None:
            self._do(act)
        self._wait()
        different: dict[str, object] = dict(self.window.shown().differences(self.shown))
        if refused and not (reason == self.page["banner"] and reason in self.terminal.lines[printed:]):
            different["reason"] = reason, self.page["banner"], self.terminal.lines[printed:]
        different |= self._against_terminal()
        if different:
            self.faults.append((self.steps, act, different))
        first, *others = [[str(event) for event in person.game.log.events] for person in self.people]
        assert all(each == first for each in others), (act, [each[-2:] for each in (first, *others)])

    def _wait(self) -> None:
        """Let the games go on until the content has been there long enough to be answered; see `AnswerGuard`."""
        before = None
        for _ in range(20):
            for person in self.people:
                person.wait(TICKS)
            page = self.page
            now = json.dumps([page.get(part) for part in ("dialogue", "treasure", "question", "ending")])
            if now == before:
                return
            before = now

    def _do(self, act: Act) -> None:
        line = self.terminal.line_for(act, self.page, self._picked) if self.page["cards"] else ""
        if isinstance(act, Confirm):
            line = self._held
        if isinstance(act, PickName):
            self._picked = act.name
        for person in self.people:
            person.press(act)
        self._held = line if self.page["question"] else ""
        if line and not self._held:
            self.terminal.type(line)

    # The terminal has other words; what both say is compared.

    def _against_terminal(self) -> dict[str, object]:
        page, texts = self.page, self.terminal.texts
        if page["question"]:
            return {}  # The terminal asks no questions: a command that was typed is not a slip of the hand.
        if page["ending"]:
            missing = [line for line in page["ending"]["lines"] if line not in self.terminal.lines]
            return {"ending": missing} if missing else {}
        found: dict[str, object] = {}
        # While a request is on its way, the other front ends do not offer it again.
        if not any(offer.pending for offer in self.shown.offers.values()):
            there, here = deeds_on(page, self.shown, texts), self._in_sight(self.terminal.deeds())
            if there != here:
                found["deeds"] = there - here, here - there
        state = [line.strip() for line in self.terminal.printed("?")]
        expected = self._state(page, texts)
        if lacking := [line for line in expected if not any(re.fullmatch(line, each) for each in state)]:
            found["state"] = lacking, state
        return found | self._sentences(page)

    def _in_sight(self, deeds: set[Deed]) -> set[Deed]:
        """Return the deeds that concern the selected robot and the pop-up shown.

        The terminal has no selected robot and no pop-ups, so it offers at once what the other front ends offer after a
        press on another robot, or on a pop-up that waits.
        """
        page = self.page
        robot = next(card["robot"] for card in page["cards"] if card["selected"])
        talks = page["dialogue"] and page["dialogue"]["robot"]
        room = page["treasure"] and page["treasure"]["room"]
        about = {"go": robot, "advice": robot, "answer": talks, "picture": room, "name": room, "ask name": room}
        about |= {"leave": room, "measure": room, "tell": room}
        drives = {card["robot"] for card in page["cards"] if card["progress"] is not None}
        # The other front ends also offer rooms to a driving robot, and stop it first. Here, a person stops it.
        return {
            deed for deed in deeds if deed[0] not in about or (about[str(deed[0])] == deed[1] and deed[1] is not None)
        } | {("go", robot, tile["room"]) for tile in page["tiles"] if robot in drives and tile["choose"]["enabled"]}

    def _state(self, page: dict[str, Any], texts: Texts) -> list[str]:
        """Return patterns of the lines about the state of the game that follow from a page."""
        names = self.terminal.tabui.room_names.named
        lines = []
        for card in page["cards"]:
            robot = card["robot"]
            goal = next((t["room"] for t in page["tiles"] if (t["state"], t["robot"]) == ("reserved", robot)), None)
            place = next(
                room for room in range(len(page["tiles"]) + 1)
                if card["place"] in (texts.room(room, "in"), texts.room(room, "from"))
            )  # fmt: skip
            room = NamedRoom(place if goal is None else goal, names.get(place if goal is None else goal, ""))
            energy = _number(texts.text("window.energy_of", energy=NUMBER, full=0), card["select"]["spoken"])
            key = "terminal.in_room" if goal is None else "terminal.under_way"
            lines.append(re.escape(texts.text(key, robot=robot, energy=NUMBER, room=room)).replace(str(NUMBER), energy))
            for condition in ("lost", "silent"):
                if card["state"] in {texts.text(f"cards.{each}") for each in (condition, f"{condition}_driving")
                                     if texts.has(f"cards.{each}")}:  # fmt: skip
                    lines.append(re.escape(texts.text(f"terminal.{condition}", robot=robot)))
            if card["commander"]:
                said = texts.text("terminal.commanded", robot=robot, commander=card["commander"])
                lines.append(f"(?i:{re.escape(said)})")
        for tile in page["tiles"]:
            if tile["state"] == "visited" and tile["found"] and tile["found"][-1] != texts.text("tiles.left"):
                value = re.escape(tile["found"][-1])
                named = texts.text("terminal.found", room=NamedRoom(tile["room"], names.get(tile["room"], "")))
                lines.append(f"(?i:{re.escape(named.split(':')[0])}: .*{value}.*)")
        free = [tile["room"] for tile in page["tiles"] if tile["state"] == "unvisited"]
        rooms = " ".join(self.terminal.tabui.room_names.numbered(room) for room in free)
        score = int(page["score"].replace("−", "-"))
        key = "terminal.not_visited" if free else "terminal.all_visited"
        lines.append(re.escape(texts.text(key, rooms=rooms, score=score)))
        return lines

    def _sentences(self, page: dict[str, Any]) -> dict[str, object]:
        """Return the robots whose sentences in the history are not those that the terminal has printed."""
        found: dict[str, object] = {}
        for card in page["cards"]:
            who = card["name"]
            said = [f"{who}: {each['text']}" for each in page["history"] if each["speaker"] == "robot"
                    and each["robot"] == card["robot"]]  # fmt: skip
            printed = [line for line in self.terminal.lines if line.startswith(f"{who}: ")]
            if len(said) != len(printed) or not all(map(str.startswith, printed, said)):
                found[f"sentences of {who}"] = said[-3:], printed[-3:]
        return found


def _number(template: str, words: str) -> str:
    """Return the number in words at the place of `NUMBER` in a text, as a pattern."""
    before = template.split(str(NUMBER), maxsplit=1)[0]
    found = re.search(re.escape(before) + r"([\d.,]+?)(?=[^\d.,]|[.,]?$)", words)
    assert found is not None, (template, words)
    return re.escape(found[1])
