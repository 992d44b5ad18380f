"""Links with a key, without sockets: who is heard, and what goes out."""

from collections.abc import Sequence
from pathlib import Path

import pytest
from pymavlink.dialects.v20 import all as mav

from thbridge.mavlink.files.signing_timestamps import TimestampFile
from thbridge.mavlink.sockets.links import MavlinkLinks, TimestampStore
from thbridge.mavlink.wire.dialect import payload_of
from thbridge.mavlink.wire.frames.channel import Channel
from thbridge.mavlink.wire.frames.frame import Frame
from thbridge.mavlink.wire.frames.signing import EPOCH, SignatureFault, SigningKey
from thbridge.mavlink.wire.links import HubLink
from thbridge.mavlink.wire.outgoing import LinkId
from thbridge.mavlink.wire.traffic import FrameOutcome, OutgoingFrame

KEY = SigningKey(bytes(range(32)))
NOW = 1_763_000_000.0
PING = mav.MAVLink_ping_message(7, 1, 1, 1)


class Exchange:
    """Notes what it hears, and gives it back."""

    def __init__(self) -> None:
        self.received: list[Frame] = []
        self._opened = 0

    def open_link(self, name: str, robot: int | None = None) -> LinkId:
        self._opened += 1
        return LinkId(self._opened)

    def close_link(self, link: LinkId) -> None:
        """As sessions do."""

    def link(self, link: LinkId) -> HubLink | None:
        return None

    def receive_frame(self, link: LinkId, frame: Frame) -> FrameOutcome:
        self.received.append(frame)
        return FrameOutcome(replies=[OutgoingFrame(link, Frame(1, 1, 0, 4, payload_of(PING), PING.crc_extra))])


class Peer:
    """Somebody on a link; `received` is what came to them."""

    def __init__(self, links: MavlinkLinks, name: str) -> None:
        self.received: list[bytes] = []
        self._links, self._name = links, name
        self._channel: Channel = links.channel(datagrams=True)
        self._link = links.open(name, self._channel, self)

    def send_frames(self, frames: Sequence[bytes]) -> int:
        self.received += frames
        return 0

    def says(self, data: bytes) -> None:
        frames = self._links.frames_in(self._name, self._channel, data)
        if self._link is not None:
            self._links.receive(self._link, frames)


@pytest.fixture
def exchange() -> Exchange:
    return Exchange()


@pytest.fixture
def links(exchange: Exchange) -> MavlinkLinks:
    made = MavlinkLinks(KEY, clock=lambda: NOW)
    made.serve(exchange)
    return made


def pymavlink(key: SigningKey | None = KEY, late: float = 0.0) -> mav.MAVLink:
    peer = mav.MAVLink(None, 255, 190)
    if key is not None:
        peer.signing.secret_key = key.secret
        peer.signing.sign_outgoing = True
        peer.signing.timestamp = int((NOW - late - EPOCH) * 100_000)
    return peer


def test_who_has_the_key_is_heard_and_can_verify_the_answer(links: MavlinkLinks, exchange: Exchange) -> None:
    peer, theirs = Peer(links, "a"), pymavlink()
    peer.says(PING.pack(theirs))
    assert [frame.signature for frame in exchange.received] == [b""]
    (answer,) = peer.received
    assert theirs.decode(bytearray(answer)).get_signed()


@pytest.mark.parametrize(
    ("theirs", "reason"),
    [
        (pymavlink(None), SignatureFault.UNSIGNED),
        (pymavlink(SigningKey(bytes(32))), SignatureFault.WRONG),
        (pymavlink(late=61), SignatureFault.OLD),
    ],
)
def test_who_has_not_is_told_once_in_the_log_and_nothing_on_the_link(
    links: MavlinkLinks,
    exchange: Exchange,
    caplog: pytest.LogCaptureFixture,
    theirs: mav.MAVLink,
    reason: SignatureFault,
) -> None:
    peer = Peer(links, "a")
    for _ in range(3):
        peer.says(PING.pack(theirs))
    assert exchange.received == peer.received == []
    assert [record.message for record in caplog.records] == [f"MAVLink: a: bytes were discarded: {reason}"]


def test_what_was_listened_to_on_one_link_counts_on_no_other(links: MavlinkLinks, exchange: Exchange) -> None:
    said = PING.pack(pymavlink())
    Peer(links, "a").says(said)
    thief = Peer(links, "b")
    thief.says(said)
    assert len(exchange.received) == 1
    assert thief.received == []


def test_what_was_accepted_before_a_restart_is_not_accepted_after_it(exchange: Exchange, tmp_path: Path) -> None:
    def program(store: TimestampStore | None) -> Peer:
        links = MavlinkLinks(KEY, clock=lambda: NOW, store=store)
        links.serve(exchange)
        return Peer(links, "a")

    theirs, late = pymavlink(), pymavlink(late=10.0)
    recorded = PING.pack(theirs)
    program(TimestampFile(tmp_path / "key")).says(recorded)
    assert len(exchange.received) == 1
    second = program(TimestampFile(tmp_path / "key"))
    second.says(recorded)
    assert len(exchange.received) == 1
    second.says(PING.pack(theirs))
    assert len(exchange.received) == 2
    program(None).says(PING.pack(late))
    assert len(exchange.received) == 2
    program(TimestampFile(tmp_path / "another")).says(recorded)  # as if the file were lost: signed at the very start
    program(TimestampFile(tmp_path / "other")).says(PING.pack(late))
    assert len(exchange.received) == 3


def test_links_sign_as_links_of_their_own_and_never_twice_at_the_same_time(links: MavlinkLinks) -> None:
    peers = [Peer(links, name) for name in "ab"]
    theirs = pymavlink()
    for peer in peers:
        peer.says(PING.pack(theirs))
    signatures = [peer.received[0][-13:] for peer in peers]
    assert len({signature[0] for signature in signatures}) == 2
    assert len({signature[1:7] for signature in signatures}) == 2
