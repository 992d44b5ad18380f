"""Keys of rmw_zenoh: keys of topics and services, and liveliness keys, by which programs announce their graph.

Source: rmw_zenoh, docs/design.md and liveliness_utils.cpp.
"""

import re
from dataclasses import dataclass

from xxhash import xxh3_128_intdigest

from thbridge.ros2.qos import QosProfile
from thbridge.ros2.supports import MessageSupport
from thbridge.ros2graph.values.graph import EndpointRole, GraphEndpoint, NodeName
from thbridge.ros2graph.wire.zenoh.qos_text import read_qos, write_qos

LONGEST_KEY = 2048
"""Maximum number of characters of a liveliness key of another program."""

_SPACE = "@ros2_lv"
_ROLES = {
    EndpointRole.PUBLISHER: "MP",
    EndpointRole.SUBSCRIPTION: "MS",
    EndpointRole.SERVER: "SS",
    EndpointRole.CLIENT: "SC",
}
_ROLE_OF = {text: role for role, text in _ROLES.items()}
_ID = r"[0-9A-Za-z]{1,32}"
_WORD = r"[A-Za-z_][A-Za-z0-9_]{0,254}"
_NAME = rf"(?:%{_WORD})+"
_LIVELINESS_KEY = re.compile(
    rf"{_SPACE}/([0-9]{{1,10}})/({_ID})/{_ID}/{_ID}/([A-Z]{{2}})/[^/]+/(%|{_NAME})/({_WORD})"
    rf"(?:/({_NAME})/({_WORD})::(msg|srv|action)::dds_::({_WORD})_/(\w+)/([^/]+))?",
    re.ASCII,
)
_HASH = re.compile(r"RIHS01_[0-9a-f]{64}")


@dataclass(frozen=True, slots=True)
class EndpointKeys:
    """Keys of an endpoint of this program.

    Attributes:
        role: its role.
        data: key of its messages, or of its requests and responses.
        liveliness: key that announces it.
    """

    role: EndpointRole
    data: str
    liveliness: str

    @property
    def gid(self) -> bytes:
        """Unique id of the endpoint."""
        return gid_of(self.liveliness)


@dataclass(frozen=True, slots=True)
class Announcement:
    """Announcement of a node or an endpoint.

    Attributes:
        session: id of the program's zenoh session.
        node: the node.
        endpoint: the endpoint. If None, the node itself is announced.
        data: key of the endpoint's messages; empty for a node.
    """

    session: str
    node: NodeName
    endpoint: GraphEndpoint | None
    data: str


def graph_key(domain: int) -> str:
    """Return the key expression of all liveliness keys in a domain."""
    return f"{_SPACE}/{domain}/**"


def data_key(domain: int, name: str, dds_type: str, type_hash: str) -> str:
    """Return the key of a topic or service, for example "0/chatter/std_msgs::msg::dds_::String_/RIHS01_df66..."."""
    return f"{domain}/{name.strip('/')}/{dds_type}/{type_hash}"


@dataclass(frozen=True, slots=True)
class SessionKeys:
    """Liveliness keys of this program.

    Attributes:
        domain: domain of the graph, from 0.
        session: id of this program's zenoh session.
    """

    domain: int
    session: str

    def node(self, number: int, node: NodeName) -> str:
        """Return the key that announces a node. Nodes and endpoints of a session have different numbers."""
        return self._key(number, number, "NN", node)

    def endpoint(
        self,
        node_number: int,
        number: int,
        node: NodeName,
        role: EndpointRole,
        name: str,
        dds_type: str,
        type_hash: str,
        qos: QosProfile,
    ) -> EndpointKeys:
        """Return the keys of an endpoint."""
        key = self._key(node_number, number, _ROLES[role], node)
        data = data_key(self.domain, name, dds_type, type_hash)
        return EndpointKeys(role, data, f"{key}/{_mangled(name)}/{dds_type}/{type_hash}/{write_qos(qos)}")

    def _key(self, node_number: int, number: int, kind: str, node: NodeName) -> str:
        names = f"%/{_mangled(node.namespace)}/{node.name}"
        return f"{_SPACE}/{self.domain}/{self.session}/{node_number}/{number}/{kind}/{names}"


def read_liveliness_key(key: str) -> Announcement | None:
    """Return what another program announces with a liveliness key. If the key is invalid, return None."""
    found = _LIVELINESS_KEY.fullmatch(key) if len(key) <= LONGEST_KEY else None
    if found is None:
        return None
    domain, session, kind, namespace, name, *about = found.groups()
    node = NodeName(_demangled(namespace), name)
    if kind == "NN":
        return Announcement(session, node, None, "") if about[0] is None else None
    role = _ROLE_OF.get(kind)
    if role is None or about[0] is None:
        return None
    mangled, package, kind_of_type, type_name, type_hash, qos_text = about
    qos, topic = read_qos(qos_text), _demangled(mangled)
    if qos is None:
        return None
    type_ = f"{package}/{kind_of_type}/{type_name}"
    known_hash = type_hash if _HASH.fullmatch(type_hash) else ""
    data = data_key(int(domain), topic, MessageSupport(type_, type_hash).dds_name, type_hash)
    return Announcement(session, node, GraphEndpoint(role, node, topic, type_, known_hash, qos, gid_of(key)), data)


def gid_of(liveliness_key: str) -> bytes:
    """Return the unique id of the endpoint with a liveliness key: 16 bytes, the low 64 bits first."""
    return xxh3_128_intdigest(liveliness_key.encode()).to_bytes(16, "little")


def _mangled(name: str) -> str:
    return name.replace("/", "%") or "%"


def _demangled(text: str) -> str:
    return text.replace("%", "/")
