"""The text server's rules, byte for byte, without a socket."""

import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from thbridge.text_protocol.wire.lines import ROUTED, TextMessage
from thbridge.text_protocol.wire.notice_format import Notice, notice, parse_notice
from thbridge.text_protocol.wire.router import (
    ClientJoined,
    ClientLeft,
    CloseConnection,
    CloseReason,
    ConnectionId,
    Forwarded,
    LineSkipped,
    MessageRouter,
    NameTaken,
    RouterLimits,
    RouterOutput,
    SendToClient,
    TurnedAway,
)

ACK = b"%%ack \n"
PING = b"%%ping \n"
SHUTDOWN = b"%%sshhuuttddoowwnn \n"


class Room:
    """A router with people around it: what each connection was sent, and everything else that came out."""

    def __init__(self, limits: RouterLimits | None = None) -> None:
        self.router = MessageRouter(limits)
        self.now = 0.0
        self.sent: dict[ConnectionId, bytes] = {}
        self.closed: dict[ConnectionId, CloseReason] = {}
        self.forwarded: list[Forwarded] = []
        self.skipped: list[LineSkipped] = []
        self.presence: list[ClientJoined | ClientLeft] = []

    def enter(self, name: str = "") -> ConnectionId:
        """A new connection, registered if it has a name; its own registration's ack is swallowed."""
        connection = self.router.connect(self.now)
        assert not isinstance(connection, TurnedAway)
        self.sent[connection] = b""
        if name:
            self.says(connection, f"%%setid {name}\n".encode())
            assert self.hears(connection) == ACK
        return connection

    def says(self, connection: ConnectionId, data: bytes) -> None:
        self.take_in(self.router.receive_data(connection, data, self.now))

    def hears(self, connection: ConnectionId) -> bytes:
        """What a connection was sent since it was last asked."""
        data, self.sent[connection] = self.sent[connection], b""
        return data

    def waits(self, seconds: float) -> None:
        self.now += seconds
        self.take_in(self.router.advance(self.now))

    def take_in(self, outputs: list[RouterOutput]) -> None:
        for output in outputs:
            match output:
                case SendToClient(connection, data):
                    assert connection not in self.closed, "sent to a closed connection"
                    self.sent[connection] += data
                case CloseConnection(connection, reason):
                    self.closed[connection] = reason
                case Forwarded():
                    self.forwarded.append(output)
                case LineSkipped():
                    self.skipped.append(output)
                case ClientJoined() | ClientLeft():
                    self.presence.append(output)


# The server's own lines


@pytest.mark.parametrize(
    "line",
    [
        b"",
        b"   ",
        b"hello",
        b"%pong",
        b"%%pong",
        b"%%pong i am here too",
        b"%%ack",
        b"%%ack ",
        b"%%setid",
        b"%%send",
        b"%%send A B",
        b"%%send A B %%goto",
        b"%%goto",
        b"%%goto TabUI",
        b"%%goto TabUI nobody 0 3 3 45",
        b"%%send A B %%goto TabUI nobody 0 3 3 45",
        b"%%SETID A",
        b"%%pingpong",
        b"x%%ping",
        bytes(range(128, 256)),
        b"\x00\x01\x02\xff",
        b"\xef\xbb\xbf%%ping",
    ],
)
def test_any_line_gets_one_ack_and_nothing_else(line: bytes) -> None:
    room = Room()
    anyone = room.enter()
    room.says(anyone, line + b"\n")
    assert room.hears(anyone) == ACK
    assert not room.closed


def test_setid_is_acknowledged_and_the_name_receives() -> None:
    room = Room()
    hider, tabui = room.enter(), room.enter()
    room.says(hider, b"%%setid Hider\r\n")
    assert room.hears(hider) == ACK
    room.says(tabui, b"%%snap TabUI Hider 3\n")
    assert room.hears(hider) == b"%%snap TabUI Hider 3 \n"
    assert room.hears(tabui) == ACK


def test_a_held_name_turns_the_newcomer_out_and_the_holder_notices_nothing() -> None:
    room = Room()
    holder, newcomer = room.enter("TabUI"), room.enter()
    room.says(newcomer, b"%%setid TabUI\n%%ping\n")
    assert room.hears(newcomer) == SHUTDOWN
    assert room.closed == {newcomer: CloseReason.NAME_TAKEN}
    assert room.hears(holder) == b""
    room.says(holder, b"%%where TabUI TabUI\n")
    assert room.hears(holder) == b"%%where TabUI TabUI \n" + ACK


def test_a_client_may_say_its_own_name_again() -> None:
    room = Room()
    holder = room.enter("TabUI")
    room.says(holder, b"%%setid TabUI\n")
    assert room.hears(holder) == ACK


def test_a_new_name_frees_the_old_one() -> None:
    room = Room()
    client = room.enter("one")
    room.says(client, b"%%setid two\n")
    assert room.hears(client) == ACK
    room.enter("one")


def test_getid_gives_a_fresh_number_for_a_name() -> None:
    room = Room()
    room.enter("1")
    first, second = room.enter(), room.enter("two")
    room.says(first, b"%%getid\n")
    room.says(second, b"%%getid\n")
    assert room.hears(first) == b"%%setid 2\n" + ACK
    assert room.hears(second) == b"%%setid 3\n" + ACK
    room.says(first, b"%%error 2 3 hello\n")
    assert room.hears(second) == b"%%error 2 3 hello \n"
    room.enter("two")  # the name it had before is free


def test_ping_is_answered() -> None:
    room = Room()
    client = room.enter()
    room.says(client, b"%%ping\n")
    assert room.hears(client) == b"%%pong i am here\n" + ACK


def test_shutdown_closes_and_frees_the_name_at_once() -> None:
    room = Room()
    client = room.enter("SimR")
    room.says(client, b"%%sshhuuttddoowwnn\n%%ping\n")
    assert room.hears(client) == b""
    assert room.closed == {client: CloseReason.ASKED}
    room.enter("SimR")


def test_send_forwards_the_inner_message_to_the_inner_receiver() -> None:
    room = Room()
    sender, outer, inner = room.enter("A"), room.enter("B"), room.enter("D")
    room.says(sender, b'%%send A B  %%found C D  "3,Orange Bottle\n')
    assert room.hears(inner) == b'%%found C D "3,Orange Bottle \n'
    assert room.hears(outer) == b""
    assert room.hears(sender) == ACK


@pytest.mark.parametrize("command", sorted(ROUTED))
def test_routed_commands_are_forwarded_with_one_blank_before_the_line_end(command: str) -> None:
    room = Room()
    sender, receiver = room.enter("A"), room.enter("B")
    for sent, received in [
        (f"{command} A B one two\n", f"{command} A B one two \n"),
        (f"  {command}\tA  B   one  two   \r\n", f"{command} A B one two \n"),
        (f"{command} A B\n", f"{command} A B \n"),
    ]:
        room.says(sender, sent.encode())
        assert room.hears(receiver) == received.encode()
        assert room.hears(sender) == ACK


def test_the_ten_routed_commands() -> None:
    assert sorted(ROUTED) == [
        "%%error", "%%found", "%%goto", "%%hide", "%%image", "%%move", "%%pose", "%%score", "%%snap", "%%where",
    ]  # fmt: skip


def test_a_nameless_client_may_speak_and_nobody_checks_who_it_says_it_is() -> None:
    room = Room()
    receiver, nameless = room.enter("B"), room.enter()
    room.says(nameless, b"%%error Somebody B hello\n")
    assert room.hears(receiver) == b"%%error Somebody B hello \n"


def test_the_words_old_clients_look_for_are_in_no_line_of_the_server_by_accident() -> None:
    words = [b"ping", b"error", b"found", b"score", b"image", b"snap", b"goto", b"ack"]
    room = Room()
    client, holder = room.enter(), room.enter("A")
    room.says(client, b"%%getid\n%%ping\n%%setid A\n")
    lines = room.hears(client).split(b"\n")
    assert lines == [b"%%setid 1", b"%%ack ", b"%%pong i am here", b"%%ack ", b"%%sshhuuttddoowwnn ", b""]
    room.waits(15)
    lines += room.hears(holder).split(b"\n")
    for line in lines:
        assert [word for word in words if word in line and line.strip() != b"%%" + word] == []


def test_a_whole_hunt_as_the_old_programs_play_it() -> None:
    room = Room()
    tabui, simr, hider = room.enter("TabUI"), room.enter("SimR"), room.enter("Hider")
    for speaker, listener, sent, received in [
        (tabui, simr, b"%%goto TabUI SimR 0 3 3 45", b"%%goto TabUI SimR 0 3 3 45 "),
        (simr, tabui, b'%%error SimR TabUI "0;3"', b'%%error SimR TabUI "0;3" '),
        (tabui, hider, b'%%error TabUI Hider  "3"', b'%%error TabUI Hider "3" '),
        (
            hider,
            tabui,
            b'%%found Hider TabUI 3 3 "(Colour: Orange) (Footprint: Round and Large)"',
            b'%%found Hider TabUI 3 3 "(Colour: Orange) (Footprint: Round and Large)" ',
        ),
        (tabui, hider, b"%%snap TabUI Hider 3", b"%%snap TabUI Hider 3 "),
        (hider, tabui, b"%%image Hider TabUI 3 rsz_t1.jpg", b"%%image Hider TabUI 3 rsz_t1.jpg "),
        (tabui, hider, b'%%found TabUI Hider "3,Orange Bottle', b'%%found TabUI Hider "3,Orange Bottle '),
        (hider, tabui, b"%%score Hider TabUI ,10", b"%%score Hider TabUI ,10 "),
    ]:
        room.says(speaker, sent + b"\n")
        assert (room.hears(listener), room.hears(speaker)) == (received + b"\n", ACK)


# Segments


TRANSCRIPT = (
    b"%%setid A\n\r\n%%ping\nhello\n%%error A A caf\xc3\xa9 \xff\r\n%%send A B %%goto A A 0 3 3 45\n"
    b"%%getid\n%%goto A nobody 1\n" + b"x" * 200 + b"\n%%pong\n%%error 1 1 " + b"y" * 100 + b"\n"
)


def outputs_of(segments: list[bytes]) -> list[RouterOutput]:
    router = MessageRouter(RouterLimits(line=128))
    connection = router.connect(0.0)
    assert not isinstance(connection, TurnedAway)
    return [output for segment in segments for output in router.receive_data(connection, segment, 0.0)]


def test_byte_by_byte_gives_the_same_outputs() -> None:
    assert outputs_of([bytes([byte]) for byte in TRANSCRIPT]) == outputs_of([TRANSCRIPT])


@given(st.lists(st.integers(0, len(TRANSCRIPT)), max_size=12).map(sorted))
def test_any_segments_give_the_same_outputs(places: list[int]) -> None:
    starts, ends = [0, *places], [*places, len(TRANSCRIPT)]
    segments = [TRANSCRIPT[start:end] for start, end in zip(starts, ends, strict=True)]
    assert outputs_of(segments) == outputs_of([TRANSCRIPT])


def test_a_truncated_stream_gives_a_beginning_of_the_outputs() -> None:
    whole = outputs_of([TRANSCRIPT])
    for length in range(len(TRANSCRIPT)):
        part = outputs_of([TRANSCRIPT[:length]])
        assert part == whole[: len(part)]
        assert len(part) < len(whole)


@given(st.binary(max_size=300))
def test_noise_never_closes_a_connection_and_every_line_is_acknowledged(noise: bytes) -> None:
    room = Room()
    client = room.enter()
    noise = noise.replace(b"%%sshh", b"")
    room.says(client, noise + b"\n")
    assert not room.closed
    assert room.hears(client).count(ACK) == noise.count(b"\n") + 1


def test_a_line_too_long_is_skipped_told_and_acknowledged_like_an_unknown_one() -> None:
    room = Room()
    client = room.enter("A")
    for _ in range(16):
        room.says(client, b"x" * 65536)
        assert room.hears(client) == b""
    room.says(client, b"\n%%error A A still here\n")
    assert room.skipped == [LineSkipped(client, 1 << 20)]
    assert room.hears(client) == ACK + b"%%error A A still here \n" + ACK


def test_a_line_of_the_limit_is_forwarded_whole() -> None:
    room = Room()
    client = room.enter("A")
    line = b"%%error A A " + b"x" * (65536 - 12)
    room.says(client, line + b"\n")
    assert room.hears(client) == line + b" \n" + ACK
    assert not room.skipped


def test_a_line_cut_off_by_the_end_of_its_connection_is_not_obeyed() -> None:
    room = Room()
    client, simr = room.enter("TabUI"), room.enter("SimR")
    room.says(client, b"%%goto TabUI SimR 0 1")
    room.router.eof(client)
    assert room.hears(simr) == b""


# Connections and limits


def test_the_end_of_a_connection_frees_its_name() -> None:
    room = Room()
    client = room.enter("A")
    room.router.eof(client)
    room.router.eof(client)
    assert room.router.receive_data(client, b"%%ping\n", 0.0) == []
    assert room.router.report_backlog(client, 1 << 30) == []
    room.enter("A")


def test_one_client_too_many_is_turned_away_politely_and_comes_in_when_another_has_gone() -> None:
    room = Room()
    clients = [room.enter(f"client{number}") for number in range(256)]
    refusals = [room.router.connect(0.0) for _ in range(44)]
    assert refusals == [TurnedAway(SHUTDOWN)] * 44
    room.says(clients[0], b"%%error client0 client255 hello\n")
    assert room.hears(clients[255]) == b"%%error client0 client255 hello \n"
    room.router.eof(clients[7])
    room.enter("client7")


def test_who_has_no_name_and_says_nothing_makes_room_for_the_next() -> None:
    room = Room(RouterLimits(clients=4))
    tabui = room.enter("TabUI")
    idle = [room.enter() for _ in range(2)]
    room.now = 1.5
    busy = room.enter()
    room.now = 2.1
    for longest in idle:
        room.take_in(room.router.make_room(room.now))
        assert room.closed == {**room.closed, longest: CloseReason.IDLE}
        room.enter(f"SimR{longest}")
    # Whoever has a name, or spoke a moment ago, keeps the place.
    assert room.router.make_room(room.now) == []
    assert room.router.connect(room.now) == TurnedAway(SHUTDOWN)
    assert not {tabui, busy} & room.closed.keys()


def test_while_there_is_room_nobody_has_to_go() -> None:
    room = Room(RouterLimits(clients=4))
    room.enter()
    room.now = 10.0
    assert room.router.make_room(room.now) == []


def test_a_client_that_never_reads_is_cut_off_and_hurts_nobody() -> None:
    room = Room(RouterLimits(backlog=1000))
    deaf, other = room.enter("deaf"), room.enter("other")
    room.take_in(room.router.report_backlog(deaf, 1000))
    assert not room.closed
    room.take_in(room.router.report_backlog(deaf, 1001))
    assert room.closed == {deaf: CloseReason.SLOW}
    assert not CloseReason.SLOW.flush
    room.says(other, b"%%error other deaf hello\n")
    assert room.hears(other) == ACK


def test_silence_is_pinged_and_then_dropped() -> None:
    room = Room()
    client = room.enter("A")
    room.waits(14.9)
    assert room.hears(client) == b""
    room.waits(0.1)
    assert room.hears(client) == PING
    room.waits(14.9)
    assert (room.hears(client), room.closed) == (b"", {})
    room.waits(0.1)
    assert room.closed == {client: CloseReason.PING_UNANSWERED}
    room.enter("A")


@pytest.mark.parametrize("line", [b"%%pong\n", b"%pong\n", b"\n", b"\xff\n", b"%%goto TabUI nobody\n"])
def test_any_line_is_a_sign_of_life(line: bytes) -> None:
    room = Room()
    client = room.enter("A")
    room.waits(15)
    assert room.hears(client) == PING
    room.waits(14)
    room.says(client, line)
    assert room.hears(client) == ACK
    room.waits(14)
    assert (room.hears(client), room.closed) == (b"", {})
    room.waits(1)
    assert room.hears(client) == PING


def test_half_a_line_is_no_sign_of_life() -> None:
    room = Room()
    client = room.enter("A")
    for _ in range(30):
        room.waits(1)
        room.says(client, b"x")
    assert room.closed == {client: CloseReason.PING_UNANSWERED}


def test_a_stopping_server_tells_everyone_and_takes_on_nobody() -> None:
    room = Room()
    clients = [room.enter("A"), room.enter()]
    room.take_in(room.router.stop())
    assert [room.hears(client) for client in clients] == [SHUTDOWN, SHUTDOWN]
    assert room.closed == dict.fromkeys(clients, CloseReason.STOPPED)
    assert room.router.connect(0.0) == TurnedAway(SHUTDOWN)


# Taps


def test_a_tap_hears_what_is_forwarded_and_what_nobody_gets() -> None:
    room = Room()
    old, new = room.enter("old"), room.enter("new extended")
    room.says(old, b"%%error old new hello\nhello\n%%ping\n")
    room.says(new, b"%%send new x %%snap new nobody 3\n")
    assert room.forwarded == [
        Forwarded(TextMessage("%%error", "old", "new", ("hello",)), delivered=True, sender_extended=False),
        Forwarded(TextMessage("%%snap", "new", "nobody", ("3",)), delivered=False, sender_extended=True),
    ]


def test_a_recorder_hears_who_holds_which_name_and_until_when() -> None:
    room = Room()
    first = room.enter("A")
    room.says(first, b"%%getid\n%%setid 1 extended\n")
    second = room.enter("A")
    room.says(first, b"%%sshhuuttddoowwnn\n")
    room.take_in(room.router.eof(second))
    assert room.presence == [
        ClientJoined(first, "A", extended=False),
        ClientLeft(first, "A"),
        ClientJoined(first, "1", extended=False),
        ClientLeft(first, "1"),
        ClientJoined(first, "1", extended=True),
        ClientJoined(second, "A", extended=False),
        ClientLeft(first, "1"),
        ClientLeft(second, "A"),
    ]


# Extended clients


def test_an_extended_client_is_told_of_a_failed_delivery() -> None:
    room = Room()
    client = room.enter("TabUI extended")
    room.says(client, b"%%goto TabUI SimR 0 3 3 45\n")
    told, ack, end = room.hears(client).split(b"\n")
    assert (ack, end) == (b"%%ack ", b"")
    head, text = told.split(b"{")
    assert head == b"%%error Server TabUI thbridge "
    assert text.endswith(b"} ")
    assert json.loads(b"{" + text) == {
        "kind": "undelivered",
        "command": "%%goto",
        "receiver": "SimR",
        "content": "0 3 3 45",
        "reason": "no program has that name",
    }


def test_a_failed_notice_does_not_echo() -> None:
    room = Room()
    client = room.enter("SimR extended")
    room.says(client, (notice("SimR", "TabUI", "pose", robot=0).line() + "\n").encode())
    assert room.hears(client) == ACK


def test_a_notice_is_withheld_from_a_client_of_2016() -> None:
    room = Room()
    new, newer, old = room.enter("new extended"), room.enter("newer extended"), room.enter("old")
    for receiver, is_told in [("newer", newer), ("old", old)]:
        line = notice("new", receiver, "pose", robot=0).line().encode() + b"\n"
        room.says(new, line)
        assert room.hears(is_told) == (line if receiver == "newer" else b"")
        assert room.hears(new) == ACK
    assert [forwarded.delivered for forwarded in room.forwarded] == [True, False]


def test_what_looks_like_a_notice_from_a_client_of_2016_is_forwarded_as_in_2016() -> None:
    room = Room()
    sender, receiver = room.enter("A"), room.enter("B")
    room.says(sender, b'%%error A B thbridge {"kind":"pose"}\n')
    assert room.hears(receiver) == b'%%error A B thbridge {"kind":"pose"} \n'


@pytest.mark.parametrize("as_what", ["Forger", "Forger extended"])
def test_a_notice_in_the_name_of_another_program_reaches_none_of_ours(as_what: str) -> None:
    room = Room()
    forger, ours, old = room.enter(as_what), room.enter("B extended"), room.enter("C")
    for receiver in ("B", "C"):
        room.says(forger, b"%%error SimR " + receiver.encode() + b' thbridge {"kind":"Status"}\n')
    assert room.hears(ours) == b""
    assert room.hears(old) == (b"" if "extended" in as_what else b'%%error SimR C thbridge {"kind":"Status"} \n')


def test_other_extra_tokens_of_a_setid_mean_nothing() -> None:
    room = Room()
    client = room.enter("TabUI Extended extended")
    room.says(client, b"%%goto TabUI SimR 0 3 3 45\n")
    assert room.hears(client) == ACK


def test_an_extended_client_replaces_a_holder_that_left_a_ping_unanswered() -> None:
    room = Room()
    holder = room.enter("SimR")
    room.waits(15)
    assert room.hears(holder) == PING
    room.enter("SimR extended")
    assert room.closed == {holder: CloseReason.REPLACED}


def test_an_extended_client_does_not_replace_a_living_holder() -> None:
    room = Room()
    room.enter("SimR extended mine")
    room.waits(10)
    for line in [b"%%setid SimR extended\n", b"%%setid SimR extended yours\n", b"%%setid SimR mine\n"]:
        newcomer = room.enter()
        room.says(newcomer, line)
        assert room.hears(newcomer) == SHUTDOWN
        assert room.closed.popitem() == (newcomer, CloseReason.NAME_TAKEN)


def test_a_client_of_2016_never_replaces_anybody() -> None:
    room = Room()
    room.enter("SimR extended mine")
    room.waits(15)
    newcomer = room.enter()
    room.says(newcomer, b"%%setid SimR\n")
    assert room.closed == {newcomer: CloseReason.NAME_TAKEN}


def test_a_program_replaces_its_own_lost_connection_at_once() -> None:
    room = Room()
    lost = room.enter("SimR extended mine")
    found = room.enter("SimR extended mine")
    assert room.closed == {lost: CloseReason.REPLACED}
    assert not CloseReason.REPLACED.flush
    speaker = room.enter()
    room.says(speaker, b"%%where TabUI SimR 0\n")
    assert room.hears(found) == b"%%where TabUI SimR 0 \n"


# Local endpoints


def test_local_endpoints_hear_in_the_next_exchange_what_was_said_in_this_one() -> None:
    router = MessageRouter()
    assert router.local.attach("SimR") is None
    assert router.local.attach("TabUI") is None
    question, answer = TextMessage("%%where", "TabUI", "SimR", ("0",)), TextMessage("%%pose", "SimR", "TabUI", ("0",))
    router.local.submit("TabUI", question)
    assert router.local.take("SimR") == []
    assert router.exchange() == [Forwarded(question, delivered=True, sender_extended=True)]
    assert router.local.take("SimR") == [question]
    assert router.local.take("SimR") == []
    router.local.submit("SimR", answer)
    assert router.local.take("TabUI") == []
    router.exchange()
    assert router.local.take("TabUI") == [answer]


def test_connections_and_local_endpoints_talk_under_the_same_rules() -> None:
    room = Room()
    router = room.router
    tabui = room.enter("TabUI")
    router.local.attach("SimR")
    room.says(tabui, b"%%send TabUI SimR %%goto TabUI SimR 0  3 3 45\n")
    assert room.hears(tabui) == ACK
    assert router.local.take("SimR") == []
    room.take_in(router.exchange())
    assert router.local.take("SimR") == [TextMessage("%%goto", "TabUI", "SimR", ("0", "3", "3", "45"))]
    router.local.submit("SimR", TextMessage("%%error", "SimR", "TabUI", ('"0;3"',)))
    room.take_in(router.exchange())
    assert room.hears(tabui) == b'%%error SimR TabUI "0;3" \n'
    router.local.submit("SimR", notice("SimR", "TabUI", "pose"))
    room.take_in(router.exchange())
    assert room.hears(tabui) == b""


def test_a_local_endpoint_is_told_of_a_failed_delivery() -> None:
    router = MessageRouter()
    router.local.attach("SimR")
    message = TextMessage("%%error", "SimR", "TabUI", ('"0;3"',))
    router.local.submit("SimR", message)
    assert router.exchange() == [Forwarded(message, delivered=False, sender_extended=True)]
    (told,) = router.local.take("SimR")
    parsed = parse_notice(told)
    assert isinstance(parsed, Notice)
    assert (parsed.kind, parsed.fields["receiver"]) == ("undelivered", "TabUI")


def test_a_name_is_held_once_by_connections_and_local_endpoints_together() -> None:
    room = Room()
    room.enter("TabUI")
    assert room.router.local.attach("TabUI") == NameTaken("TabUI")
    assert room.router.local.attach("SimR") is None
    assert room.router.local.attach("SimR") == NameTaken("SimR")
    newcomer = room.enter()
    room.says(newcomer, b"%%setid SimR extended token\n")
    assert room.closed == {newcomer: CloseReason.NAME_TAKEN}
    room.router.local.detach("SimR")
    room.enter("SimR")


def test_a_local_endpoint_is_not_watched_for_life() -> None:
    room = Room()
    room.router.local.attach("Game")
    room.waits(1000)
    room.router.local.submit("Game", TextMessage("%%error", "Game", "Game", ("alive",)))
    room.take_in(room.router.exchange())
    assert room.router.local.take("Game") == [TextMessage("%%error", "Game", "Game", ("alive",))]


def test_what_waits_for_a_local_endpoint_is_bounded() -> None:
    room = Room(RouterLimits(backlog=100))
    client = room.enter("A")
    room.router.local.attach("B")
    room.says(client, b"%%error A B hello\n" * 10)
    assert [forwarded.delivered for forwarded in room.forwarded] == [True] * 5 + [False] * 5
    room.router.exchange()
    assert len(room.router.local.take("B")) == 5
    room.says(client, b"%%error A B hello\n" * 6)
    assert [forwarded.delivered for forwarded in room.forwarded[10:]] == [True] * 5 + [False]


def test_the_order_in_which_local_endpoints_take_turns_is_the_order_of_what_they_said() -> None:
    def run(order: list[str]) -> list[TextMessage]:
        router = MessageRouter()
        for name in ["a", "b", "z"]:
            router.local.attach(name)
        for name in order:
            router.local.submit(name, TextMessage("%%error", name, "z", ("hello",)))
        router.exchange()
        return router.local.take("z")

    assert [message.sender for message in run(["a", "b", "a"])] == ["a", "b", "a"]
    assert [message.sender for message in run(["b", "a"])] == ["b", "a"]


def test_an_endpoint_needs_a_name_of_one_token() -> None:
    with pytest.raises(ValueError, match="not one token"):
        MessageRouter().local.attach("two words")
    with pytest.raises(KeyError):
        MessageRouter().local.submit("nobody", TextMessage("%%where", "nobody", "SimR"))
