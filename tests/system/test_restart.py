"""Kill each program in the middle of a hunt, start it again the same way: the hunt goes on and ends with a score."""

import pytest

from tests.system import programs

Program, until, kinds, journal = programs.Program, programs.until, programs.kinds, programs.journal


@pytest.fixture
def hunt(tmp_path):
    """Server, SimR, Hider and TabUI, by their names; robots run sixteen times as fast as in real time."""
    running: dict[str, Program] = {}
    server = Program(tmp_path, "server", "--port", "0")
    running["server"] = server
    try:
        port = programs.port_of(server, [server])
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
