"""Our own programs' side of the protocol, without a socket."""

import pytest

from thbridge.line_splitter import OverlongLine
from thbridge.text_protocol.wire.client import (
    ClientSession,
    ClosedByServer,
    NameRegistered,
    SendToServer,
    ServerCloseReason,
)
from thbridge.text_protocol.wire.lines import TextMessage

SHUTDOWN = b"%%sshhuuttddoowwnn \n"
ARRIVED = TextMessage("%%error", "SimR", "TabUI", ('"0;3"',))


def session() -> ClientSession:
    return ClientSession("TabUI", "t0ken")


def registered() -> ClientSession:
    client = session()
    client.receive_data(b"%%ack \n")
    return client


def test_it_registers_as_an_extended_client() -> None:
    assert session().hello == b"%%setid TabUI extended t0ken\n"


def test_the_first_ack_means_registered_and_later_ones_nothing() -> None:
    assert session().receive_data(b"%%ack \n%%ack \n") == [NameRegistered()]


def test_a_farewell_before_the_first_ack_is_a_refusal() -> None:
    assert session().receive_data(SHUTDOWN + b"%%ping \n") == [ClosedByServer(ServerCloseReason.REFUSED)]


def test_a_farewell_after_it_is_the_end_of_the_server() -> None:
    client = registered()
    assert client.receive_data(SHUTDOWN) == [ClosedByServer(ServerCloseReason.STOPPED)]
    assert client.receive_data(b"%%ping \n" + SHUTDOWN) == []


def test_a_ping_is_answered() -> None:
    assert registered().receive_data(b"%%ping \n") == [SendToServer(b"%%pong \n")]


def test_messages_come_through_and_the_servers_own_lines_do_not() -> None:
    data = b'%%pong i am here\n%%error SimR TabUI "0;3" \n%%setid 3\nhello\n\n%%ack \n'
    assert registered().receive_data(data) == [ARRIVED]


@pytest.mark.parametrize("line", [b"%%sshhuuttddoowwnn A TabUI \n", b"%%ping A TabUI \n", b"%%ack A TabUI \n"])
def test_a_forwarded_line_cannot_pass_for_the_servers_own(line: bytes) -> None:
    assert session().receive_data(line) == []


def test_segments_make_no_difference() -> None:
    data = b'%%ack \r\n%%error SimR TabUI "0;3" \n%%ping \n' + b"x" * 70_000 + b"\n" + SHUTDOWN
    whole = session().receive_data(data)
    client = session()
    assert [event for byte in data for event in client.receive_data(bytes([byte]))] == whole
    assert whole == [
        NameRegistered(),
        ARRIVED,
        SendToServer(b"%%pong \n"),
        OverlongLine(70_000),
        ClosedByServer(ServerCloseReason.STOPPED),
    ]


@pytest.mark.parametrize(("name", "token"), [("two words", "t"), ("", "t"), ("A", ""), ("A", "a b"), ("A\n", "t")])
def test_a_name_or_token_that_would_break_the_line_is_refused(name: str, token: str) -> None:
    with pytest.raises(ValueError, match="one word"):
        ClientSession(name, token)
