"""Kill each program in the middle of a hunt, start it again the same way: the hunt goes on and ends with a score."""

from pathlib import Path

import pytest

from tests.support.programs import processes
from tests.support.programs.ports import free_port

Program, until, kinds, journal = processes.Program, processes.until, processes.kinds, processes.journal


@pytest.fixture
def hunt(tmp_path):
    """Server, SimR, Hider and TabUI, by their names; robots run sixteen times as fast as in real time."""
    running: dict[str, Program] = {}
    server = Program(tmp_path, "server", "--port", "0")
    running["server"] = server
    try:
        port = processes.port_of(server, [server])
        # Started again, the server must be found where it was.
        server.arguments = ("server", "--port", str(port))
        at = f"127.0.0.1:{port}"
        running["simr"] = Program(tmp_path, "simr", "--server", at, "--rate", "16", "--seed", "5", "--bag", "hunt.bag")
        running["hider"] = Program(tmp_path, "hider", "--server", at, "--seed", "5")
        running["tabui"] = Program(tmp_path, "tabui", "--server", at, "--json")
        yield running
    finally:
        for program in running.values():
            program.close()


@pytest.mark.slow
def test_a_hunt_survives_the_death_of_each_program(hunt, tmp_path):
    def count(kind: str) -> int:
        return kinds(tmp_path).count(kind)

    def everyone() -> list[Program]:
        return list(hunt.values())

    until("the hunt to begin", lambda: count("departed") >= 2, everyone())
    treasures = next(event for event in journal(tmp_path) if event["event"] == "hidden")["treasures"]

    for name in ("hider", "simr", "server", "tabui"):
        arrivals = count("arrived")
        hunt[name].kill()
        hunt[name] = hunt[name].again()
        until(f"the hunt to go on without the first {name}", lambda n=arrivals: count("arrived") > n, everyone())

    until("the end of the hunt", lambda: "ended" in kinds(tmp_path), everyone())
    assert hunt["tabui"].process.wait(90) == 0
    ended = journal(tmp_path)[-1]
    assert ended["event"] == "ended"
    assert f'"score": {ended["score"]}' in hunt["tabui"].text
    assert count("started") == count("hidden") == 1
    assert next(event for event in journal(tmp_path) if event["event"] == "hidden")["treasures"] == treasures
    rooms = [event["room"] for event in journal(tmp_path) if event["event"] == "arrived"]
    assert len(rooms) == len(set(rooms)), "a room is visited once"
    assert not (tmp_path / "journal" / "game-0002.jsonl").exists()
    # The killed SimR left its recording; the next one did not write over it.
    assert (tmp_path / "hunt-1.bag.active").exists()
    assert hunt["simr"].stop() == 0
    assert (tmp_path / "hunt.bag").exists()


@pytest.mark.slow
def test_after_a_game_the_terminal_says_how_another_begins_and_so_it_does(tmp_path: Path):
    def first_of(game: int) -> list[str]:
        return [event["event"] for event in journal(tmp_path, game)][:2]

    (tmp_path / "study.yaml").write_text(
        f"robots: 1\nserver: {{host: 0.0.0.0, port: {free_port()}}}\nopen_to: [10.0.0.0/8]\n"
    )
    running = [Program(tmp_path, "server", "study.yaml")]
    try:
        processes.port_of(running[0], running)
        # All find the server where the study has it.
        running.append(Program(tmp_path, "simr", "study.yaml", "--rate", "16"))
        running += [Program(tmp_path, name, "--study", "study.yaml") for name in ("hider", "tabui")]
        tabui = running[-1]
        until("the end of the game", lambda: tabui.process.poll() is not None, running)
        assert tabui.process.returncode == 0
        assert "or stop and restart `thbridge server` (or `thbridge play`)." in tabui.text
        assert running[0].stop() == 0
        running.append(running[0].again())
        until("another game", lambda: first_of(2) == ["started", "hidden"], running)
    finally:
        for program in running:
            program.close()
