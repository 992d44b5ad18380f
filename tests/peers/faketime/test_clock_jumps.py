"""The clock of the machine jumps by an hour, there and back, under running programs.

libfaketime makes Python's waiting last longer than it should, jump or no jump: nothing is said here about the pace.
"""

from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.support.programs.jumping_clock import JUMPS, LIBRARY, Clock
from tests.support.programs.processes import Program, journal, kinds, port_of, until

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(LIBRARY is None, reason="libfaketime is not installed (see scripts/install_peers.sh)"),
]


@pytest.fixture
def clock(tmp_path: Path) -> Iterator[Clock]:
    yield Clock(tmp_path)


def test_a_hunt_goes_on_and_is_replayed(tmp_path: Path, clock: Clock) -> None:
    options = ("--headless", "--rate", "2", "--max-seconds", "30", "--bag", "a.bag", "--no-report", "--port", "0")
    hunt = Program(tmp_path, "play", *options, "--mavlink", "--watch", "0", environment=clock.environment)
    try:
        for number, offset in enumerate(JUMPS):
            until("the next room", lambda: hunt.text.count("is in room") > number, [hunt])  # noqa: B023 - called at once
            clock.jump(offset)
        hunt.process.wait(120)
    finally:
        hunt.close()
    assert "The game did not end within 30 simulated seconds" in hunt.text
    assert "Traceback" not in hunt.text
    replay = Program(tmp_path, "replay", "a.bag")
    assert replay.process.wait(120) == 0, replay.text
    replay.close()


def test_programs_at_a_server_stay_connected(tmp_path: Path, clock: Clock) -> None:
    running = [Program(tmp_path, "server", "--port", "0", environment=clock.environment)]
    try:
        server = f"127.0.0.1:{port_of(running[0], running)}"
        running += [
            Program(tmp_path, "simr", "--server", server, "--rate", "4", environment=clock.environment),
            Program(tmp_path, "hider", "--server", server, environment=clock.environment),
            Program(tmp_path, "tabui", "--server", server, environment=clock.environment),
        ]
        for number, offset in enumerate(JUMPS, start=1):
            until("a robot in a room", lambda: kinds(tmp_path).count("arrived") >= number, running)  # noqa: B023
            clock.jump(offset)
        until("the end of the game", lambda: "ended" in kinds(tmp_path), running, 300)
    finally:
        for program in running:
            program.close()
    assert not any("lost" in program.text or "Traceback" in program.text for program in running)
    ticks = [event["tick"] for event in journal(tmp_path) if "tick" in event]
    assert ticks == sorted(ticks)
