"""Whole hunts in the real window, with the real programs: by mouse alone, and by keyboard alone."""

import os
import re
import shutil
import signal
import subprocess
from collections.abc import Callable, Iterator
from itertools import takewhile
from pathlib import Path

import pytest

from tests.peers.window_player import STUDY, Keys, Mouse, Player, Sight, on
from tests.support.programs.processes import THBRIDGE
from tests.support.windows.desktop import Desktop, Seen, desktop, needs_desktop
from thbridge.analysis.report.builder import read_report
from thbridge.analysis.report.report import TimelineEntry
from thbridge.files.resources import shipped
from thbridge.recording.bag.reading.reader import messages

pytestmark = needs_desktop


def place_in_arena(room: int, house: Seen) -> tuple[float, float]:
    """Where a room of arena8 is on the screen: the map shows all of the house, with a margin of 30 pixels."""
    at_goal = {1: (-2.7, 4.7), 2: (-2.7, 1.4), 3: (-2.9, -3.0), 4: (3.1, 4.9), 5: (2.6, -2.8), 6: (8.7, 5.4)}
    x, y = (at_goal | {7: (9.0, 1.5), 8: (9.1, -2.5)})[room]
    scale = min((house.width - 60) / 16.0, (house.height - 60) / 12.0)
    middle = house.middle
    return middle[0] + (x - 3.0) * scale, middle[1] - (y - 1.0) * scale


@pytest.fixture
def played(screen: Desktop, tmp_path: Path) -> Iterator[subprocess.Popen[bytes]]:
    """`thbridge play` on the desktop."""
    (tmp_path / "study.yaml").write_text(STUDY)
    program = subprocess.Popen(
        [*THBRIDGE, "play", "study.yaml", "--rate", "6", "--bag", "hunt.bag", "--look", "dark"],
        cwd=tmp_path,
        env=screen.environment,
        stdout=(tmp_path / "told.txt").open("wb"),
        stderr=subprocess.STDOUT,
    )
    try:
        yield program
    finally:
        screen.picture(tmp_path / "screen.png")
        program.terminate()
        try:
            program.wait(20)
        except subprocess.TimeoutExpired:
            program.kill()
            program.wait()


def play(player: Player, step: Callable[[Sight], None]) -> Sight:
    """Play until the game is over."""
    player.until("the game", lambda seen: seen.rooms)

    def over() -> bool:
        seen = player.look()
        if not seen.over:
            step(seen)
        return seen.over

    player.screen.wait("the end of the game", over, 240.0)
    # The look that found the end may have begun before it; the next sees all of it.
    return player.look()


def first_game(program: subprocess.Popen[bytes], folder: Path) -> list[TimelineEntry]:
    """What the recording tells of the first game, once the program has closed it."""
    assert program.wait(60) == 0, (folder / "told.txt").read_text()
    moments = read_report(messages(folder / "hunt.bag")).timeline
    return list(takewhile(lambda moment: moment.kind != "ended", moments))


@pytest.mark.slow
def test_a_whole_hunt_by_mouse(played: subprocess.Popen[bytes], screen: Desktop, tmp_path: Path) -> None:
    player = Mouse(screen, place_in_arena)
    screen.focus_window("Treasure hunt")
    screen.click(screen.rested("1 robot"))
    screen.found("Start with 1 robot")
    screen.click(screen.rested("2 robots"))
    screen.found("Start with 2 robots")
    screen.click(screen.rested("Start with 2 robots"))
    seen = play(player, player.step)
    assert player.on_map
    assert player.by_button
    assert seen.score > 0
    score, visited = seen.score, set(seen.visited)
    player.insist(
        "another game",
        lambda: screen.click(screen.found("Play again")),
        lambda seen: seen.named("Game 2") and not seen.over,
    )
    back = player.look()
    assert back.score == 0
    assert not back.visited
    screen.leave_game()
    first = first_game(played, tmp_path)
    assert sum(moment.points or 0 for moment in first) == score
    assert {moment.room for moment in first if moment.kind == "arrived"} == visited
    assert {moment.room for moment in first if moment.kind == "pictured"} == visited


@pytest.mark.slow
def test_a_practice_game_and_a_whole_hunt_by_keyboard_alone(
    played: subprocess.Popen[bytes], screen: Desktop, tmp_path: Path
) -> None:
    player = Keys(screen)
    player.rest()
    screen.focus_window("Treasure hunt")
    screen.found("Start with 2 robots")
    screen.press("t")
    practice = play(player, player.step)
    assert practice.visited
    screen.press("F10")
    screen.found("Start with 2 robots")
    screen.press("3")
    screen.found("Start with 3 robots")
    screen.press("2", "Return")
    player.until("the game", lambda seen: len(seen.robots) == 2)
    screen.press("F1")
    screen.found("Rules and keys", "panel")
    screen.press("Escape")
    player.until("the sheet to close", lambda seen: seen.pop is None)
    asides: list[str] = []

    def step(seen: Sight) -> None:
        """Put the first treasure aside and show it again, before anything is done about it."""
        if seen.button("Take a picture") is not None and not asides:
            screen.press("Escape")
            asides.extend(one.name for one in player.until("what waits", lambda seen: seen.waiting).waiting)
            # Esc puts aside what another robot has come with meanwhile, and shows what waits once nothing is in front.
            player.insist("it again", lambda: screen.press("Escape"), lambda seen: seen.button("Take a picture"))
        else:
            player.step(seen)

    over = play(player, step)
    assert any("found something" in words for words in asides)
    player.insist("another game", lambda: screen.press("a"), lambda seen: seen.named("Game 2") and not seen.over)
    screen.press("e")
    player.insist("the end of it", lambda: screen.press("y"), lambda seen: seen.over)
    screen.press("F10")
    screen.found("Start with 2 robots")
    screen.press("ctrl+q")
    first = first_game(played, tmp_path)
    assert sum(moment.points or 0 for moment in first) == over.score
    assert {moment.room for moment in first if moment.kind == "arrived"} == set(over.visited)


@pytest.mark.slow
def test_six_robots_arrive_while_somebody_is_asked(screen: Desktop, tmp_path: Path) -> None:
    (tmp_path / "study.yaml").write_text(STUDY.replace("robots: 2", "robots: 6", 1).replace("[1, 4]", "null"))
    program = on(screen, tmp_path, "play", "study.yaml", "--rate", "4", "--bag", "hunt.bag")
    player = Mouse(screen, place_in_arena)
    queued = 0
    try:
        screen.focus_window("Treasure hunt")
        screen.click(screen.rested("Start with 6 robots"))

        def step(seen: Sight) -> None:
            """Send everybody first, and only then look at what was found."""
            nonlocal queued
            queued = max(queued, len(seen.waiting))
            home = [card for card in seen.robots if ", ready, in the corridor" in card.name]
            later = seen.button("Later")
            if not home or seen.answers:
                player.step(seen)
            elif later is not None:
                screen.click(later)
            elif ", selected" not in home[0].name:
                player.select(home[0], seen)
            elif seen.free:
                screen.click(seen.rooms[seen.free[0]])

        over = play(player, step)
        assert queued > 1
        assert len(over.robots) == 6
        assert len(over.visited) >= 6
    finally:
        screen.picture(tmp_path / "screen.png")
        program.close()


FINDS = """\
properties:
  - {name: colour, values: [grey, brown], sensor: camera, drawn: colour}
  - {name: temperature, values: [cold, warm], sensor: thermometer, cost: 3, said: "£temperature£ to the touch"}
  - {name: age, values: [old, new], told_by: person}
treasures:
  - {name: oil lamp, points: 30, image: toy_block.jpg, values: {colour: brown, temperature: warm, age: old}}
  - {name: clay pot, points: 20, image: milk_jug.jpg, values: {colour: brown, temperature: cold, age: new}}
"""
"""Properties that no part of the program has heard of."""
KNOWN_BY = {"warm": ("oil lamp", "old"), "cold": ("clay pot", "new")}


@pytest.mark.slow
def test_a_whole_hunt_on_a_small_screen_with_properties_that_only_its_set_declares(tmp_path: Path) -> None:
    pictures = shipped().root / "templates" / "four-properties" / "pictures"
    shutil.copytree(pictures, tmp_path / "finds" / "pictures")
    (tmp_path / "finds" / "treasures.yaml").write_text(FINDS)
    (tmp_path / "finds" / "DialogueText").write_text(
        "Finds\nSpecificRoom:\nTakePicture:\nTakeTreasure:\nIs it £temperature£ and £age£?\n"
    )
    (tmp_path / "study.yaml").write_text(STUDY.replace("original-2016", "./finds").replace("45", "70"))
    with desktop(1024, 600) as screen:
        program = on(screen, tmp_path, "play", "study.yaml", "--rate", "6", "--bag", "hunt.bag")
        player = Mouse(screen, place_in_arena)

        def step(seen: Sight) -> None:
            """Sense the temperature, take the picture, tell the age, and only then name it."""
            facts = seen.named("Colour: brown")
            found = re.search(r"Temperature: (\w+)", facts.name if facts is not None else "")
            name, age = KNOWN_BY[found[1]] if found is not None else ("", "")
            told = facts is not None and "Age: " in facts.name
            button = seen.button("Sense the temperature") or seen.button("Take a picture")
            if button is None and name and not told:
                button = seen.button(age)
            if button is not None and not seen.answers:
                screen.click(button)
            elif name and told and seen.names and seen.picked is None and not seen.answers:
                screen.click(next(one for one in seen.names if one.name.casefold().startswith(name)))
            else:
                player.step(seen)

        try:
            screen.focus_window("Treasure hunt")
            screen.click(screen.rested("Start with 2 robots"))
            over = play(player, step)
            screen.press("ctrl+q")
            moments = first_game(program.process, tmp_path)
        finally:
            screen.picture(tmp_path / "screen.png")
            program.close()
    visited = set(over.visited)
    assert len(visited) > 2
    # The last one may be found with no energy left for a picture.
    pictured = {moment.room for moment in moments if moment.kind == "pictured"}
    assert len(visited - pictured) < 3
    for kind in ("measured", "told"):
        assert {moment.room for moment in moments if moment.kind == kind} >= pictured, kind
    assert over.score == sum(moment.points or 0 for moment in moments) > 0


@pytest.mark.slow
def test_a_window_of_play_that_crashes_is_opened_again_at_its_game(screen: Desktop, tmp_path: Path) -> None:
    (tmp_path / "study.yaml").write_text(STUDY)
    program = on(screen, tmp_path, "play", "study.yaml", "--bag", "hunt.bag")
    player = Keys(screen)
    try:
        screen.focus_window("Treasure hunt")
        player.insist("the game", lambda: screen.press("Return"), lambda seen: seen.rooms)
        screen.focus_window("Treasure hunt")
        player.insist("robot 1 to be asked", lambda: screen.press("4"), lambda seen: seen.answers)
        children = subprocess.run(
            ["pgrep", "-P", str(program.process.pid), "-f", "hosted"], capture_output=True, text=True, check=True
        )
        os.kill(int(children.stdout.split()[0]), signal.SIGKILL)
        screen.wait("it to be told", lambda: "crashed" in program.text)
        player.until("the same talk", lambda seen: seen.answers)
    finally:
        program.close()
