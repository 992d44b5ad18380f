"""The XML-RPC codec: what it writes, its peers read; what it cannot read, it says so."""

import math
import xmlrpc.client

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from thbridge.rosgraph.wire import xmlrpc as ours
from thbridge.rosgraph.wire.xmlrpc import DateTime, Fault, MalformedDocument, MethodCall, MethodResponse

# Every character of XML 1.0.
text = st.text(st.characters(exclude_categories=["Cs", "Cc"], exclude_characters="\ufffe\uffff", codec="utf-8")) | (
    st.text("\t\n\r <>&'\"]")
)
leaves = st.booleans() | st.integers(-(2**63), 2**63 - 1) | st.floats(allow_nan=False) | text | st.binary() | st.none()
values = st.recursive(leaves, lambda inner: st.lists(inner) | st.dictionaries(text, inner), max_leaves=20)


def response(inner: str) -> bytes:
    return f"<methodResponse><params><param>{inner}</param></params></methodResponse>".encode()


@given(values)
def test_values_survive_the_way_there_and_back(value):
    back = ours.decode_response(ours.encode_response(value))
    assert back == MethodResponse(value)
    assert repr(back) == repr(MethodResponse(value))  # True is no 1


@given(text.map(str.strip).filter(bool), st.lists(values))
def test_calls_survive_too(method, params):
    assert ours.decode_call(ours.encode_call(method, params)) == MethodCall(method, params)


@given(values)
def test_pythons_own_client_reads_what_we_write(value):
    (theirs,), _ = xmlrpc.client.loads(ours.encode_response(value), use_builtin_types=True)
    assert theirs == value


@given(values.filter(lambda value: "\\r" not in repr(value)))
def test_we_read_what_pythons_own_client_writes(value):
    try:
        written = xmlrpc.client.dumps((value,), methodresponse=True, allow_none=True)
    except OverflowError:  # it reads i8 but does not write it
        return
    assert ours.decode_response(written.encode()) == MethodResponse(value)


def test_special_doubles():
    for value in (math.inf, -math.inf):
        assert ours.decode_response(ours.encode_response(value)) == MethodResponse(value)
    nan = ours.decode_response(ours.encode_response(math.nan))
    assert isinstance(nan, MethodResponse) and isinstance(nan.value, float) and math.isnan(nan.value)


def test_faults_are_told_from_answers():
    assert ours.decode_response(ours.encode_fault(-5, "no <such> thing")) == Fault(-5, "no <such> thing")


@pytest.mark.parametrize(
    ("written", "value"),
    [
        ("<value>/rosout</value>", "/rosout"),
        ("<value> two words </value>", " two words "),
        ("<value></value>", ""),
        ("<value/>", ""),
        ("\r\n\t<value>\n <i4> 7 </i4>\n</value> ", 7),
        ("<value><int>-7</int></value>", -7),
        ("<value><i8>4294967296</i8></value>", 2**32),
        ("<value><boolean>1</boolean></value>", True),
        ("<value><double>1e-05</double></value>", 1e-5),
        ("<value><nil/></value>", None),
        ("<value><ex:nil xmlns:ex='http://ws.apache.org/xmlrpc/namespaces/extensions'/></value>", None),
        ("<value><base64>\nAAEC\nAw==\n</base64></value>", b"\0\1\2\3"),
        ("<value><string><![CDATA[a<b]]></string></value>", "a<b"),
        ("<value><dateTime.iso8601>19980717T14:08:55</dateTime.iso8601></value>", DateTime("19980717T14:08:55")),
        ("<value><array><data> </data></array></value>", []),
        ("<value><struct></struct></value>", {}),
        ("<value><struct><member><name>a</name><value>b</value></member></struct></value>", {"a": "b"}),
    ],
)
def test_what_ros_nodes_write_is_read(written, value):
    assert ours.decode_response(response(written)) == MethodResponse(value)


@pytest.mark.parametrize(
    "data",
    [
        b"",
        b"GET / HTTP/1.1",
        b"<methodResponse>",
        b"<methodCall><methodName>x</methodName></methodCall>",
        response(""),
        response("<value>a</value></param><param><value>b</value>"),
        response("<value><int>1</int><int>2</int></value>"),
        response("<value>x<int>1</int></value>"),
        response("<value><int>1_0</int></value>"),
        response("<value><int>9223372036854775808</int></value>"),
        response(f"<value><int>{'9' * 100_000}</int></value>"),
        response("<value><boolean>yes</boolean></value>"),
        response("<value><double>1_0.0</double></value>"),
        response("<value><double></double></value>"),
        response("<value><base64>!!</base64></value>"),
        response("<value><frob/></value>"),
        response("<value><array><value>a</value></array></value>"),
        response("<value><struct><member><value>a</value></member></struct></value>"),
        b"<methodResponse><fault><value>no</value></fault></methodResponse>",
        b"<?xml version='1.0' encoding='no-such'?><methodResponse/>",
        b"<?xml version='1.0' encoding='shift_jis'?><methodResponse/>",
        "<?xml version='1.0' encoding='ascii'?><methodResponse>é</methodResponse>".encode(),
    ],
)
def test_what_is_no_answer_is_malformed(data):
    found = ours.decode_response(data)
    assert isinstance(found, MalformedDocument) and found.reason


def test_bombs_do_not_go_off():
    laughs = "".join(f'<!ENTITY l{i + 1} "{f"&l{i};" * 10}">' for i in range(9))
    doctype = f'<!DOCTYPE bomb [<!ENTITY l0 "ha">{laughs}]>'
    assert isinstance(ours.decode_response(doctype.encode() + response("<value>&l9;</value>")), MalformedDocument)
    outside = b'<!DOCTYPE x [<!ENTITY e SYSTEM "file:///etc/passwd">]>' + response("<value>&e;</value>")
    assert isinstance(ours.decode_response(outside), MalformedDocument)


def test_limits(monkeypatch):
    def nested(levels: int) -> bytes:
        return response(f"{'<value><array><data>' * levels}{'</data></array></value>' * levels}")

    assert isinstance(ours.decode_response(nested(ours.MAX_DEPTH - 1)), MethodResponse)
    assert isinstance(ours.decode_response(nested(ours.MAX_DEPTH + 1)), MalformedDocument)
    assert isinstance(ours.decode_response(nested(50_000)), MalformedDocument)
    assert isinstance(ours.decode_response(b"<a>" * 100_000), MalformedDocument)
    monkeypatch.setattr(ours, "MAX_ELEMENTS", 100)
    assert isinstance(
        ours.decode_response(response(f"<value><array><data>{'<value/>' * 100}</data></array></value>")),
        MalformedDocument,
    )
    monkeypatch.setattr(ours, "MAX_BYTES", 100)
    assert isinstance(ours.decode_response(response(f"<value>{'a' * 100}</value>")), MalformedDocument)


def test_what_xml_cannot_hold_is_replaced():
    assert ours.decode_response(ours.encode_response("a\0b\ud800c")) == MethodResponse("a\ufffdb\ufffdc")


def test_what_cannot_be_written_is_a_bug_of_the_caller():
    with pytest.raises(ValueError, match="64 bits"):
        ours.encode_response(2**63)
    deep: ours.XmlRpcValue = 1
    for _ in range(ours.MAX_DEPTH):
        deep = [deep]
    with pytest.raises(ValueError, match="deeper"):
        ours.encode_response(deep)
    with pytest.raises(ValueError, match="longer"):
        ours.encode_response(["x" * 2**20] * 17)


def test_a_fault_can_always_be_written():
    fault = ours.decode_response(ours.encode_fault(1, "&" * 20_000_000))
    assert isinstance(fault, Fault) and fault.text == "&" * 10_000


traffic = [
    ours.encode_call("registerPublisher", ["/talker", "/chatter", "std_msgs/String", "http://localhost:1/"]),
    ours.encode_response([1, "current system state", [[["/chatter", ["/talker"]]], [], []]]),
    ours.encode_fault(1, "wrong"),
    ours.encode_response({"a": [1.5, None, b"xyz", True], "b": {"c": DateTime("x")}}),
]


@given(st.binary() | st.text().map(str.encode))
@example(b"\xff\xfe<\x00")
def test_arbitrary_bytes_are_read_or_malformed(data):
    assert isinstance(ours.decode_call(data), MethodCall | MalformedDocument)
    assert isinstance(ours.decode_response(data), MethodResponse | Fault | MalformedDocument)


@given(st.sampled_from(traffic), st.data())
def test_spoilt_traffic_is_read_or_malformed(data, draw):
    spoilt = bytearray(data)
    for _ in range(draw.draw(st.integers(1, 4))):
        at = draw.draw(st.integers(0, len(spoilt)))
        cut = draw.draw(st.integers(0, 20))
        put = draw.draw(
            st.binary(max_size=8) | st.sampled_from([b"<value>", b"</value>", b"<nil/>", b"&lt;", b"<!DOCTYPE a>"])
        )
        spoilt[at : at + cut] = put
    assert isinstance(ours.decode_call(bytes(spoilt)), MethodCall | MalformedDocument)
    assert isinstance(ours.decode_response(bytes(spoilt)), MethodResponse | Fault | MalformedDocument)
