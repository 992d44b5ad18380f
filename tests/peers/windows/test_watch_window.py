"""The researcher's window on a real screen: a session watched, meddled with and spoken for, a bag looked through."""

import json
import re
import subprocess
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
from PIL import Image

from tests.support.hunts.recorded_hunts import record_beginning
from tests.support.programs.ports import free_port
from tests.support.programs.processes import THBRIDGE
from tests.support.windows.desktop import PATIENCE, Desktop, Seen, desktop, needs_desktop
from thbridge.recording.bag.reading.reader import messages
from thbridge.ros import names
from thbridge.ros.messages import unpack

pytestmark = needs_desktop

STUDY = "map: arena8\ntemplates: original-2016\nrobots: 2\nseed: 5\nserver:\n  port: 0\n"
BESIDE = 1250
"""Pixels from the left at which the researcher's window stands."""
WALL = (0x3A, 0x43, 0x52)
"""Color of walls in light windows."""
WORDS = "Shall we begin with room 2?"


class Watch:
    """`thbridge watch` as a screen reader sees it."""

    def __init__(self, screen: Desktop, program: subprocess.Popen[bytes], what: str) -> None:
        self.screen = screen
        self.program = program
        self.handle = screen.focus_window(what, PATIENCE)
        self._title = f"{what} - thbridge watch"

    @property
    def things(self) -> list[Seen]:
        """All that shows in it."""
        return [one for one in self.screen.look() if one.window == self._title]

    def named(self, start: str, role: str | None = None) -> Seen:
        """Wait for something whose name begins so."""
        found: list[Seen] = []

        def there() -> bool:
            found[:] = [one for one in self.things if one.name.startswith(start) and role in (None, one.role)]
            return bool(found)

        self.screen.wait(start, there, PATIENCE)
        return found[0]

    def click(self, start: str, role: str) -> None:
        """Click on something, once it has come to rest."""
        before = self.named(start, role)
        while (now := self.named(start, role)) != before:
            before = now
        self.screen.click(now)

    def press(self, key: str) -> None:
        """A key, in this window."""
        self.screen.do("windowfocus", "--sync", self.handle)
        self.screen.press(key)

    def place(self, x: float, y: float) -> tuple[float, float]:
        """Where a place of arena8 is on the screen: its outer walls reach from (-5, -5) to (11, 7)."""
        seen, pixels = self.named("Map", "filler"), self.map_pixels()
        rows, columns = np.nonzero((np.abs(pixels.astype(int) - WALL) < 2).all(axis=-1))
        left, right, top, bottom = columns.min(), columns.max(), rows.min(), rows.max()
        return (
            seen.x + left + (x + 5.0) / 16.0 * float(right - left),
            seen.y + top + (7.0 - y) / 12.0 * float(bottom - top),
        )

    def map_pixels(self) -> npt.NDArray[np.uint8]:
        """The map as it is drawn: (rows, columns, 3) red, green, blue."""
        seen = self.named("Map", "filler")
        with tempfile.TemporaryDirectory() as folder:
            self.screen.picture(Path(folder) / "now.png")
            with Image.open(Path(folder) / "now.png") as picture:
                pixels = np.asarray(picture.convert("RGB"))
        return pixels[seen.y : seen.y + seen.height, seen.x : seen.x + seen.width]

    def wait_for_time(self, shown: str) -> None:
        """Wait until this moment of a recording is shown."""
        self.screen.wait(shown, lambda: self.named("Time shown", "text").text == shown, PATIENCE)

    def drag(self, tool: str, *places: tuple[float, float]) -> None:
        """A stroke on the map with a tool."""
        self.press(tool)
        self.screen.wait(
            "the tool", lambda: any(one.checked and one.name.endswith(f"({tool.upper()})") for one in self.things)
        )
        self.screen.drag(*(self.place(*place) for place in places))


@pytest.fixture
def screen(tmp_path: Path, request: pytest.FixtureRequest) -> Iterator[Desktop]:
    """As wide as is asked for, else as one window needs."""
    with desktop(getattr(request, "param", 1400), 960) as opened:
        try:
            yield opened
        finally:
            opened.picture(tmp_path / "screen.png")


@contextmanager
def started(screen: Desktop, folder: Path, *arguments: str) -> Iterator[subprocess.Popen[bytes]]:
    """A program of ours on this screen, until the block ends."""
    command = [*THBRIDGE, *arguments]
    with (folder / f"{arguments[0]}.txt").open("wb") as told:
        program = subprocess.Popen(command, cwd=folder, env=screen.environment, stdout=told, stderr=told)
    try:
        yield program
    finally:
        program.terminate()
        try:
            program.wait(30)
        except subprocess.TimeoutExpired:
            program.kill()
            program.wait()


def asked(bag: Path) -> list[tuple[str, dict]]:
    """What the researcher's window asked for, as it was recorded."""
    inputs = (unpack.outside_input(each.data) for each in messages(bag, [names.INPUTS]))
    lines = (given.line.partition(" ") for given in inputs if given.sender == "watch")
    return [(kind, json.loads(fields)) for kind, _, fields in lines]


@pytest.mark.slow
@pytest.mark.parametrize("screen", [2760], indirect=True)
def test_what_a_researcher_does_to_a_session_is_in_its_record(screen: Desktop, tmp_path: Path) -> None:
    (tmp_path / "study.yaml").write_text(STUDY)
    door = f"127.0.0.1:{free_port()}"
    play = ("play", "study.yaml", "--watch", door, "--bag", "hunt.bag", "--no-report")
    with started(screen, tmp_path, *play), started(screen, tmp_path, "watch", door, "--look", "light") as program:
        # It may come before there is anything to watch.
        watch = Watch(screen, program, door)
        screen.do("windowmove", watch.handle, str(BESIDE), "0")
        watch.named("No answer from", "label")
        game = screen.focus_window("Treasure hunt", PATIENCE)
        screen.found("Start with 2 robots", seconds=PATIENCE)
        screen.press("Return")
        watch.named("live", "label")
        watch.named("robot 2", "table cell")
        screen.wait("the map to be beside", lambda: watch.named("Map", "filler").x > BESIDE)

        watch.drag("k", (1.5, 2.45), (2.5, 3.0), (3.1, 4.9))
        watch.named("Moving robot 2 there", "status bar")
        screen.wait("its error", lambda: any(re.fullmatch(r"[2-4]\.[0-9]{3}", one.name) for one in watch.things))
        watch.drag("g", (4.5, 0.0), (4.8, 0.0), (5.2, 0.0))
        watch.named("Sending robot 2 there", "status bar")
        watch.drag("o", (7.0, -2.0), (7.2, -2.0), (7.3, -2.0))
        watch.named("Requested. An obstacle", "status bar")

        watch.press("Delete")
        screen.click(screen.rested("Kill it", "push button"))
        watch.named("robot 2\n! software stopped", "table cell")
        watch.press("r")
        screen.wait("robot 2 to live", lambda: not any("! software" in one.name for one in watch.things), PATIENCE)

        watch.click("Wizard", "page tab")
        watch.click("Speak for robot 1", "check box")
        watch.named("You now speak for robot 1", "status bar")
        screen.do("windowfocus", "--sync", game)
        screen.press("d")
        screen.found("Robot 1 is thinking", seconds=PATIENCE)
        watch.click("Room 2 (", "push button")
        watch.click("Your own words for robot 1", "text")
        screen.do("windowfocus", "--sync", watch.handle, "type", "--delay", "10", WORDS)
        screen.press("Return")
        screen.found(f"Robot 1: {WORDS}", seconds=PATIENCE)
        # Nobody is kept waiting by a window that was closed.
        screen.do("windowfocus", "--sync", game)
        screen.press("c")
        watch.named("Robot 1 waits to speak about room 2", "label")
        screen.found("Robot 1 is thinking", seconds=PATIENCE)
        screen.ask_to_close(watch.handle)
        screen.wait("robot 1 to speak", lambda: screen.find("Robot 1 is thinking") is None, PATIENCE)
        assert program.wait(PATIENCE) == 0
    requests = asked(tmp_path / "hunt.bag")
    kinds = ["Carry", "SimpleGoal", "PutThing", "Die", "Revive", "Puppeteer", "AdviseFor", "SpeakFor", "Puppeteer"]
    assert [kind for kind, _ in requests] == kinds
    told = dict(requests[:-1])
    assert (told["Puppeteer"]["on"], requests[-1][1]["on"]) == (True, False)
    place = told["Carry"]["base_in_map"]
    assert told["Carry"]["robot"] == 1
    assert (place["x"], place["y"]) == pytest.approx((3.1, 4.9), abs=0.15)
    assert told["SimpleGoal"]["base_in_map"]["theta"] == pytest.approx(0.0, abs=0.1)
    assert (told["Die"]["robot"], told["AdviseFor"]["room"], told["SpeakFor"]["text"]) == (1, 2, WORDS)
    said = [unpack.utterance(each.data) for each in messages(tmp_path / "hunt.bag", [names.UTTERANCES])]
    assert [each.text for each in said if each.author == "wizard"] == [WORDS]
    again = subprocess.run([*THBRIDGE, "replay", "hunt.bag"], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert again.returncode == 0, again.stdout + again.stderr


@pytest.mark.slow
def test_a_recording_is_looked_through_by_mouse_and_keys(screen: Desktop, tmp_path: Path) -> None:
    record_beginning(tmp_path / "hunt.bag", robots=2, seconds=8.0)
    with started(screen, tmp_path, "watch", "hunt.bag", "--look", "light") as program:
        watch = Watch(screen, program, "hunt.bag")
        watch.named("recording", "label")
        watch.click("Time", "slider")
        watch.wait_for_time("0:04.00")
        before = costs_drawn(watch)
        watch.press("5")
        screen.wait("the switch", lambda: watch.named("Global costmap", "check box").checked)
        screen.wait("its costs", lambda: costs_drawn(watch) > before + 4000)
        watch.press("Home")
        watch.wait_for_time("0:00.00")
        watch.press("period")
        watch.wait_for_time("0:00.02")
        assert not watch.named("Kidnap (K)").enabled
        screen.ask_to_close(watch.handle)
        assert program.wait(PATIENCE) == 0


def costs_drawn(watch: Watch) -> int:
    """Pixels of the map in the color in which rviz draws costs next to walls."""
    red, green, blue = np.moveaxis(watch.map_pixels(), 2, 0)
    return int(((red < 120) & (green > 220) & (blue > 220)).sum())
