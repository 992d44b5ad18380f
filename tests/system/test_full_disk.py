"""A hunt on a disk that fills up ends loudly, with a bag that any tool reads."""

import os
import shutil
import subprocess

import pytest

from tests.system import programs
from thbridge.recording.bag.reading.reader import info


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
