"""Data of discovery: participants (SPDP) and endpoints (SEDP) as lists of parameters.

Source: DDSI-RTPS 2.3, sections 8.5 and 9.6.2.2.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from thbridge.ros2.qos import DeliveryReliability, Durability, QosProfile
from thbridge.ros2graph.wire.rtps import parameters
from thbridge.ros2graph.wire.rtps.guids import PARTICIPANT, PREFIX_SIZE, Guid, is_reader, is_writer
from thbridge.ros2graph.wire.rtps.parameters import Parameter, Pid, UdpAddress, decode_payload, encode_payload
from thbridge.ros2graph.wire.rtps.submessages import VENDOR, VERSION

BUILTIN_ENDPOINTS = 0x3F
"""Our built-in endpoints: announcement and detection of participants, publications and subscriptions. Peers need no
messages about liveliness (WLP), because each endpoint of ROS is alive as long as its participant."""
LEASE_NS = 20_000_000_000
"""Time after our last announcement until others forget us. Fast DDS has the same."""
MOST_LOCATORS = 16
"""Maximum number of addresses of a participant or endpoint."""
LONGEST_NAME = 256
"""Maximum length of the name of a topic or type."""

_KEEP_LAST = 0
_MOST_USER_DATA = 4096
_DEFAULT_LEASE_NS = 100_000_000_000
_BLOCKING_NS = 100_000_000
_DISPOSED = b"\x00\x00\x00\x03"
_XCDR1 = bytes(2)


@dataclass(frozen=True, slots=True)
class ParticipantData:
    """Announced participant.

    Attributes:
        guid: its GUID.
        vendor: its implementation.
        metatraffic: addresses that receive discovery.
        default: addresses that receive messages of endpoints.
        lease_ns: time without announcement after which it counts as gone. If None, it never does.
        user_data: for example `enclave=/;`.
    """

    guid: Guid
    vendor: bytes
    metatraffic: Sequence[UdpAddress]
    default: Sequence[UdpAddress]
    lease_ns: int | None
    user_data: bytes

    def encode(self) -> bytes:
        """Return the payload that announces it."""
        return encode_payload(
            [
                (Pid.PROTOCOL_VERSION, VERSION),
                (Pid.VENDOR_ID, self.vendor),
                (Pid.PARTICIPANT_GUID, self.guid),
                (Pid.BUILTIN_ENDPOINT_SET, parameters.numbers(BUILTIN_ENDPOINTS)),
                *((Pid.METATRAFFIC_UNICAST_LOCATOR, parameters.locator(each)) for each in self.metatraffic),
                *((Pid.DEFAULT_UNICAST_LOCATOR, parameters.locator(each)) for each in self.default),
                (Pid.LEASE_DURATION, parameters.duration(self.lease_ns)),
                (Pid.USER_DATA, parameters.octets(self.user_data)),
                (Pid.ENTITY_NAME, parameters.string("/")),
            ]
        )

    @classmethod
    def decode(cls, payload: bytes) -> "ParticipantData":
        """Return the announced participant.

        Raises:
            ValueError: the payload announces no participant.
        """
        guid, vendor, user_data = b"", VENDOR, b""
        lease_ns: int | None = _DEFAULT_LEASE_NS
        metatraffic: list[UdpAddress] = []
        default: list[UdpAddress] = []
        for each in decode_payload(payload):
            match each.pid:
                case Pid.PARTICIPANT_GUID:
                    guid = each.guid()
                case Pid.VENDOR_ID:
                    vendor = each.value[:2]
                case Pid.METATRAFFIC_UNICAST_LOCATOR:
                    _append(metatraffic, each)
                case Pid.DEFAULT_UNICAST_LOCATOR:
                    _append(default, each)
                case Pid.LEASE_DURATION:
                    lease_ns = each.duration_ns()
                case Pid.USER_DATA:
                    user_data = each.octets()[:_MOST_USER_DATA]
        if guid[PREFIX_SIZE:] != PARTICIPANT:
            raise ValueError("a participant has no GUID")
        return cls(guid, vendor, metatraffic, default, lease_ns, user_data)


@dataclass(frozen=True, slots=True)
class EndpointData:
    """Announced endpoint of a topic.

    Attributes:
        guid: its GUID. It says whether this is a writer or a reader.
        topic: name on the wire, for example "rt/chatter".
        type: name on the wire, for example "std_msgs::msg::dds_::String_".
        qos: its quality of service.
        user_data: for example `typehash=RIHS01_...;`.
        addresses: its own addresses. If empty, it uses those of its participant.
    """

    guid: Guid
    topic: str
    type: str
    qos: QosProfile
    user_data: bytes
    addresses: Sequence[UdpAddress] = ()

    @property
    def prefix(self) -> bytes:
        """Prefix of its participant."""
        return self.guid[:PREFIX_SIZE]

    @property
    def is_writer(self) -> bool:
        """True for a writer, False for a reader."""
        return is_writer(self.guid)

    def encode(self) -> bytes:
        """Return the payload that announces it."""
        is_reliable = self.qos.reliability == DeliveryReliability.RELIABLE
        is_latched = self.qos.durability == Durability.TRANSIENT_LOCAL
        return encode_payload(
            [
                (Pid.ENDPOINT_GUID, self.guid),
                (Pid.PARTICIPANT_GUID, self.guid[:PREFIX_SIZE] + PARTICIPANT),
                (Pid.TOPIC_NAME, parameters.string(self.topic)),
                (Pid.TYPE_NAME, parameters.string(self.type)),
                (Pid.RELIABILITY, parameters.numbers(2 if is_reliable else 1) + parameters.duration(_BLOCKING_NS)),
                (Pid.DURABILITY, parameters.numbers(1 if is_latched else 0)),
                (Pid.HISTORY, parameters.numbers(_KEEP_LAST, self.qos.depth)),
                (Pid.DEADLINE, parameters.duration(None)),
                (Pid.LIVELINESS, parameters.numbers(0) + parameters.duration(None)),
                *([(Pid.LIFESPAN, parameters.duration(self.qos.lifespan_ns))] if self.is_writer else ()),
                (Pid.DATA_REPRESENTATION, parameters.numbers(1) + _XCDR1),
                (Pid.USER_DATA, parameters.octets(self.user_data)),
            ]
        )

    @classmethod
    def decode(cls, payload: bytes) -> "EndpointData":
        """Return the announced endpoint.

        Raises:
            ValueError: the payload announces no endpoint.
        """
        guid, topic, type_name, user_data = b"", "", "", b""
        reliability: int | None = None
        durability, depth = 0, 1
        lifespan_ns: int | None = None
        addresses: list[UdpAddress] = []
        for each in decode_payload(payload):
            match each.pid:
                case Pid.ENDPOINT_GUID:
                    guid = each.guid()
                case Pid.TOPIC_NAME:
                    topic = each.string()
                case Pid.TYPE_NAME:
                    type_name = each.string()
                case Pid.RELIABILITY:
                    reliability = each.number()
                case Pid.DURABILITY:
                    durability = each.number()
                case Pid.HISTORY:
                    depth = max(1, each.numbers()[1])
                case Pid.LIFESPAN:
                    lifespan_ns = each.duration_ns()
                case Pid.USER_DATA:
                    user_data = each.octets()[:_MOST_USER_DATA]
                case Pid.UNICAST_LOCATOR:
                    _append(addresses, each)
        if not guid or not (is_writer(guid) or is_reader(guid)):
            raise ValueError("an endpoint has no GUID")
        if not (0 < len(topic) <= LONGEST_NAME and 0 < len(type_name) <= LONGEST_NAME):
            raise ValueError("an endpoint has no topic or type, or their names are too long")
        # Without the parameter, writers are reliable, and readers are not (DDS 1.4, section 2.2.3).
        is_reliable = is_writer(guid) if reliability is None else reliability >= 2
        qos = QosProfile(
            depth,
            DeliveryReliability.RELIABLE if is_reliable else DeliveryReliability.BEST_EFFORT,
            Durability.TRANSIENT_LOCAL if durability else Durability.VOLATILE,
            lifespan_ns,
        )
        return cls(guid, topic, type_name, qos, user_data, tuple(addresses))


def disposal(guid: Guid) -> tuple[bytes, bytes]:
    """Return the inline quality of service, and the key, that say that a participant or endpoint is gone."""
    pid = Pid.PARTICIPANT_GUID if guid[PREFIX_SIZE:] == PARTICIPANT else Pid.ENDPOINT_GUID
    inline = parameters.encode_inline([(Pid.KEY_HASH, guid), (Pid.STATUS_INFO, _DISPOSED)])
    return inline, encode_payload([(pid, guid)])


def is_disposed(inline: Sequence[Parameter]) -> bool:
    """Return True if a sample says that its object is gone."""
    return any(each.pid == Pid.STATUS_INFO and each.value[3:4] > b"\x00" for each in inline)


def disposed_guid(inline: Sequence[Parameter], payload: bytes) -> Guid:
    """Return the GUID of a participant or endpoint that is gone.

    Raises:
        ValueError: the sample does not say it.
    """
    for each in inline:
        if each.pid == Pid.KEY_HASH:
            return each.guid()
    for each in decode_payload(payload):
        if each.pid in {Pid.ENDPOINT_GUID, Pid.PARTICIPANT_GUID}:
            return each.guid()
    raise ValueError("it is unknown which endpoint is gone")


def _append(addresses: list[UdpAddress], parameter: Parameter) -> None:
    address = parameter.address()
    if address is not None and len(addresses) < MOST_LOCATORS:
        addresses.append(address)
