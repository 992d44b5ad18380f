"""pymavlink's own tools read our telemetry logs."""

import sys
from pathlib import Path

from tests.support.programs.peer_programs import run_peer
from thbridge.mavlink.files.tlog import TlogFile
from thbridge.mavlink.wire.dialect import crc_extra, mav, payload_of
from thbridge.mavlink.wire.frames.frame import Frame
from thbridge.mavlink.wire.traffic import Traffic
from thbridge.ros.messages.stamps import stamp_ns

TOOLS = Path(sys.executable).parent


def ran(tool, *arguments):
    command = [sys.executable, TOOLS / tool, *arguments]
    done = run_peer(command, timeout=60)
    assert done.returncode == 0, done.stderr
    return done.stdout


def write(path, ticks):
    with TlogFile(path) as log:
        for tick in range(ticks):
            message = mav.MAVLink_attitude_message(tick * 20, 0.0, 0.0, 1.5, 0.0, 0.0, 0.0)
            frame = Frame(1, 1, tick * 3 % 256, message.id, payload_of(message), crc_extra(message.id))
            log.record(stamp_ns(tick), [Traffic(0, False, "a", frame), Traffic(0, False, "b", frame)])


def test_mavlogdump_shows_every_frame(tmp_path):
    write(tmp_path / "run.tlog", 300)
    lines = ran("mavlogdump.py", tmp_path / "run.tlog").splitlines()
    shown = [line for line in lines if "ATTITUDE" in line]
    assert len(shown) == 300
    assert "time_boot_ms : 5980" in shown[-1]
    assert not any("BAD_DATA" in line for line in lines)


def test_mavloss_finds_nothing_lost(tmp_path):
    write(tmp_path / "run.tlog", 300)
    assert "300 packets, 0 lost 0.0%" in ran("mavloss.py", tmp_path / "run.tlog")
