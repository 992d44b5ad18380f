"""The participant's process holds nothing that the game has not told: memory, traffic and files are searched.

The treasures of this hunt have names, colors, footprints and pictures whose words occur nowhere else in the world.
"""

import json
import re
import shutil
import signal
import socket
import subprocess
import sys
import threading
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.support.programs.process_memory import found_in_memory
from tests.support.programs.processes import THBRIDGE, Program, port_of
from tests.support.project import ROOT
from tests.support.windows.desktop import needs_desktop

KINDS = {
    "Quixzorvel": ("Vrembluth", "Plonktwixt", "zzwarbix.jpg"),
    "Jaxmuthrow": ("Oxfribbleq", "Gwendrazzy", "qqhutmelp.jpg"),
}
"""Name: color, footprint, file."""
SECRETS = [word for name, words in KINDS.items() for word in (name, *words)]


class Tap:
    """Passes connections on to a server, and keeps what it says."""

    def __init__(self, port: int) -> None:
        self._port = port
        self._listener = socket.create_server(("127.0.0.1", 0))
        self.port = self._listener.getsockname()[1]
        self.heard = bytearray()
        threading.Thread(target=self._accept, daemon=True).start()

    def _accept(self) -> None:
        while True:
            try:
                client, _ = self._listener.accept()
            except OSError:
                return
            server = socket.create_connection(("127.0.0.1", self._port))
            threading.Thread(target=self._pump, args=(client, server, False), daemon=True).start()
            threading.Thread(target=self._pump, args=(server, client, True), daemon=True).start()

    def _pump(self, source: socket.socket, target: socket.socket, keep: bool) -> None:
        try:
            while data := source.recv(65536):
                if keep:
                    self.heard += data
                target.sendall(data)
        except OSError:
            pass
        finally:
            for end in (source, target):
                end.close()

    def view(self) -> dict:
        """The latest view that was sent to the participant."""
        lines = [line for line in bytes(self.heard).split(b"\n")[:-1] if b'"kind":"View"' in line]
        return {} if not lines else json.loads(lines[-1].split(b" thbridge ", 1)[1])

    def turns(self) -> list[tuple[int, int]]:
        """How far the talks that wait for the participant have come."""
        return [(talk["dialogue"], talk["turn"]) for talk in self.view()["dialogues"]]

    def close(self) -> None:
        self._listener.close()


@pytest.fixture
def study(tmp_path: Path) -> Path:
    """A study with treasures of its own, in a folder whose name is a secret, too."""
    folder = tmp_path / "game"
    templates = folder / "kept-Yxoblundt"
    shutil.copytree(ROOT / "templates" / "sklar-azhar-2015", templates)
    shutil.rmtree(templates / "de")  # Words for the treasures that the set had.
    shutil.rmtree(templates / "pictures")
    (templates / "pictures").mkdir()
    lines = []
    for (name, (colour, footprint, file)), source in zip(
        KINDS.items(), sorted((ROOT / "templates/sklar-azhar-2015/pictures").iterdir()), strict=False
    ):
        shutil.copy(source, templates / "pictures" / file)
        lines.append(f"{colour},{footprint},10,{name},{file}")
    (templates / "treasures").write_text("\n".join(["8", *lines]) + "\n")
    (templates / "treasures.participant").write_text(
        "\n".join(["8", *(line.rpartition(",")[0] for line in lines)]) + "\n"
    )
    file = folder / "study.yaml"
    file.write_text("map: arena8\ntemplates: ./kept-Yxoblundt\nrobots: 2\nseed: 5\nserver:\n  port: 0\n")
    return file


@pytest.fixture
def hunt(study: Path) -> Iterator[tuple[Tap, Program]]:
    """A tap on the way to the game's programs, and that of the robots."""
    folder = study.parent
    server = Program(folder, "server", "study.yaml")
    programs = [server]
    try:
        port = port_of(server, programs)
        at = ("--server", f"127.0.0.1:{port}")
        robots = Program(folder, "simr", "--study", "study.yaml", "--rate", "4", *at)
        programs += [robots, Program(folder, "hider", "--treasures", "./kept-Yxoblundt", *at)]
        tap = Tap(port)
        yield tap, robots
        tap.close()
    finally:
        for program in programs:
            program.close()


@pytest.mark.slow
@needs_desktop
def test_nothing_of_a_treasure_is_in_the_participants_process_before_it_is_told(hunt, screen, tmp_path):
    elsewhere = tmp_path / "participant"
    elsewhere.mkdir()
    hunt, robots = hunt
    window = subprocess.Popen(
        [*THBRIDGE, "tabui", "--server", f"127.0.0.1:{hunt.port}"],
        cwd=elsewhere,
        env=screen.environment,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    try:
        screen.wait("the game to be there", lambda: hunt.view().get("ready"))
        screen.focus_window("Treasure hunt")
        screen.found("Room 1")

        def search() -> set[str]:
            held = found_in_memory(window.pid, ["Treasure hunt", *SECRETS, "Yxoblundt"])
            assert "Treasure hunt" in held, "the search finds nothing at all"
            seen = held - {"Treasure hunt"}
            files = [str(link.readlink()) for link in (Path("/proc") / str(window.pid) / "fd").iterdir()]
            assert not [name for name in files if "Yxoblundt" in name or "templates" in name]
            assert not [word for word in seen if word.encode() not in hunt.heard], "it knows what nobody told it"
            return seen

        def press_until(key: str, condition) -> None:
            """Press it, and again if nothing comes of it: what has only just come up takes no keys."""

            def met() -> bool:
                screen.press(key)
                try:
                    screen.wait(f"what {key} brings about", condition, 10.0)
                except TimeoutError:
                    return False
                return True

            screen.wait(f"what {key} brings about", met, 120.0)

        assert search() == set()

        # Robot 1 is sent to room 1; until it has sensed something there is nothing to know.
        press_until("1", hunt.turns)
        while before := hunt.turns():
            screen.do("sleep", "0.5")
            press_until("Return", lambda before=before: hunt.turns() != before)
        screen.wait("robot 1 to set out", lambda: hunt.view()["rooms"][0]["state"] != "unvisited")
        # However long looking takes, the robot does not arrive meanwhile.
        robots.process.send_signal(signal.SIGSTOP)
        assert search() == set()
        robots.process.send_signal(signal.SIGCONT)

        screen.wait("the treasure to be sensed", lambda: hunt.view()["rooms"][0]["sensed"], 180.0)
        screen.found("Room 1")
        colour = hunt.view()["rooms"][0]["sensed"]["colour"]
        here = next(name for name, words in KINDS.items() if words[0] == colour)
        (other,) = set(KINDS) - {here}
        # Both names may be chosen from now on; which of them is right, no word tells.
        assert search() <= {*KINDS, KINDS[here][0], KINDS[here][1]}
        file = KINDS[here][2]
        for secret in (file, *KINDS[other]):
            assert secret.encode() not in hunt.heard

        screen.do("sleep", "0.5")
        press_until("ctrl+p", lambda: hunt.turns() or hunt.view()["rooms"][0]["picture"])
        screen.do("sleep", "0.5")
        press_until("Return", lambda: hunt.view()["rooms"][0]["picture"] == file)
        screen.do("sleep", "1")
        assert search() <= {*KINDS, *KINDS[here]}
        told = bytes(hunt.heard)
        assert not re.search(rb'"name":"(Quixzorvel|Jaxmuthrow)"', told)
    finally:
        window.kill()
        window.wait()
        if sys.exc_info()[0] is not None:
            screen.picture(tmp_path / "screen.png")
