"""The real window while programs of the game die and come back, and while it is closed or dies itself."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.peers.window_player import Player, Sight, on
from tests.support.programs.processes import Program, port_of
from tests.support.windows.desktop import Desktop, desktop, needs_desktop

pytestmark = [needs_desktop, pytest.mark.slow]

STUDY = """\
map: arena8
templates: original-2016
robots: 2
seed: 3
game:
  energy: 1000
"""
"""Nobody runs out of energy: one game is enough for all tests."""


@pytest.fixture(scope="module")
def screen() -> Iterator[Desktop]:
    with desktop() as opened:
        yield opened


@pytest.fixture(scope="module")
def hunt(tmp_path_factory: pytest.TempPathFactory) -> Iterator[dict[str, Program]]:
    """Server, SimR and Hider; robots are slow enough to be stopped under way, by a player on a busy machine, too."""
    folder = tmp_path_factory.mktemp("hunt")
    (folder / "study.yaml").write_text(STUDY)
    running = {"server": Program(folder, "server", "study.yaml", "--port", "0")}
    try:
        port = port_of(running["server"], [running["server"]])
        at = f"127.0.0.1:{port}"
        # Started again, the server must be found where it was.
        running["server"].arguments = ("server", "study.yaml", "--port", str(port))
        running["simr"] = Program(folder, "simr", "--study", "study.yaml", "--server", at, "--rate", "0.5")
        running["hider"] = Program(folder, "hider", "--server", at, "--treasures", "original-2016")
        yield running
    finally:
        for program in running.values():
            program.close()


@pytest.fixture
def window(hunt: dict[str, Program], screen: Desktop, tmp_path: Path) -> Iterator[Program]:
    """The participant's window at that hunt."""
    at = hunt["simr"].arguments[hunt["simr"].arguments.index("--server") + 1]
    program = on(screen, tmp_path, "tabui", "--server", at)
    try:
        screen.focus_window("Treasure hunt")
        yield program
    finally:
        screen.picture(tmp_path / "screen.png")
        program.close()


def sent(player: Player, *, far: bool = False) -> tuple[int, float]:
    """Send robot 1 to the first room where it can go, or the farthest, and agree to all it says; room and cost."""
    seen = player.until("the game", lambda seen: seen.free)
    costs = {room: float(seen.rooms[room].name.split("costs ")[1].split(",")[0]) for room in seen.free}
    room = max(costs, key=costs.__getitem__) if far else seen.free[0]
    asked(player, room)
    agreed(player)
    return room, costs[room]


def asked(player: Player, room: int) -> Sight:
    """Choose a room, again if the window has only just come and takes no click yet; what the robot says to it."""

    def choose() -> None:
        seen = player.look()
        if not seen.answers:
            player.screen.click(seen.rooms[room])

    return player.insist("the robot to answer", choose, lambda seen: seen.answers)


def agreed(player: Player) -> None:
    """Agree to all that a robot says until it is under way."""

    def under_way() -> bool:
        seen = player.look()
        if seen.answers:
            player.screen.click(seen.answers[0])
        return "Stop robot 1" in [one.name for one in seen.things]

    player.screen.wait("robot 1 to be under way", under_way)


def decided(player: Player, room: int) -> None:
    """Wait for the robot to arrive, and leave what is there."""
    player.until("the treasure", lambda seen: seen.treasure and seen.pop and seen.pop.name.endswith(f"room {room}"))
    player.insist(
        "the treasure to be left",
        lambda: [player.screen.click(button) for button in player.look().buttons if button.name == "Leave it"],
        lambda seen: seen.pop is None,
    )
    assert room in player.look().visited


def troubled(seen: Sight) -> bool:
    lost = ("connection to the game", "robots are not connected")
    return any(words in one.name for one in seen.things for words in lost)


def test_a_server_killed_in_the_middle_comes_back_to_the_same_game(
    hunt: dict[str, Program], screen: Desktop, window: Program
) -> None:
    player = Player(screen)
    room, _ = sent(player)
    before = player.look()
    hunt["server"].kill()
    seen = player.until("the loss to be told", troubled)
    hunt["server"] = hunt["server"].again()
    assert seen.rooms.keys() == before.rooms.keys()
    assert seen.energy(1) == before.energy(1)
    player.until("the game to be back", lambda seen: not troubled(seen))
    decided(player, room)
    assert player.look().energy(1) == before.energy(1)


def test_robots_and_treasures_may_go_and_come_back(hunt: dict[str, Program], screen: Desktop, window: Program) -> None:
    player = Player(screen)
    room, _ = sent(player)
    for name in ("simr", "hider"):
        hunt[name].kill()
    player.until("it to be told", lambda seen: seen.named("There is no news from the robots"))
    for name in ("simr", "hider"):
        hunt[name] = hunt[name].again()
    player.until("news of them", lambda seen: not seen.named("There is no news from the robots"))
    decided(player, room)


def test_a_window_that_dies_in_a_talk_finds_the_same_talk_again(
    hunt: dict[str, Program], screen: Desktop, window: Program
) -> None:
    player = Player(screen)
    seen = player.until("the game", lambda seen: seen.free)
    room = seen.free[0]
    asked(player, room)
    before = player.until("the talk", lambda seen: len(seen.answers) > 1)
    window.kill()
    again = window.again()
    try:
        screen.focus_window("Treasure hunt")
        after = player.until("the talk again", lambda seen: len(seen.answers) > 1)
        assert after.pop is not None
        assert before.pop is not None
        assert after.pop.name == before.pop.name
        assert [one.name for one in after.answers] == [one.name for one in before.answers]
        assert (after.score, after.visited) == (before.score, before.visited)
        assert [after.energy(1), after.energy(2)] == [before.energy(1), before.energy(2)]
        agreed(player)
        decided(player, room)
    finally:
        again.close()


def test_a_window_closed_in_the_middle_says_that_one_can_come_back(
    hunt: dict[str, Program], screen: Desktop, window: Program
) -> None:
    player = Player(screen)
    room, _ = sent(player)
    screen.leave_game()
    assert window.process.wait(30) == 0
    again = window.again()
    try:
        screen.focus_window("Treasure hunt")
        seen = player.until("the game", lambda seen: seen.rooms)
        assert ", reserved" in seen.rooms[room].name or "robot 1" in seen.rooms[room].name
        decided(player, room)
    finally:
        again.close()


def test_stopping_gives_energy_back_and_another_goal_costs_its_own(
    hunt: dict[str, Program], screen: Desktop, window: Program
) -> None:
    player = Player(screen)
    whole = player.until("the game", lambda seen: seen.free).energy(1)
    room, cost = sent(player, far=True)
    under_way = player.look()
    assert under_way.energy(1) == whole - cost
    player.until("it to leave the room", lambda seen: "robot 1 in the corridor" in seen.named("Map").description)
    screen.click(screen.found("Stop robot 1"))
    stopped = player.until("it to stand", lambda seen: ", ready" in seen.robot(1))
    assert "in the corridor" in stopped.robot(1)
    assert whole - cost < stopped.energy(1) <= whole
    assert room in stopped.free
    # The robot must still be on its way when it is sent elsewhere, however slow the machine is.
    far, second = sent(player, far=True)
    other, bound = next(room for room in stopped.free if room != far), player.look()
    assert bound.energy(1) == pytest.approx(stopped.energy(1) - second, abs=0.11)
    screen.click(bound.rooms[other])
    yes = "Stop it, then room"
    screen.found(yes)
    player.insist(
        "the answer to be taken",
        lambda: [screen.click(button) for button in player.look().buttons if button.name.startswith(yes)],
        lambda seen: seen.button(yes) is None,
    )
    player.until("it to ask about the other room", lambda seen: seen.answers)
    agreed(player)
    player.until("the other room", lambda seen: f"traveling to room {other}" in seen.robot(1))
    assert player.look().energy(1) < stopped.energy(1)
    decided(player, other)
