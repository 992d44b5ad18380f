"""A person argues with robots in the real window, with the real programs: by keys, and by the mouse."""

import re
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from tests.peers.window_player import STUDY, Player, Sight, on
from tests.support.windows.desktop import Desktop, desktop, needs_desktop

pytestmark = [needs_desktop, pytest.mark.slow]


@pytest.fixture
def screen() -> Iterator[Desktop]:
    with desktop(1024, 600) as opened:
        yield opened


class Arguer(Player):
    """Somebody who gives answers by what they say."""

    def by_key(self, _sight: Sight, at: int) -> None:
        self.screen.press(str(at + 1))

    def by_click(self, sight: Sight, at: int) -> None:
        self.screen.click(sight.answers[at])

    def say(self, give: Callable[[Sight, int], None], *texts: str) -> Sight:
        """Give the answer that contains one of the texts, the earlier ones first; see what follows."""
        seen = self.until(f"one of {texts}", lambda seen: _fitting(seen, texts) is not None)
        before = _names(seen)

        def answer() -> None:
            now = self.look()
            at = _fitting(now, texts)
            if _names(now) == before and at is not None:
                give(now, at)

        return self.insist(f"what follows {texts}", answer, lambda seen: _names(seen) != before)


def _names(sight: Sight) -> list[str]:
    return [answer.name.removesuffix(", not possible at the moment") for answer in sight.answers]


def _fitting(sight: Sight, texts: tuple[str, ...]) -> int | None:
    found = [at for text in texts for at, name in enumerate(_names(sight)) if text in name]
    return found[0] if found else None


def _room(sight: Sight) -> int | None:
    """The room that the pop-up is about; none while the robot thinks of one."""
    found = re.search(r"go to room (\d+)\?", sight.pop.name if sight.pop is not None else "")
    return None if found is None else int(found[1])


def test_a_person_argues_with_two_robots(screen: Desktop, tmp_path: Path) -> None:
    (tmp_path / "study.yaml").write_text(STUDY + "dialogue:\n  condition: collaborator\n")
    program = on(screen, tmp_path, "play", "study.yaml", "--rate", "2", "--bag", "hunt.bag", "--look", "dark")
    player = Arguer(screen)
    try:
        player.rest()
        screen.focus_window("Treasure hunt")
        player.insist("the game", lambda: screen.press("Return"), lambda seen: seen.rooms)
        screen.focus_window("Treasure hunt")

        # Robot 1, by keys alone: she asks it, leaves it, and then persuades it of another room.
        advised = _room(player.insist("advice", lambda: screen.press("d"), _room))
        player.say(player.by_key, "Let us leave it")
        player.until("what came of it", lambda seen: seen.named("Robot 1: Then I"))
        player.insist("it to close", lambda: screen.press("Escape"), lambda seen: seen.pop is None)
        wanted = next(room for room in player.look().free if room != advised)
        player.insist("the dialogue", lambda: screen.press(str(wanted)), lambda seen: seen.answers)
        player.say(player.by_key, "Why not")
        seen = player.say(player.by_key, "I have a question")
        x, y = seen.answers[-1].middle
        player.insist("all questions", lambda: screen.turn_wheel(x, y, down=True), lambda seen: "Back." in _names(seen))
        player.insist("the answers again", lambda: screen.press("Escape"), lambda seen: "Back." not in _names(seen))
        for _ in range(8):
            if not player.look().answers:
                break
            player.say(player.by_key, "No, I still want", f"Go to room {wanted}", "I want", "Let us leave it")
        seen = player.until("robot 1 to set out", lambda seen: f"to room {wanted}" in seen.robot(1))
        assert seen.named(f"Robot 1: All right, I go to room {wanted}") is not None

        # Robot 2, by the mouse alone: it persuades her.
        screen.click(seen.robots[1])
        player.until("robot 2", lambda seen: ", selected" in seen.robot(2))
        player.insist("advice", lambda: screen.click(screen.found("Don't know")), lambda seen: seen.answers)
        player.say(player.by_click, "Why room")
        for _ in range(8):
            if not player.look().answers:
                break
            player.say(player.by_click, "All right")
        player.until("robot 2 to set out", lambda seen: "traveling" in seen.robot(2))

        # One find she names wrongly, by keys, and is told why not; of the other she asks what it is.
        found = player.until(
            "a find", lambda seen: seen.treasure and seen.names and seen.button("I don't know")
        ).treasure
        assert found is not None
        wrong = next(name for name in ("Blue Bottle", "Pink can") if name != found)
        player.insist("a wrong name", lambda: screen.press(wrong[0].lower()), lambda seen: seen.picked == wrong)
        player.insist("the dialogue", lambda: screen.press("Return"), lambda seen: seen.answers)
        seen = player.say(player.by_key, "Why not")
        assert any("My reasons" in one.name for one in seen.things)
        player.say(player.by_key, "All right, the treasure")
        player.say(player.by_key, "What would you do, then")
        player.say(player.by_key, "All right, the treasure")
        player.until("the verdict", lambda seen: seen.named(f"{found} is right"))
        player.insist("it to close", lambda: screen.press("Escape"), lambda seen: not seen.named(f"{found} is right"))
        player.until("the other find", lambda seen: seen.treasure and seen.button("I don't know"))
        player.insist("the robot's answer", lambda: screen.press("ctrl+k"), lambda seen: seen.answers)
        player.say(player.by_key, "All right, the treasure")
        player.until("the verdict", lambda seen: any(" is right, " in one.name for one in seen.things))
        screen.leave_game()
        assert program.process.wait(60) == 0, program.text
    finally:
        screen.picture(tmp_path / "screen.png")
        program.close()
