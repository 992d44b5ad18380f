"""Person who goes through any study in a browser: reads, answers, plays what the page offers, and loses connections."""

import asyncio
import http.client
import math
import random
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any

from websockets.exceptions import ConnectionClosed, InvalidHandshake

from tests.support.programs.browser_client import BrowserClient
from thbridge.experiment.design.experiment_file import ExperimentDesign
from thbridge.experiment.questionnaires.form import Item
from thbridge.experiment.rehearsal.people import SimulatedPeople

READING = 0.4
"""Seconds for which a person looks at the page of a game before they act, because the page ignores earlier acts."""
PAGES = {"text", "consent", "form", "wait", "turn", "game", "recorded", "elsewhere", "stopped", "closed"}
LAST_PAGES = {"stopped", "closed"}


@dataclass(frozen=True)
class Manner:
    """Behavior of a person. Probabilities hold for each page of the study, and for each act in a game.

    Attributes:
        people: properties of simulated people: their answers, and the probability that they drop out at a page.
        agrees: True if they agree to take part.
        acts: number of acts in each game.
        ends: True if they end each game after these acts.
        reloads: probability that they load the page again.
        losses: probability that their connection breaks; their browser connects again.
        reads: longest time for a page with a text, a consent or a form, seconds.
        says: text that they send to the other people at the beginning of each game; empty for none.
    """

    people: SimulatedPeople = field(default_factory=SimulatedPeople)
    agrees: bool = True
    acts: int = 6
    ends: bool = True
    reloads: float = 0.0
    losses: float = 0.0
    reads: float = 0.0
    says: str = ""


class BrowserPerson:
    """Person in front of a browser.

    Args:
        port: port of the gateway.
        design: design of the study, from which they know the right answers.
        manner: their behavior.
        seed: random seed of all their choices.
        query: parameters of their link.

    Attributes:
        browser: their browser.
        manner: their behavior.
        given: last answer that they have given to each item of a form, by the step of the form.
        code: their completion code; empty before they have one.
        ending: completion code for a recruiting service; empty before they have one.
        acts: names of all acts that they have done in games.
        pages: headings of the pages that they have seen, without repetitions.
        interruptions: number of reloads and lost connections.
        has_begun: True if they have had a place in the study.
        waited: seconds for which they have waited for a place, for others or for a game.
        seats: seats that they have had in games of several people.
        heard: texts of all people in these games, also their own.
    """

    def __init__(self, port: int, design: ExperimentDesign, manner: Manner, seed: int, query: str = "") -> None:
        self.browser = BrowserClient(port)
        self.given: dict[str, dict[str, object]] = {}
        self.code = self.ending = ""
        self.acts: list[str] = []
        self.pages: list[str] = []
        self.interruptions = 0
        self.has_begun = False
        self.waited = 0.0
        self.seats: set[str] = set()
        self.heard: set[str] = set()
        self._query = query
        self._waits_since = math.inf
        self._items = {(form.title, item.id): item for form in design.forms.values() for item in form.items}
        self.manner = manner
        self._random = random.Random(seed)
        self._left = self._read = self._played = self._talked = 0
        self._in_game = 0

    async def go_through(self) -> str:
        """Go through the study; return the heading of the last page."""
        await self.reload()
        return await self.go_on()

    async def go_on(self, until: Callable[[], object] = lambda: False) -> str:
        """Go on from the present page until something happens, or to the end; return the heading of the last page."""
        while not until():
            await self._stay_connected()
            shown = self._shown
            if shown["t"] in LAST_PAGES or (shown["t"] == "text" and not shown["button"]):
                self._see(shown)
                await self.browser.close()
                return self.pages[-1]
            with suppress(ConnectionClosed):
                await self._react(shown)
        return self.pages[-1] if self.pages else ""

    async def reload(self) -> None:
        """Load the page, or load it again; try until the server answers."""
        while True:
            await self.browser.close()
            self.browser.study.clear()
            self.browser.tree = {}
            self._left = self._read = self._played = self._talked = 0
            with suppress(OSError, InvalidHandshake, http.client.HTTPException):
                await asyncio.to_thread(self.browser.load, self._query)
                await self.browser.open()
                return
            await asyncio.sleep(0.1)

    async def stop(self) -> None:
        """Stop taking part, by the button of the page."""
        await self._send({"type": "StoppedTakingPart"})

    @property
    def shown(self) -> str:
        """Kind of the page that they see; empty before the first."""
        return str(self._shown["t"])

    @property
    def plays(self) -> bool:
        """True while the page of a game is complete."""
        return self.browser.tree.get("phase") == "playing" and bool(self.browser.tree["tiles"])

    async def lose_connection(self) -> None:
        """Break the connection without a farewell."""
        self.browser.abort()
        await self.browser.close()

    # Pages

    @property
    def _shown(self) -> dict[str, Any]:
        """The last page; without contents before the first."""
        pages = (message for message in reversed(self.browser.study) if message["t"] in PAGES)
        return next(pages, {"t": "", "page": 0})

    async def _stay_connected(self) -> None:
        """Connect again as the page does: by a new connection, or by a new page if the server does not know it."""
        if self.browser.is_connected:
            return
        received = len(self.browser.texts)
        with suppress(OSError, InvalidHandshake):
            await self.browser.open()
            await self.browser.until(lambda: len(self.browser.texts) > received or not self.browser.is_connected)
        if len(self.browser.texts) == received:
            await self.reload()

    async def _react(self, shown: dict[str, Any]) -> None:
        number, kind = shown["page"], shown["t"]
        self._see(shown)
        if self._is_in_game(shown):
            await self._play(shown)
        elif kind in {"", "wait", "turn", "elsewhere"} or number == self._left:
            await asyncio.sleep(0.02)
        elif await self._interrupted():
            pass
        elif kind != "recorded" and shown["step"] and self._random.random() < self.manner.people.drop_out:
            self._left = number
            await self.stop()
        elif self.manner.reads and self._read != number:
            self._read = number
            await asyncio.sleep(self._random.uniform(0.0, self.manner.reads))
        elif kind == "consent":
            await self._leave(number, "ConsentReply", agrees=self.manner.agrees, window_ns=self._nanoseconds)
        else:
            if kind == "form":
                await self._fill_in(shown)
            await self._leave(number, "WentOn")

    def _see(self, shown: dict[str, Any]) -> None:
        heading = shown.get("heading", "")
        if heading and (not self.pages or self.pages[-1] != heading):
            self.pages.append(heading)
        self.has_begun |= bool(shown.get("step"))
        if shown.get("code"):
            self.code = shown["code"]["code"].replace(" ", "")
        if shown.get("ending"):
            self.ending = shown["ending"].get("code", "")
        now = self.browser.now / 1000.0
        if shown["t"] == "turn":
            self._waits_since = min(self._waits_since, now)
        else:
            self.waited += max(0.0, now - self._waits_since)
            self._waits_since = math.inf

    async def _interrupted(self) -> bool:
        """Reload the page or lose the connection, if it happens now."""
        drawn = self._random.random()
        if drawn < self.manner.reloads:
            self.interruptions += 1
            await self.reload()
            return True
        if drawn < self.manner.reloads + self.manner.losses:
            self.interruptions += 1
            await self.lose_connection()
            return True
        return False

    async def _leave(self, page: int, message: str, **fields: object) -> None:
        self._left = page
        await self._send({"type": message, "page": page, **fields})

    async def _send(self, message: dict[str, Any]) -> None:
        """Send a message; without a connection, the browser sends it when it is connected again."""
        with suppress(ConnectionClosed):
            await self.browser.send(message)

    @property
    def _nanoseconds(self) -> int:
        return round(self.browser.now * 1e6)

    # Forms

    async def _fill_in(self, form: dict[str, Any]) -> None:
        for item in form["items"]:
            if item["id"] in form["answers"] or item["id"] in form["timed_out"]:
                continue
            answer = self._answer(form["heading"], item)
            for what in ("shown", "touched", "changed", "given"):
                news = {"type": "ItemNews", "page": form["page"], "item": item["id"], "what": what}
                known = answer if what in {"changed", "given"} else None
                await self._send({**news, "window_ns": self._nanoseconds, "answer": known})
            self.given.setdefault(form["step"], {})[item["id"]] = answer

    def _answer(self, title: str, shown: dict[str, Any]) -> object:
        item: Item | None = self._items.get((title, shown["id"]))
        if item is None:
            return "an answer"
        drawn = self._random
        answer = self.manner.people.answer(item, {}, 0.0, drawn.random, lambda: drawn.normalvariate(0.0, 1.0))
        return [answer] if item.several and isinstance(answer, str) else answer

    # Games

    def _is_in_game(self, shown: dict[str, Any]) -> bool:
        """Return True while the page shows the game: a game that has ended stays, until the person leaves it."""
        if shown["t"] == "game":
            self._in_game = self._in_game if shown["page"] == self._played else 0
            return True
        return bool(
            shown["t"] == "recorded" and self.browser.tree.get("ending") and self._game["page"] == shown["page"]
        )

    @property
    def _game(self) -> dict[str, Any]:
        """The last message about a game, with its progress; without contents before the first."""
        about = [message for message in self.browser.study if message["t"] in {"game", "news"}]
        return about[-1] if about else {"page": 0}

    async def _play(self, shown: dict[str, Any]) -> None:
        """Do one thing in the game."""
        await asyncio.sleep(READING)
        tree = self.browser.tree
        if tree.get("phase") not in {"playing", "over"} or await self._interrupted():
            return
        await self._talk(shown["page"], tree["people"])
        if shown.get("practice") and self._game["done"] and not tree["ending"]:
            await self._leave(shown["page"], "WentOn")
            return
        wanted = self._wanted(tree)
        self._played = shown["page"]
        self._in_game += 1
        if wanted is not None:
            self.acts.append(wanted["act"])
            await self.browser.act(wanted)
        elif self.manner.ends and self._in_game > self.manner.acts and not shown.get("practice"):
            self.acts.append("EndGameAct")
            await self.browser.press("E")

    async def _talk(self, page: int, panel: dict[str, Any] | None) -> None:
        """Read the texts of the other people, and send the own text once."""
        if panel is None:
            return
        self.seats.add(panel["people"][0]["seat"])
        self.heard.update(each["text"] for each in panel["texts"])
        if panel["read"] is not None:
            await self.browser.act(panel["read"])
        if self._talked != page and self.manner.says and not any(each["own"] for each in panel["texts"]):
            await self.browser.act({**panel["send"], "text": self.manner.says})
        self._talked = page

    def _wanted(self, tree: dict[str, Any]) -> dict[str, Any] | None:
        """Return the act that the person wants; None to wait, or to end the game."""
        if tree["question"]:
            return tree["question"]["buttons"][0]["act"]
        if tree["ending"] and not tree["treasure"] and not tree["dialogue"]:
            return tree["ending"]["buttons"][0]["act"]
        if self._in_game > self.manner.acts:
            return None
        acts = list(_popup_acts(tree))
        if not acts and not tree["dialogue"]:
            acts = [tile["choose"] for tile in tree["tiles"]] + [waiting["show"] for waiting in tree["waiting"]]
        possible = [button["act"] for button in acts if button["enabled"] and not button["pending"]]
        return self._random.choice(possible) if possible else None


def _popup_acts(tree: dict[str, Any]) -> Iterator[dict[str, Any]]:
    """Yield the buttons of the pop-up; none if there is no pop-up, or if it is the robot's turn."""
    if (dialogue := tree["dialogue"]) is not None:
        yield from dialogue["choices"]
        if dialogue["outcome"] or not dialogue["state"]:
            yield dialogue["aside"]
    if (treasure := tree["treasure"]) is None:
        return
    if not treasure["names"]:
        yield treasure["aside"]
    elif any(name["picked"] for name in treasure["names"]):
        yield from (button for button in (treasure["name_it"], treasure["unsure"]) if button)
    else:
        yield from ({"act": name["pick"], "enabled": True, "pending": False} for name in treasure["names"])
        yield from (button for button in (treasure["take"], treasure["leave"]) if button)
