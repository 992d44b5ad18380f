"""Somebody who plays in the participant's window: sees it as a screen reader does, and uses mouse or keys."""

import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from tests.support.programs.processes import Program
from tests.support.windows.desktop import PATIENCE, Desktop, Seen

TREASURES = {
    ("Orange", "Round and Large"): "Orange Bottle",
    ("Blue", "Round and Large"): "Blue Bottle",
    ("Yellow", "Square and Small"): "Yellow can",
    ("Pink", "Square and Small"): "Pink can",
    ("Green", "Round and Small"): "Green can",
}
"""What the treasures of original-2016, and one of the practice game's, look like."""


@dataclass(frozen=True)
class Sight:
    """The participant's window at one glance."""

    things: tuple[Seen, ...]

    def named(self, start: str, *, role: str | None = None) -> Seen | None:
        """The first thing whose name begins so."""
        return next((one for one in self.things if one.name.startswith(start) and role in (None, one.role)), None)

    @property
    def pop(self) -> Seen | None:
        """What lies in front of all else: a robot's question, a treasure, the end, a question of the program."""
        panels = [one for one in self.things if one.role == "panel" and one.name]
        return panels[-1] if panels else None

    @property
    def buttons(self) -> list[Seen]:
        """What can be pressed in the pop-up; all that can be pressed where there is none."""
        pressed = [one for one in self.things if one.role == "push button"]
        return pressed if self.pop is None else [one for one in pressed if within(one, self.pop)]

    def button(self, start: str) -> Seen | None:
        """The button of the pop-up whose name begins so, if it can be pressed."""
        fitting = (one for one in self.buttons if one.name.startswith(start))
        return next((one for one in fitting if "not possible at the moment" not in one.name), None)

    @property
    def answers(self) -> list[Seen]:
        """What may be answered to the robot that talks."""
        if self.named("What was said") is None:
            return []
        others = ("Later", "Close", "Picture of what was found")
        return [one for one in self.buttons if one.name not in others and "asked for" not in one.name]

    @property
    def names(self) -> list[Seen]:
        """What a treasure may be."""
        return [one for one in self.things if one.role == "list item"]

    @property
    def picked(self) -> str | None:
        """What the participant takes it for so far."""
        picked = self.named("What it may be", role="list")
        found = re.fullmatch(r"Picked: (.*)", picked.description if picked is not None else "")
        return found[1] if found else None

    @property
    def treasure(self) -> str | None:
        """The name of what the pop-up tells of."""
        facts = self.named("Colour: ")
        found = re.match(r"Colour: (.+)\. Footprint: (.+)\.", facts.name if facts is not None else "")
        return TREASURES[found[1], found[2]] if found else None

    @property
    def over(self) -> bool:
        """Whether the game is."""
        return self.named("Play again", role="push button") is not None

    @property
    def score(self) -> int:
        """The score that shows."""
        found = (re.fullmatch(r"Score ([-−]?\d+)", one.name) for one in self.things)
        return int(next(score for score in found if score is not None)[1].replace("−", "-"))

    @property
    def robots(self) -> list[Seen]:
        """The robots' cards."""
        return [one for one in self.things if re.match(r"Robot \d+, .*energy", one.name)]

    def robot(self, number: int) -> str:
        """What is said of a robot."""
        return next((one.name for one in self.robots if one.name.startswith(f"Robot {number},")), "")

    def energy(self, number: int) -> float:
        """What a robot has left."""
        found = re.search(r"energy ([\d.]+) of", self.robot(number))
        assert found is not None, self.robot(number)
        return float(found[1])

    @property
    def rooms(self) -> dict[int, Seen]:
        """The rooms' buttons."""
        found = {one: re.match(r"Room (\d+), ", one.name) for one in self.things if one.role == "push button"}
        return {int(number[1]): one for one, number in found.items() if number is not None}

    @property
    def waiting(self) -> list[Seen]:
        """What waits for the participant beside the pop-up."""
        strip = self.named("What waits for you")
        pressed = [one for one in self.things if one.role == "push button"]
        return [] if strip is None else [one for one in pressed if within(one, strip)]

    @property
    def visited(self) -> list[int]:
        """Rooms where a robot has been."""
        return [number for number, room in self.rooms.items() if ", visited" in room.name]

    @property
    def free(self) -> list[int]:
        """Rooms where the selected robot can go."""
        return [number for number, room in self.rooms.items() if "keeps" in room.description]


class Player:
    """Somebody at the window.

    Args:
        screen: where the window is.
    """

    def __init__(self, screen: Desktop) -> None:
        self.screen = screen

    def look(self) -> Sight:
        """What shows just now."""
        return Sight(tuple(self.screen.look()))

    def until(self, what: str, condition: Callable[[Sight], object], seconds: float = PATIENCE) -> Sight:
        """Wait until it shows; what was seen then."""
        seen = Sight(())

        def met() -> bool:
            nonlocal seen
            seen = self.look()
            return bool(condition(seen))

        self.screen.wait(what, met, seconds)
        return seen

    def insist(self, what: str, deed: Callable[[], object], condition: Callable[[Sight], object]) -> Sight:
        """Do something, and again if nothing comes of it, as people do where a pop-up was too new to be read."""

        def met() -> bool:
            deed()
            try:
                self.until(what, condition, 2.0)
            except TimeoutError:
                return False
            return True

        self.screen.wait(what, met, PATIENCE)
        return self.look()

    def rest(self) -> None:
        """Take the hand off the mouse: the pointer goes to where nothing is."""
        size = self.screen.do("getdisplaygeometry").split()
        self.screen.do("mousemove", str(int(size[0]) - 1), str(int(size[1]) - 1))


def within(one: Seen, other: Seen) -> bool:
    """Whether the middle of one thing lies in another."""
    x, y = one.middle
    return other.x <= x <= other.x + other.width and other.y <= y <= other.y + other.height


class Mouse(Player):
    """Plays by clicks alone.

    Args:
        screen: where the window is.
        place: where on the map a room is, as shares of its breadth and height.
    """

    def __init__(self, screen: Desktop, place: Callable[[int, Seen], tuple[float, float]]) -> None:
        super().__init__(screen)
        self._place = place
        self.on_map: list[int] = []
        """Rooms that were clicked on the map."""
        self.by_button: list[int] = []
        """Rooms that were chosen by their buttons."""

    def step(self, sight: Sight) -> None:
        """What comes next."""
        chosen = self.thing_to_press(sight)
        if chosen is not None:
            self.screen.click(chosen)
        elif sight.pop is None:
            self.send(sight)

    def thing_to_press(self, sight: Sight) -> Seen | None:
        """What to click in the pop-up."""
        if sight.answers:
            return sight.answers[0]
        for name in ("Close", "Take a picture"):
            if (button := sight.button(name)) is not None and sight.named("What was said") is None:
                return button
        if sight.names and sight.picked is None:
            # A look takes a moment, and may catch a pop-up half filled: the next one sees all of it.
            return next((name for name in sight.names if name.name.split(" · ")[0] == sight.treasure), None)
        return sight.button("Name it") or sight.button("Leave it")

    def send(self, sight: Sight) -> None:
        """Send the selected robot if it can be sent, or else select the other."""
        selected = next(card for card in sight.robots if ", selected" in card.name)
        if sight.waiting:
            self.screen.click(sight.waiting[0])
        elif ", ready" in selected.name and sight.free:
            room = min(sight.free, key=lambda number: sight.rooms[number].name.split("costs ")[1])
            if len(self.on_map) <= len(self.by_button):
                self.on_map.append(room)
                house = sight.named("Map")
                assert house is not None
                self.screen.click(self._place(room, house))
            else:
                self.by_button.append(room)
                self.screen.click(sight.rooms[room])
        else:
            others = [card for card in sight.robots if card != selected and ", ready" in card.name]
            if others:
                self.select(others[0], sight)

    def select(self, card: Seen, sight: Sight) -> None:
        """Click on a robot's card, or scroll towards it where it is out of sight."""
        above, below = sight.named("Score and tools"), sight.named("Rooms")
        assert above is not None
        assert below is not None
        if above.y + above.height <= card.middle[1] < below.y:
            self.screen.click(card)
        else:
            self.screen.turn_wheel(below.middle[0], below.y - 20.0, down=card.middle[1] >= below.y)


class Keys(Player):
    """Plays by keys alone."""

    def step(self, sight: Sight) -> None:
        """What comes next."""
        key = self.key(sight)
        if key is not None:
            self.screen.press(key)

    def key(self, sight: Sight) -> str | None:
        """The key to press."""
        if sight.answers:
            return "Return"
        if sight.button("Close") is not None:
            return "Escape"
        if sight.button("Take a picture") is not None:
            return "ctrl+p"
        if sight.names and sight.picked != sight.treasure:
            return "Down"
        if sight.button("Name it") is not None:
            return "Return"
        if sight.button("Leave it") is not None:
            return "ctrl+l"
        if sight.pop is not None:
            return None
        if sight.waiting:
            return "w"
        selected = next(card for card in sight.robots if ", selected" in card.name)
        if ", ready" in selected.name and sight.free:
            return str(sight.free[-1])
        return "Tab" if any(", ready" in card.name for card in sight.robots if card != selected) else None


def on(screen: Desktop, folder: Path, *arguments: str) -> Program:
    """A program whose windows open there."""
    return Program(folder, *arguments, environment=screen.environment)


STUDY = """\
map: arena8
templates: original-2016
robots: 2
seed: 3
server:
  port: 0
game:
  energy: 45
participant:
  robots: [1, 4]
"""
"""With so much energy a robot gets to two rooms or three."""
