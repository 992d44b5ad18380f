"""Messages that pymavlink lacks: their seeds are MAVLink's, as the published headers of C have them."""

import pytest

from thbridge.mavlink.wire.dialect import crc_extra, decoded, mav, payload_of
from thbridge.mavlink.wire.extra_messages import (
    ADDED,
    CommandCancel,
    ComponentInformation,
    ComponentMetadata,
    ProtocolVersion,
)


@pytest.mark.parametrize(("number", "seed"), [(80, 14), (300, 217), (395, 0), (397, 182)])
def test_a_seed_is_the_published_one(number, seed):
    assert crc_extra(number) == seed


def test_they_are_lacking():
    assert not set(ADDED) & set(mav.mavlink_map), "take pymavlink's own"


@pytest.mark.parametrize(
    "message",
    [
        CommandCancel(3, 1, 16),
        ProtocolVersion(200, 100, 200, list(range(1, 9)), list(range(8, 0, -1))),
        ComponentInformation(17, 1, b"mftp://somewhere", 0, b""),
        ComponentMetadata(17, 0, b"http://somewhere"),
    ],
    ids=lambda message: message.msgname,
)
def test_they_survive_the_wire(message):
    assert decoded(message.get_msgId(), payload_of(message)).to_dict() == message.to_dict()


def test_larger_fields_come_first():
    assert payload_of(CommandCancel(3, 1, 16)) == bytes((16, 0, 3, 1))
