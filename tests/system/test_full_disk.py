"""A hunt on a disk that fills up ends loudly, with a bag that any tool reads."""

import os
import shutil
import subprocess

import pytest
from typer.testing import CliRunner

from tests.system import programs
from tests.thbridge.analysis.planting import clean, write
from thbridge.recording.bag.reading.reader import info
from ui.cli import app


@pytest.mark.skipif(os.getuid() != 0 or shutil.which("mount") is None, reason="only root can mount a small disk")
def test_a_hunt_on_a_full_disk_ends_with_a_bag_that_is_whole(tmp_path):
    disk = tmp_path / "disk"
    disk.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=1500k", "none", str(disk)]
    if subprocess.run(mount, check=False).returncode:
        pytest.skip("cannot mount a disk here")
    try:
        play = programs.Program(tmp_path, "play", "--port", "0", "--rate", "0", "--bag", "disk/a.bag", "--no-report")
        try:
            assert play.process.wait(200) == 1, play.text
        finally:
            play.close()
        assert "no space left on device" in play.text
        assert "Traceback" not in play.text
        found = info(disk / "a.bag")
        assert found.duration > 1.0
        assert found.size > 1_000_000
    finally:
        subprocess.run(["umount", "--lazy", str(disk)], check=True)


@pytest.fixture
def small_disk(tmp_path):
    """A disk of 100 kB; `ro` beside it cannot be written to."""
    for name, options in (("disk", "size=100k"), ("ro", "ro")):
        (tmp_path / name).mkdir()
        mount = ["mount", "-t", "tmpfs", "-o", options, "none", str(tmp_path / name)]
        if os.getuid() != 0 or shutil.which("mount") is None or subprocess.run(mount, check=False).returncode:
            pytest.skip("cannot mount a disk here")
    yield tmp_path
    for name in ("disk", "ro"):
        subprocess.run(["umount", "--lazy", str(tmp_path / name)], check=True)


WRITING = [
    ["bag", "cut", "BAG", "--to", "PLACE/new.bag"],
    ["bag", "to-mcap", "BAG", "--compression", "none", "--to", "PLACE/new.mcap"],
    ["bag", "export", "BAG", "--to", "PLACE/new"],
    ["bag", "export", "BAG", "--format", "csv", "--to", "PLACE/new"],
    ["bag", "plot", "BAG", "--what", "paths", "--to", "PLACE/new.svg"],
    ["report", "BAG", "--to", "PLACE/new.html"],
]


@pytest.mark.parametrize("words", WRITING, ids=lambda words: " ".join(words[:2]))
def test_what_a_disk_has_no_room_for_is_told_and_leaves_nothing_behind(small_disk, words):
    bag = write(small_disk / "a.bag", clean())
    (small_disk / "disk" / "fill").write_bytes(bytes(95_000))
    before = {path.name for path in (small_disk / "disk").iterdir()}
    for place, reason in (("disk", "no space left on device"), ("ro", "read-only file system")):
        own = [word.replace("BAG", str(bag)).replace("PLACE", str(small_disk / place)) for word in words]
        done = CliRunner().invoke(app, own)
        assert done.exit_code == 2, done.output
        assert reason in done.stderr.lower()
        assert "--to" in done.stderr
    assert {path.name for path in (small_disk / "disk").iterdir()} == before
