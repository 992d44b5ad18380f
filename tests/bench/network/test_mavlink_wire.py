"""What MAVLink costs: frames found in bytes, and the words of 50 vehicles on three links."""

import random
import time
from functools import partial

import pytest

from sim.common.geometry import Pose2
from sim.common.observations import TICKS_PER_SECOND, Twist
from tests.bench.budget import Budgets, best
from thbridge.mavlink.hub import Hub
from thbridge.mavlink.values.vehicle_interface import RobotReadings
from thbridge.mavlink.wire.dialect import crc_extra, mav, payload_of
from thbridge.mavlink.wire.frames.frame import Frame
from thbridge.mavlink.wire.frames.framer import FrameParser
from thbridge.mavlink.wire.frames.signing import SignatureTimestamps, Signing, SigningKey
from thbridge.mavlink.wire.outgoing import LinkId, OutgoingMessage

pytestmark = pytest.mark.bench

ROBOTS = 50
RATE = 40
LINKS = 3
SECONDS = 5
TIMES = 3

READINGS = RobotReadings(Pose2(0, 0, 0), Twist(0, 0), None, 1, 1, True, False, False, None, "participant", None)
ATTITUDE = mav.MAVLink_attitude_message(1000, 0.0, 0.0, 1.5, 0.0, 0.0, 0.1)
HEARTBEAT = mav.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3)


class Talker:
    """Says as many messages a second as a vehicle at its default rates."""

    def __init__(self, system):
        self.system = system

    def handle_message(self, link, sender, message):
        return ()

    def step(self, tick, readings):
        before, now = (RATE * (tick + more) // TICKS_PER_SECOND for more in (0, 1))
        for _ in range(now - before):
            yield OutgoingMessage(mav.MAVLink_attitude_message(tick, 0.0, 0.0, 1.5, 0.0, 0.0, 0.1))

    def forget(self, link):
        pass


def frame_of(message, system):
    message_id = message.get_msgId()
    return Frame(system, 1, 0, message_id, payload_of(message), crc_extra(message_id))


def test_fifty_vehicles(budgets: Budgets):
    runs = [fifty_vehicles() for _ in range(TIMES)]
    spent, packing, frames = (min(each) for each in zip(*runs, strict=True))
    print(
        f"{ROBOTS} vehicles of {RATE} messages/s on {LINKS} links: {1e3 * spent / SECONDS:.0f} ms of CPU a simulated "
        f"second, of which {1e3 * packing / SECONDS:.0f} ms to make bytes; {frames / spent:.0f} frames/s"
    )
    budgets.time(f"MAVLink: a second of {ROBOTS} vehicles on {LINKS} links", spent / SECONDS)
    budgets.time(f"MAVLink: making bytes, a second of {ROBOTS} vehicles on {LINKS} links", packing / SECONDS)


def fifty_vehicles() -> tuple[float, float, int]:
    """CPU seconds of some seconds, those of making bytes in them, and the number of frames."""
    hub = Hub([Talker(system) for system in range(1, ROBOTS + 1)], timeout=1000)
    for number in range(LINKS):
        hub.open(LinkId(number), str(number))
        hub.receive(LinkId(number), frame_of(HEARTBEAT, 255 - number))
    hub.take_traffic()
    begun, frames, packing = time.process_time(), 0, 0.0
    for tick in range(SECONDS * TICKS_PER_SECOND):
        sent = hub.step(tick, [READINGS] * ROBOTS)
        hub.take_traffic()
        packed = time.process_time()
        for one in sent:
            one.frame.to_bytes()
        packing += time.process_time() - packed
        frames += len(sent)
    return time.process_time() - begun, packing, frames


def test_framer(budgets: Budgets):
    traffic = b"".join(frame_of(ATTITUDE, 1 + number % 250).to_bytes() for number in range(20_000))
    floods = {"frames": traffic, "random bytes": random.Random(1).randbytes(2_000_000), "0xFD": b"\xfd" * 2_000_000}
    for name, data in floods.items():
        spent = best(partial(parsed, data), TIMES)
        print(f"framer, {name}: {len(data) / spent / 1e6:.1f} MB/s")
        budgets.time(f"MAVLink: parsing a megabyte, {name}", 1e6 * spent / len(data))


def parsed(data: bytes) -> None:
    framer = FrameParser()
    for place in range(0, len(data), 65536):
        framer.receive_data(data[place : place + 65536])


def test_signing(budgets: Budgets):
    signings, verifyings = zip(*(sign_and_verify() for _ in range(TIMES)), strict=True)
    print(f"signing: {min(signings) * 100:.1f} us a frame; verifying: {min(verifyings) * 100:.1f} us")
    budgets.time("MAVLink: signing 10000 frames", min(signings))
    budgets.time("MAVLink: verifying 10000 frames", min(verifyings))


def sign_and_verify() -> tuple[float, float]:
    """CPU seconds of signing ten thousand frames, and of verifying them, parsed already."""
    signing, other = (Signing(SigningKey(bytes(32)), 0, SignatureTimestamps()) for _ in range(2))
    frame = frame_of(ATTITUDE, 1)
    begun = time.process_time()
    wrapped = [signing.sign(frame, 1.8e9) for _ in range(10_000)]
    signed = time.process_time()
    framer = FrameParser()
    signatures = framer.receive_data(b"".join(wrapped))
    found = time.process_time()
    for one in signatures:
        assert isinstance(other.verify(one, 1.8e9), Frame)
    return signed - begun, time.process_time() - found
