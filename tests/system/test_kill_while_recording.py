"""SIGKILL while a real session records: what is lost is what happened in the last second, for us and for ROS."""

import os
import shutil
import subprocess
import time

import pytest

from tests.system import programs
from thbridge.adapters.bag_reader import info
from thbridge.adapters.bag_repair import reindex


def test_at_most_a_second_is_lost(tmp_path, capsys):
    play = programs.Program(tmp_path, "play", "--port", "0", "--rate", "2", "--bag", "a.bag")
    active = tmp_path / "a.bag.active"
    try:
        programs.until("robots under way", lambda: "sets out" in play.text, [play])
        size = active.stat().st_size
        programs.until("some seconds of it", lambda: active.stat().st_size > size + 400_000, [play])
        # Seen right after a write; so go on until most of a second has gathered in memory again.
        grown = time.monotonic()
        programs.until("more than what was just written", lambda: time.monotonic() > grown + 0.8, [play])
        play.kill()
        killed = time.time()
    finally:
        play.close()
    lost = killed - active.stat().st_mtime
    whole = active.read_bytes()
    mended = reindex(active)
    found = info(tmp_path / "a.bag")
    with capsys.disabled():
        print(f"\nkilled {lost:.2f} s after the last write; {found.duration:.2f} simulated seconds are saved")
    assert found.messages == mended.messages
    assert found.duration > 1.0
    assert mended.lost_bytes == 0
    # A second is the promise; the rest is for a machine that did not let the program run.
    assert lost <= 2.0
    if shutil.which("rosbag") is None:
        pytest.skip("rosbag is not installed: only our own reindex was tried")
    theirs = tmp_path / "theirs.bag"
    theirs.write_bytes(whole)
    subprocess.run(
        ["rosbag", "reindex", "-q", theirs], cwd=tmp_path, check=True, env={**os.environ, "HOME": str(tmp_path)}
    )
    assert info(theirs).messages == found.messages
