"""A hunt whose program was killed is replayed up to its last second."""

from pathlib import Path

import pytest

from tests.support.programs.processes import Program, run_thbridge, until
from thbridge.recording.bag.reading.reader import messages

ENOUGH = 2_000_000
"""Bytes; some ten seconds of a hunt."""


@pytest.mark.slow
def test_a_killed_hunt_replays_up_to_its_end(tmp_path: Path) -> None:
    # Not at full speed, so that it is far from its end when it is killed, whatever else the machine does.
    hunt = Program(tmp_path, "play", "--port", "0", "--seed", "7", "--rate", "5", "--json", "--bag", "hunt.bag")
    active = tmp_path / "hunt.bag.active"
    try:
        until("some of a hunt", lambda: active.exists() and active.stat().st_size > ENOUGH, [hunt])
    finally:
        hunt.close()  # which kills it
    assert run_thbridge(tmp_path, "bag", "reindex", str(active)).returncode == 0
    done = run_thbridge(tmp_path, "replay", "hunt.bag")
    assert done.returncode == 0, done.stdout + done.stderr
    assert f"All {len(list(messages(tmp_path / 'hunt.bag'))) - 1} messages" in done.stdout
