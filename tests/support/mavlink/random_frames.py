"""Random frames for tests, with any message of the dialect."""

from hypothesis import strategies as st
from pymavlink.dialects.v20 import all as mav

from thbridge.mavlink.wire.dialect import SECRETS
from thbridge.mavlink.wire.frames.frame import V1, V2, Frame

KINDS = {message_id: kind for message_id, kind in mav.mavlink_map.items() if message_id not in SECRETS}


@st.composite
def frames(draw, versions=(V1, V2)):
    """Return frames without a signature, with any message that contains no secret."""
    version = draw(st.sampled_from(versions))
    known = sorted(KINDS) if version == V2 else [message_id for message_id in sorted(KINDS) if message_id < 256]
    message_id = draw(st.sampled_from(known))
    kind = KINDS[message_id]
    size = kind.unpacker.size
    payload = draw(st.binary(min_size=1, max_size=size) if version == V2 else st.binary(min_size=size, max_size=size))
    system, component, sequence = draw(st.integers(1, 255)), draw(st.integers(0, 255)), draw(st.integers(0, 255))
    return Frame(system, component, sequence, message_id, payload, kind.crc_extra, version)
