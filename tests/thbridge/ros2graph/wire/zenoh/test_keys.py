"""Keys of rmw_zenoh: what we write is what its design document shows, and hostile keys are no announcements."""

import string

from hypothesis import example, given
from hypothesis import strategies as st

from thbridge.ros2.qos import LATCHED, QosProfile
from thbridge.ros2.supports import MessageSupport
from thbridge.ros2graph.values.graph import EndpointRole, GraphEndpoint, NodeName
from thbridge.ros2graph.wire.zenoh.keys import (
    LONGEST_KEY,
    Announcement,
    SessionKeys,
    data_key,
    gid_of,
    graph_key,
    read_liveliness_key,
)

HASH = "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18"
STRING = MessageSupport("std_msgs/msg/String", HASH)
SESSION = "aac3178e146ba6f1fc6e6a4085e77f21"
LISTENER = (
    f"@ros2_lv/2/{SESSION}/0/10/MS/%/%/listener/%chatter/std_msgs::msg::dds_::String_/{HASH}/::,10:,:,:,,"  # design.md
)

words = st.text(string.ascii_letters + "_", min_size=1, max_size=8)
names = st.lists(words, min_size=1, max_size=4).map(lambda parts: "".join(f"/{part}" for part in parts))
nodes = st.builds(NodeName, st.just("/") | names, words)


def test_keys_of_the_design_document():
    keys = SessionKeys(2, SESSION)
    found = keys.endpoint(
        0, 10, NodeName("/", "listener"), EndpointRole.SUBSCRIPTION, "/chatter", STRING.dds_name, HASH, QosProfile()
    )
    assert found.liveliness == LISTENER
    assert found.data == f"2/chatter/std_msgs::msg::dds_::String_/{HASH}"
    assert keys.node(1, NodeName("/robot1/nav", "amcl")) == f"@ros2_lv/2/{SESSION}/1/1/NN/%/%robot1%nav/amcl"
    assert graph_key(2) == "@ros2_lv/2/**"


def test_gid_is_the_hash_with_the_low_half_first():
    # Test vector of xxHash for the empty text: 99aa06d3014798d8 is the high half.
    assert gid_of("") == bytes.fromhex("99aa06d3014798d86001c324468d497f")[::-1]


def test_the_key_of_the_design_document_is_read():
    node = NodeName("/", "listener")
    endpoint = GraphEndpoint(
        EndpointRole.SUBSCRIPTION, node, "/chatter", STRING.name, HASH, QosProfile(), gid_of(LISTENER)
    )
    data = data_key(2, "/chatter", STRING.dds_name, HASH)
    assert read_liveliness_key(LISTENER) == Announcement(SESSION, node, endpoint, data)


@given(
    nodes,
    st.sampled_from(EndpointRole),
    names,
    st.tuples(words, st.sampled_from(["msg", "srv", "action"]), words).map("/".join),
    st.sampled_from([QosProfile(), LATCHED]),
)
def test_written_keys_are_read_as_what_was_written(node, role, name, type_, qos):
    keys = SessionKeys(7, SESSION).endpoint(1, 2, node, role, name, MessageSupport(type_, HASH).dds_name, HASH, qos)
    assert read_liveliness_key(keys.liveliness) == Announcement(
        SESSION, node, GraphEndpoint(role, node, name, type_, HASH, qos, keys.gid), keys.data
    )


@given(nodes)
def test_written_keys_of_nodes_are_read(node):
    assert read_liveliness_key(SessionKeys(0, "1").node(3, node)) == Announcement("1", node, None, "")


def test_a_type_without_a_hash_is_known_and_matches_only_itself():
    found = read_liveliness_key(LISTENER.replace(HASH, "TypeHashNotSupported"))
    assert found is not None and found.endpoint is not None
    assert found.endpoint.hash == ""
    assert found.data.endswith("/TypeHashNotSupported")


@given(st.text(max_size=300) | st.text("@ros2_lv/%:,0123NMPSC*$#?", max_size=300))
@example("@ros2_lv/2/1/1/1/NN/%/%/a/b")
@example(LISTENER.replace("/MS/", "/XX/"))
@example(LISTENER.replace("/MS/", "/NN/"))
@example(LISTENER.replace("%chatter", "chatter"))
@example(LISTENER.replace("%chatter", "%"))
@example(LISTENER.replace("%chatter", "%chatter" * LONGEST_KEY))
@example(LISTENER.replace("listener", "lis\ntener"))
@example(LISTENER.replace("listener", "ü"))
@example(LISTENER.replace("std_msgs::msg::dds_::String_", "std_msgs::msg::String"))
@example(LISTENER.replace("::,10", "9::,10"))
@example(LISTENER.replace("::,10", "::,99999999999"))
@example(LISTENER + "\n")
@example(LISTENER.replace("@ros2_lv", "@other"))
def test_hostile_keys_announce_nothing(key):
    assert read_liveliness_key(key) is None


@given(st.integers(0, len(LISTENER) - 1), st.characters(codec="ascii"))
def test_a_changed_character_never_raises(at, character):
    read_liveliness_key(LISTENER[:at] + character + LISTENER[at + 1 :])
