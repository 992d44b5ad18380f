"""The window as a process, played by small scripts."""

import asyncio
import sys
from pathlib import Path

from msgspec import structs

from thbridge.files.language_texts import shipped_texts
from thbridge.sockets.addresses import ListeningAddress
from ui.hosting.lobby import Answer, GameVisit, LobbyWindow, host
from ui.hosting.window_process import WindowProcess
from ui.model.lobby import LOBBY, Offer

OFFER = Offer(shipped_texts(), least=1, most=4, usual=2)


def window(folder: Path, script: str) -> LobbyWindow:
    """A window process that runs a script; `hear()` reads a line of the host, `say(kind, ...)` writes one."""
    program = folder / "window.py"
    program.write_text(
        "import json, sys\n"
        "from pathlib import Path\n"
        "def hear(): return json.loads(sys.stdin.readline())\n"
        "def say(kind, **fields): print(json.dumps({'type': kind, **fields}), flush=True)\n" + script
    )
    return WindowProcess((sys.executable, str(program)), LOBBY)


def hosted(process: LobbyWindow, offer: Offer = OFFER, answer: Answer = Answer.YES) -> list[tuple[str, int]]:
    """Run it to its end; return the games that were played, with their robots."""
    played: list[tuple[str, int]] = []

    def game(kind: str, robots: int):
        async def play(visit: GameVisit) -> None:
            played.append((kind, robots))
            visit.ready(ListeningAddress("0.0.0.0", 4711))
            while not visit.has_left():
                await asyncio.sleep(0.01)

        return play

    def speak(offer: Offer, language: str) -> Offer:
        return structs.replace(offer, texts=shipped_texts(language))

    program = host(process, offer, "t0", lambda robots: game("game", robots), lambda: game("practice", 1), speak)
    assert asyncio.run(asyncio.wait_for(program, 30)) is answer
    return played


CONSENT = Offer(shipped_texts(), least=1, most=4, usual=2, consent="We record you.")


def test_nothing_is_played_before_the_participant_has_agreed(tmp_path):
    script = """
assert hear()["consent"] == "We record you."
say("Begin", robots=2)
say("Practise")
say("Agreed")
assert hear()["consent"] == ""
say("Begin", robots=3)
hear()
assert hear()["agreed_at"].endswith("Z")
say("Leave")
"""
    assert hosted(window(tmp_path, script), CONSENT) == [("game", 3)]


def test_who_does_not_answer_takes_no_part(tmp_path):
    script = "hear()\nsay('Begin', robots=2)\nsay('Leave')\n"
    assert hosted(window(tmp_path, script), CONSENT, Answer.NONE) == []


def test_a_no_is_final(tmp_path):
    script = """
hear()
say("Declined")
assert hear()["type"] == "Thanks"
say("Agreed")
say("Begin", robots=2)
say("Leave")
"""
    assert hosted(window(tmp_path, script), CONSENT, Answer.NO) == []


def test_a_window_that_crashes_after_a_no_does_not_ask_again(tmp_path):
    process = window(
        tmp_path,
        """
first = not Path(sys.argv[0] + ".was").exists()
Path(sys.argv[0] + ".was").touch()
if first:
    assert hear()["consent"]
    say("Declined")
    hear()
    sys.exit(11)
assert hear()["type"] == "Thanks"
say("Leave")
""",
    )
    assert hosted(process, CONSENT, Answer.NO) == []


def test_a_practice_then_a_game_then_closed(tmp_path):
    process = window(
        tmp_path,
        """
offer = hear()
assert (offer["type"], offer["most"]) == ("Offer", 4)
say("Practise")
assert hear()["type"] == "Preparing"
join = hear()
assert (join["type"], join["host"], join["port"], join["practice"]) == ("Join", "127.0.0.1", 4711, True)
say("Back")
assert hear()["type"] == "Offer"
say("Begin", robots=3)
hear()
assert hear()["practice"] is False
say("Leave")
""",
    )
    assert hosted(process) == [("practice", 1), ("game", 3)]


def test_a_number_of_robots_that_was_not_offered_begins_nothing(tmp_path):
    assert hosted(window(tmp_path, "hear()\nsay('Begin', robots=5)\nsay('Begin', robots=0)\nsay('Leave')\n")) == []


def test_what_a_library_prints_is_no_wish(tmp_path):
    assert hosted(window(tmp_path, "hear()\nprint('Qt: a warning', flush=True)\nsay('Leave')\n")) == []


def test_a_window_that_crashes_is_opened_again_at_its_game(tmp_path):
    process = window(
        tmp_path,
        """
first = not Path(sys.argv[0] + ".was").exists()
Path(sys.argv[0] + ".was").touch()
hear()
if first:
    say("Begin", robots=2)
    hear(); hear()
    sys.exit(11)
assert hear()["type"] == "Preparing"
assert hear()["type"] == "Join"
say("Leave")
""",
    )
    assert hosted(process) == [("game", 2)]


def test_a_window_that_crashes_again_and_again_stays_closed(tmp_path):
    process = window(tmp_path, "hear()\nsys.exit(11)\n")
    assert hosted(process) == []
    assert process.given_up


def test_a_window_that_was_closed_has_not_crashed(tmp_path):
    process = window(tmp_path, "hear()\nsay('Leave')\n")
    hosted(process)
    assert not process.given_up


def test_a_language_that_may_be_chosen_is_spoken_from_then_on(tmp_path):
    script = """
assert hear()["texts"]["language"] == "en"
say("ChooseLanguage", language="xx")
say("ChooseLanguage", language="de")
assert hear()["texts"]["language"] == "de"
say("Begin", robots=2)
assert hear()["sentence"] == "Die 2 Roboter werden vorbereitet."
hear()
say("Back")
assert hear()["texts"]["language"] == "de"
say("Leave")
"""
    free = structs.replace(OFFER, languages={"en": "English", "de": "Deutsch"})
    assert hosted(window(tmp_path, script), free) == [("game", 2)]
