"""Three participants' programs play one game at a server; others are refused, and a seat is resumed after a crash."""

import socket
from pathlib import Path

import pytest

from tests.support.programs.processes import Program, journal, kinds, port_of, until

STUDY = """
robots: 2
dialogue: {condition: collaborator}
seats:
  - {name: driver, robots: [1], names_treasures: false}
  - {name: scout, robots: [2], names_treasures: false, sees_map: false}
  - {name: namer, takes_over: false, sees_energy: false}
team: {agreement: {send: two}}
"""


@pytest.mark.slow
def test_three_programs_play_one_game(tmp_path: Path) -> None:
    (tmp_path / "study.yaml").write_text(STUDY)
    running = [Program(tmp_path, "server", "study.yaml", "--port", "0")]
    try:
        at = ("--server", f"127.0.0.1:{port_of(running[0], running)}")
        running.append(Program(tmp_path, "simr", "study.yaml", *at, "--rate", "16"))
        running.append(Program(tmp_path, "hider", "study.yaml", *at))
        seats = {}
        for seat in ("driver", "scout", "namer"):
            seats[seat] = Program(
                tmp_path, "tabui", "study.yaml", *at, "--participant", "nearest", "--seat", seat, "--json"
            )
            running.append(seats[seat])
        until("the driver to be connected", lambda: "TabUI-driver is connected" in seats["driver"].text, running)
        wrong = [
            Program(tmp_path, "tabui", *at, "--participant", "nearest", "--seat", seat) for seat in ("pilot", "driver")
        ]
        running += wrong
        until(
            "the wrong seat to be refused",
            lambda: "use --seat with one of these names: driver" in wrong[0].text,
            running,
        )
        until("the second driver to wait", lambda: "another program uses this name" in wrong[1].text, running)
        wrong[1].stop()
        with socket.create_connection(("127.0.0.1", int(at[1].rpartition(":")[2])), timeout=20) as old:
            old.sendall(b"%%setid TabUI\n")
            assert old.recv(100).startswith(b"%%sshhuuttddoowwnn")
        until("the log of the old program", lambda: "the program TabUI is refused" in running[0].text, running)
        until("a treasure to be named", lambda: "identified" in kinds(tmp_path), running)
        seats["namer"].kill()
        seats["namer"] = seats["namer"].again()
        running.append(seats["namer"])
        until("the end of the game", lambda: "ended" in kinds(tmp_path), running)
        assert [program.process.wait(90) for program in seats.values()] == [0, 0, 0]
    finally:
        for each in reversed(running):
            each.close()
    events = journal(tmp_path)
    by = {(event["event"], event.get("seat", "")) for event in events}
    assert {("departed", "driver"), ("departed", "scout"), ("identified", "namer"), ("seat-left", "namer")} <= by
    assert not {("departed", "namer"), ("identified", "driver"), ("identified", "scout")} & by
    proposed = {event["decision"]: event["seat"] for event in events if event["event"] == "proposed"}
    settled = [event["decision"] for event in events if event["event"] == "settled"]
    assert sorted(settled) == sorted(set(settled))
    assert all(event["seat"] != proposed[event["decision"]] for event in events if event["event"] == "voted")
