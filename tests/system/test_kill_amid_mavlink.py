"""SIGKILL while ground stations are spoken to: bag and telemetry log have what these heard, but for a last moment."""

import socket
import time
from pathlib import Path

import pytest

from tests.support.programs.processes import Program, until
from thbridge.app.session.mavros import frame_in
from thbridge.mavlink.wire.dialect import crc_extra, mav, payload_of
from thbridge.mavlink.wire.frames.frame import Frame
from thbridge.mavlink.wire.frames.framer import FrameParser
from thbridge.recording.bag.reading.reader import messages
from thbridge.recording.bag.repair import reindex
from thbridge.ros.messages import unpack

LOST = 1.0
"""Seconds before the kill of which nothing is promised."""


def beat(sequence: int) -> bytes:
    said = mav.MAVLink_heartbeat_message(mav.MAV_TYPE_GCS, mav.MAV_AUTOPILOT_INVALID, 0, 0, 0, 3)
    seed = crc_extra(said.get_msgId())
    assert seed is not None
    return Frame(255, 190, sequence, said.get_msgId(), payload_of(said), seed).to_bytes()


def frames_in(data: bytes) -> list[bytes]:
    return [found.to_bytes() for found in FrameParser().receive_data(data) if isinstance(found, Frame)]


def logged(tlog: Path) -> set[bytes]:
    """The frames of a telemetry log, each behind eight bytes of time; the last may be cut off."""
    data, found, place = tlog.read_bytes(), set(), 0
    while place + 10 <= len(data):
        end = place + 8 + 12 + data[place + 9]
        found.add(data[place + 8 : end])
        place = end
    return found


@pytest.mark.slow
def test_what_a_station_heard_is_kept(tmp_path: Path) -> None:
    (tmp_path / "study.yaml").write_text("robots: 3\n")
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as station:
        station.bind(("127.0.0.1", 0))
        station.settimeout(0.1)
        play = Program(
            tmp_path, "play", "study.yaml", "--mavlink", "--udp", f"127.0.0.1:{station.getsockname()[1]}",
            "--headless", "--outside", "TabUI", "--port", "0", "--bag", "a.bag", "--tlog",
        )  # fmt: skip
        heard: list[tuple[float, bytes]] = []

        def listen(seconds: float) -> None:
            end, beaten = time.monotonic() + seconds, 0.0
            while time.monotonic() < end:
                try:
                    data, sender = station.recvfrom(65536)
                except TimeoutError:
                    continue
                now = time.monotonic()
                heard.extend((now, frame) for frame in frames_in(data))
                if now - beaten > 0.5:
                    beaten = now
                    station.sendto(beat(len(heard) % 256), sender)

        def enough() -> bool:
            listen(0.5)
            return len(heard) > 400

        try:
            until("some hundred frames", enough, [play])
            play.kill()
            killed = time.monotonic()
            listen(0.3)
        finally:
            play.close()
    (active,) = tmp_path.glob("a*.bag.active")
    reindex(active)
    topics = [f"/robot{robot}/mavlink/from" for robot in (1, 2, 3)]
    recorded = {frame_in(unpack.mavlink(message.data)).to_bytes() for message in messages(tmp_path / "a.bag", topics)}
    kept = {"bag": recorded, "tlog": logged(tmp_path / "a.tlog")}
    for name, frames in kept.items():
        missing = [at for at, frame in heard if frame not in frames]
        print(
            f"{name}: {len(missing)} of {len(heard)} frames, from {killed - min(missing, default=killed):.2f} s before"
        )
        assert killed - min(missing, default=killed) <= LOST
