"""Person at a browser: the seat on the server, and every message as the text that is sent."""

import json
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

from tests.support.front_ends.person import Person
from tests.support.front_ends.shown import Offer, Shown
from tests.support.programs.browser_client import applied
from thbridge.app.compose.setting import texts_of
from thbridge.roles.participant.tabui import ParticipantUpdate, TabUI
from thbridge.roles.shared.view import ParticipantRequest, View
from thbridge.study.study_file import Study
from ui.model.playing.screen import Act
from ui.sources.game import ReceivedEvent, ServerReached
from ui.web.page.messages import FROM_GAME_PAGE, decode_act
from ui.web.page.patches import Json, tree
from ui.web.seat import GameSeat, encoded


class DirectConnection:
    """Connection of a seat to a game in the same process; see `SeatConnection`."""

    def __init__(self, report: Callable[[ReceivedEvent], None]) -> None:
        self.requested: tuple[ParticipantRequest, ...] = ()
        self.declined = False
        self.report = report

    async def run(self, stopped: Callable[[], bool], period: float) -> None:
        """Do nothing: the game passes its messages on directly."""


class BrowserPerson(Person):
    """Person at a browser, which paints each page at once.

    Attributes:
        tree: tree of the page.
        received: all messages that the browser has received, as they were sent, each with the number of the game's
            events before it.
        number: number of the page.
    """

    def __init__(self, study: Study, beside: Path = Path()) -> None:
        self.tree: dict[str, Any] = {}
        self.received: list[tuple[int, str]] = []
        self.number = 0
        self.seat = GameSeat(self._connect, texts_of(study, beside), clock=lambda: self.now)
        super().__init__(study, TabUI(self, self), beside)
        self._connection.report(ReceivedEvent(0.0, ServerReached()))
        self.connect()

    def _connect(self, report: Callable[[ReceivedEvent], None]) -> DirectConnection:
        self._connection = DirectConnection(report)
        return self._connection

    def connect(self) -> None:
        """Connect the browser; what it had received before is lost."""
        self.tree = {}
        self.seat.show_to(self._receive)

    def observe(self, level: ParticipantUpdate) -> None:
        """Pass on a message of the game; see `ParticipantObserver`."""
        self._connection.report(ReceivedEvent(self.now, level))
        self.seat.refresh()

    def requests(self, _view: View) -> Sequence[ParticipantRequest]:
        """Return the requests of the seat; see `Player`."""
        return self._connection.requested

    def look(self) -> None:
        """Let the seat send the page."""
        self.seat.refresh()

    def send(self, message: dict[str, Json]) -> None:
        """Send a message to the server."""
        self.seat.receive(FROM_GAME_PAGE.decode(encoded(message)))

    def press(self, act: Act) -> None:
        """Press the button of an act."""
        self.send({"t": "act", "n": self.number, "at": self.now * 1000.0, "act": tree(act), "on_map": False})

    def _receive(self, message: dict[str, Json]) -> None:
        text = encoded(message)
        self.received.append((len(self.game.log.entries), text))
        read = json.loads(text)
        if read["t"] == "page":
            self.tree = applied(self.tree, read["p"])
            self.number = read["n"]
            self.send({"t": "painted", "n": self.number, "at": self.now * 1000.0})

    def shown(self) -> Shown:
        """Read the page."""
        return read_page(self.tree)


def buttons(part: Any) -> Iterator[dict[str, Any]]:
    """Yield all buttons in a part of a page."""
    match part:
        case {"act": _, "label": _}:
            yield part
        case dict():
            for each in part.values():
                yield from buttons(each)
        case list():
            for each in part:
                yield from buttons(each)


def read_page(page: dict[str, Any]) -> Shown:
    """Return what a page shows. It does not show a button that closes a sheet that is closed."""
    shown = Shown()
    for each in buttons({name: part for name, part in page.items() if name != "close_help" or page["help"]}):
        act = decode_act(each["act"])
        assert act is not None
        offer = Offer(each["label"], each["key"], each["hint"], each["enabled"], each["pending"], each["spoken"])
        shown.offers[act] = offer
    shown.put("banner", page["banner"])
    shown.put("top", page["game"], page["progress"])
    shown.put("score", page["score_spoken"])
    shown.put("remark", page["remark"])
    shown.put("queue", page["queue"])
    shown.put("waiting", *(each["text"] for each in page["waiting"]))
    shown.put("history", *(said(each) for each in page["history"]))
    shown.put("cards", *(_card(each) for each in page["cards"]))
    shown.put("tiles", *(_tile(each) for each in page["tiles"]))
    if pop := page["dialogue"]:
        shown.put("dialogue", pop["title"], pop["state"], pop["outcome"], pop["warning"])
        shown.put("sentences", *(said(each) for each in pop["sentences"]))
        shown.put("facts", _facts(pop))
        shown.put("picture", pop["picture"] and "picture")
    if pop := page["treasure"]:
        asked = (f"{fact['asked']} {fact['key']}".strip() for fact in pop["facts"])
        shown.put("treasure", pop["title"], pop["talk"], *asked, pop["asking"])
        shown.put("facts", _facts(pop) or pop["nothing"])
        shown.put("picture", "picture" if pop["picture"] else "" if pop["take"] else pop["unseen"])
        shown.put("verdict", pop["points"], pop["verdict"])
        shown.names = tuple((name["words"], name["picked"]) for name in pop["names"])
    for name in ("question", "ending"):
        if (asked := page[name]) and not (name == "ending" and (page["dialogue"] or page["treasure"])):
            shown.put(name, asked["title"], *asked["lines"])
    if page["help"]:
        shown.put("rules", *page["rules"])
        shown.put("help", *(f"{keys} {effect}" for keys, effect in page["help"]))
    shown.put("enlarged", page["enlarged"] and "picture")
    return shown


def _facts(pop: dict[str, Any]) -> str:
    return " ".join(fact["words"] for fact in pop["facts"] if fact["words"])


def said(sentence: dict[str, Any]) -> str:
    """Return a sentence with its speaker."""
    return f"{sentence['who']}: {sentence['text']}" if sentence["who"] else str(sentence["text"])


def _card(card: dict[str, Any]) -> str:
    """Return the words of a card in the order in which the window paints them, in all versions."""
    beside = card["state"] if card["warning"] else card["place"]
    state = card["warning"] or card["state"]
    rest = card["name"], card["select"]["key"], str(card["waits"] or ""), card["commander"], state
    return "\n".join(_joined(str(card["number"]), energy, *rest, beside and f"· {beside}") for energy in card["energy"])


def _tile(tile: dict[str, Any]) -> str:
    """Return the words of a tile in the order in which the window paints them, in all versions."""
    robot = "" if tile["robot"] is None else str(tile["robot"] + 1)
    number = tile["choose"]["key"] or str(tile["room"])
    return "\n".join(_joined(number, robot, tile["name"], words) for words in tile["words"])


def _joined(*words: str) -> str:
    return " ".join(filter(None, words))
