"""Files of a vehicle as stations read them, told from the payloads' bytes."""

import random
import struct
import zlib

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.support.mavlink.model_robot import AT_REST
from tests.support.mavlink.vehicle_with_stations import HERE, THEM, THERE, US, messages
from thbridge.mavlink.vehicle.component_files.file_transfer import PIECES_PER_TICK, FileTransfer
from thbridge.mavlink.vehicle.component_files.metadata_files import checksum
from thbridge.mavlink.wire.dialect import decoded, mav, payload_of

HEAD = struct.Struct("<HBBBBBBI")
TERMINATE, RESET, LIST, OPEN, READ, CRC, BURST = 1, 2, 3, 4, 5, 14, 15
ACK, NAK = 128, 129
FAULTY_SIZE, NO_SESSION, NO_ROOM, END, UNKNOWN, PROTECTED, NOT_FOUND = 3, 4, 5, 6, 7, 9, 10
MOST = 239

LONG = bytes(n * 7 % 251 for n in range(5000))
FILES = {"short.json": b"{}", "long.json": LONG}
SECOND = 50


class Told:
    """An answer, taken apart."""

    def __init__(self, message):
        payload = bytes(message.payload)
        head = HEAD.unpack_from(payload)
        self.sequence, self.session, self.opcode, self.size, self.asked, self.ends, _, self.offset = head
        self.data = payload[HEAD.size : HEAD.size + self.size]
        self.target = message.target_system, message.target_component

    @property
    def error(self):
        assert self.opcode == NAK
        assert self.size == 1
        return self.data[0]


class Bench:
    """The files of system 3, and whoever asks for them."""

    def __init__(self):
        self.server = FileTransfer(lambda: FILES)
        self.tick = 0

    def asks(self, sequence, opcode, data=b"", session=0, size=None, offset=0, station=US, link=HERE, system=3):
        said = HEAD.pack(sequence, session, opcode, len(data) if size is None else size, 0, 0, 0, offset) + data
        return self.sends(said, station, link, system)

    def sends(self, payload, station=US, link=HERE, system=3):
        message = mav.MAVLink_file_transfer_protocol_message(0, system, 1, list(payload.ljust(251, b"\0")))
        again = decoded(message.get_msgId(), payload_of(message))
        said = list(self.server.handle_message(link, station, again))
        assert all(word.link == link for word in said)
        return [Told(message) for message in messages(said)]

    def run(self, ticks=1):
        said = []
        for _ in range(ticks):
            self.tick += 1
            pieces = list(self.server.step(self.tick, AT_REST))
            assert len(pieces) <= PIECES_PER_TICK
            for word in pieces:
                payload_of(word.message)
            said += pieces
        return said

    def hears(self, ticks, link=HERE):
        return [Told(word.message) for word in self.run(ticks) if word.link == link]

    def opens(self, name=b"long.json", sequence=1, **who):
        (told,) = self.asks(sequence, OPEN, name, **who)
        assert told.opcode == ACK
        return told.session


@pytest.fixture
def bench():
    return Bench()


@pytest.mark.parametrize("name", [b"long.json", b"/long.json", b"long.json\0", b"/long.json\0rest"])
def test_a_file_is_opened_and_read_by_any_spelling_of_its_name(bench, name):
    (told,) = bench.asks(7, OPEN, name)
    assert (told.sequence, told.opcode, told.asked, told.target) == (8, ACK, OPEN, (US.system, US.component))
    assert int.from_bytes(told.data, "little") == len(LONG)
    (told,) = bench.asks(9, READ, session=told.session, size=100, offset=4950)
    assert (told.sequence, told.opcode, told.asked, told.offset) == (10, ACK, READ, 4950)
    assert told.data == LONG[4950:]  # no more than there is
    (told,) = bench.asks(11, READ, session=told.session, size=0, offset=10)
    assert told.data == LONG[10 : 10 + MOST], "as mavros asks"


@pytest.mark.parametrize("name", [b"none.json", b"../long.json", b"", b"\xff\xfe", b"@PARAM/param.pck?withdefaults=1"])
@pytest.mark.parametrize("opcode", [OPEN, CRC])
def test_what_is_not_there_is_not_found(bench, name, opcode):
    (told,) = bench.asks(1, opcode, name)
    assert (told.error, told.asked) == (NOT_FOUND, opcode)


@pytest.mark.parametrize("opcode", [READ, BURST])
def test_there_is_nothing_past_the_end_and_nothing_without_a_session(bench, opcode):
    session = bench.opens()
    for offset in (len(LONG), 0xFFFFFFFF):
        (told,) = bench.asks(3, opcode, session=session, size=MOST, offset=offset)
        assert (told.error, told.offset) == (END, offset)
    (told,) = bench.asks(5, opcode, session=session + 1, size=MOST)
    assert told.error == NO_SESSION


def test_sizes_that_make_no_sense_are_refused(bench):
    session = bench.opens()
    for opcode, size in ((READ, 240), (BURST, 255), (OPEN, 240), (LIST, 255)):
        (told,) = bench.asks(3, opcode, session=session, size=size)
        assert told.error == FAULTY_SIZE


@pytest.mark.parametrize("opcode", [6, 7, 8, 9, 10, 11, 12, 13])
def test_nothing_can_be_written(bench, opcode):
    (told,) = bench.asks(1, opcode, b"long.json")
    assert (told.error, told.asked) == (PROTECTED, opcode)


@pytest.mark.parametrize("opcode", [16, 77, 127])
def test_what_is_no_command_is_called_so(bench, opcode):
    (told,) = bench.asks(1, opcode, b"long.json")
    assert told.error == UNKNOWN


def test_answers_are_not_answered_and_nothing_comes_for_all(bench):
    assert bench.asks(1, ACK) == bench.asks(2, NAK, b"\1") == bench.asks(3, OPEN, b"long.json", system=0) == []


def test_a_directory_is_listed_with_sizes_from_an_offset_on(bench):
    (told,) = bench.asks(1, LIST, b"/")
    assert told.data == b"Fshort.json\t2\0Flong.json\t5000\0"
    (told,) = bench.asks(3, LIST, b"/", offset=1)
    assert told.data == b"Flong.json\t5000\0"
    (told,) = bench.asks(5, LIST, b"/", offset=2)
    assert told.error == END
    (told,) = bench.asks(7, LIST, b"/elsewhere")
    assert told.error == NOT_FOUND


def test_a_list_that_just_goes_in_comes_whole(bench):
    around = len(b"F\t1\0")
    bench.server = FileTransfer(lambda: {"a" * 100: b"x", "b" * (MOST - 100 - 2 * around): b"x"})
    (told,) = bench.asks(1, LIST, b"/")
    assert (told.size, told.data.count(b"\0")) == (MOST, 2)


def test_a_long_list_comes_in_parts(bench):
    many = {f"{number:030}": b"x" for number in range(20)}
    bench.server = FileTransfer(lambda: many)
    listed, sequence = [], 1
    while (told := bench.asks(sequence, LIST, b"/", offset=len(listed))[0]).opcode == ACK:
        listed += [entry[1:].partition(b"\t")[0].decode() for entry in told.data.split(b"\0")[:-1]]
        sequence += 2
    assert listed == [*many]
    assert told.error == END


def test_the_checksum_begins_with_zero_and_is_not_inverted(bench):
    (told,) = bench.asks(1, CRC, b"long.json")
    assert int.from_bytes(told.data, "little") == checksum(LONG)
    assert checksum(b"") == 0
    assert checksum(b"123456789") == 0x2DFD2D88
    assert checksum(b"\0" * 8 + LONG) == checksum(LONG) != zlib.crc32(LONG)


def test_a_burst_is_a_whole_file_in_order_a_few_pieces_a_tick(bench):
    session = bench.opens()
    assert bench.asks(65534, BURST, session=session, size=100, offset=1000) == []
    pieces = bench.hears(5)
    assert len(pieces) == 5 * PIECES_PER_TICK
    pieces += bench.hears(SECOND)
    assert [piece.sequence for piece in pieces] == [(65535 + n) % 65536 for n in range(40)]
    assert b"".join(piece.data for piece in pieces) == LONG[1000:]
    assert [piece.offset for piece in pieces] == list(range(1000, 5000, 100))
    assert [piece.ends for piece in pieces] == [0] * 39 + [1]
    assert {(piece.opcode, piece.asked, piece.session) for piece in pieces} == {(ACK, BURST, session)}


def test_a_burst_can_be_begun_again_and_leaves_the_size_to_us(bench):
    session = bench.opens()
    bench.asks(3, BURST, session=session, size=0, offset=0)
    before = bench.hears(2)
    bench.asks(3, BURST, session=session, size=0, offset=0)
    again = bench.hears(SECOND)
    assert [piece.data for piece in again[: len(before)]] == [piece.data for piece in before]
    assert again[0].sequence == before[0].sequence == 4
    assert again[0].size == MOST
    assert b"".join(piece.data for piece in again) == LONG


@pytest.mark.parametrize("end", [TERMINATE, RESET])
def test_a_burst_ends_with_its_session(bench, end):
    session = bench.opens()
    bench.asks(3, BURST, session=session, size=10)
    assert bench.hears(1)
    (told,) = bench.asks(5, end, session=session)
    assert told.opcode == ACK
    assert bench.hears(SECOND) == []
    (told,) = bench.asks(7, READ, session=session, size=10)
    assert told.error == NO_SESSION


def test_bursts_take_turns(bench):
    for sequence, link in ((1, HERE), (1, THERE)):
        session = bench.opens(sequence=sequence, link=link)
        bench.asks(3, BURST, session=session, size=MOST, link=link)
    first = bench.run(4)
    assert [word.link for word in first] == [HERE, THERE] * 6
    assert len(first) + len(bench.run(SECOND)) == 2 * 21


def test_the_same_request_again_gets_the_same_answer(bench):
    (first,) = bench.asks(1, OPEN, b"long.json")
    (again,) = bench.asks(1, OPEN, b"long.json")
    assert (again.sequence, again.session) == (first.sequence, first.session)
    for _ in range(2):
        (told,) = bench.asks(5, TERMINATE, session=first.session)
        assert told.opcode == ACK
    (told,) = bench.asks(7, TERMINATE, session=first.session)
    assert told.error == NO_SESSION


def test_a_repetition_is_known_though_another_session_was_asked_about_between(bench):
    (first,) = bench.asks(1, OPEN, b"long.json", session=200)
    assert bench.opens(sequence=1, session=201) == 201
    (again,) = bench.asks(1, OPEN, b"long.json", session=200)
    assert again.session == first.session == 200


@pytest.mark.parametrize("sequence", [0xFFFE, 0xFFFF])
def test_answers_count_up_beyond_the_largest_number(bench, sequence):
    session = bench.opens(sequence=sequence)
    (told,) = bench.asks(sequence, READ, session=session, size=1)
    assert told.sequence == sequence + 1 & 0xFFFF


def test_what_was_open_before_a_reset_is_opened_anew(bench):
    for _ in range(2):
        session = bench.opens(sequence=1, session=7)
        (told,) = bench.asks(2, READ, session=session, size=1)
        assert told.opcode == ACK
        bench.asks(3, TERMINATE, session=session)
        session = bench.opens(sequence=4, session=7)
        bench.asks(5, RESET, session=200)
        assert bench.opens(sequence=4, session=7) == session
        (told,) = bench.asks(6, READ, session=session, size=1)
        assert told.opcode == ACK
        bench.asks(7, RESET, session=200)


def test_who_begins_anew_gets_a_session_that_is_open(bench):
    for _ in range(2):
        session = bench.opens(sequence=0)
        assert bench.asks(1, BURST, session=session, size=MOST) == []
        assert len(bench.hears(SECOND)) == 21
        (told,) = bench.asks(2, TERMINATE, session=session)
        assert told.opcode == ACK


def test_sessions_are_few_and_those_left_behind_make_room(bench):
    held = [bench.opens(session=session) for session in range(10, 18)]
    assert held == [*range(10, 18)]
    (told,) = bench.asks(17, OPEN, b"long.json", session=18)
    assert told.error == NO_ROOM
    bench.run(9 * SECOND)
    (told,) = bench.asks(19, READ, session=held[0], size=1)
    bench.run(SECOND)
    assert bench.opens(sequence=21, session=18) == 18
    (told,) = bench.asks(23, READ, session=held[0], size=1)
    assert told.opcode == ACK
    bench.asks(25, RESET)
    (told,) = bench.asks(27, READ, session=held[0], size=1)
    assert told.error == NO_SESSION


@pytest.mark.parametrize("read", [BURST, READ])
def test_a_file_read_to_its_end_makes_room_for_the_next_though_nobody_closed_it(bench, read):
    # The word that closes it may have been lost, and MAVSDK reads in session 0 whatever it is told.
    bench.opens(b"short.json")
    bench.asks(3, read, size=MOST)
    bench.hears(SECOND)
    assert bench.opens(sequence=5) == 0
    (told,) = bench.asks(7, READ, size=MOST)
    assert told.data == LONG[:MOST]


def test_nothing_is_read_of_another_file_than_was_opened_last(bench):
    bench.opens()
    bench.asks(3, READ, size=MOST)
    (told,) = bench.asks(5, OPEN, b"short.json")
    assert told.error == NO_ROOM
    bench.opens(sequence=7)
    bench.run(10 * SECOND)
    bench.opens(b"short.json", sequence=9)
    (told,) = bench.asks(11, READ, size=MOST)
    assert told.data == FILES["short.json"]


def test_a_file_on_its_way_is_not_left_behind(bench):
    slow = bench.opens()
    for session in range(1, 8):
        bench.opens(session=session)
    bench.asks(17, BURST, session=slow, size=1)
    pieces = bench.hears(11 * SECOND)
    assert bench.opens(sequence=19, session=8) == 8
    pieces += bench.hears(40 * SECOND)
    assert b"".join(piece.data for piece in pieces) == LONG


def test_bursts_of_several_sessions_do_not_disturb_each_other(bench):
    for session in (17, 18):
        assert bench.opens(session=session) == session
        bench.asks(3, BURST, session=session, size=MOST)
    pieces = bench.hears(SECOND)
    for session in (17, 18):
        assert b"".join(piece.data for piece in pieces if piece.session == session) == LONG


def test_sessions_are_each_requester_s_own(bench):
    session = bench.opens()
    for who in ({"station": THEM}, {"link": THERE}):
        (told,) = bench.asks(3, READ, session=session, size=1, **who)
        assert told.error == NO_SESSION
        (told,) = bench.asks(5, RESET, **who)
        assert told.opcode == ACK
    bench.server.forget(THERE)
    (told,) = bench.asks(7, READ, session=session, size=1)
    assert told.opcode == ACK
    bench.server.forget(HERE)
    (told,) = bench.asks(9, READ, session=session, size=1)
    assert told.error == NO_SESSION


def test_who_was_not_heard_for_the_longest_time_is_forgotten_for_new_ones(bench):
    session = bench.opens()
    bench.asks(3, BURST, session=session, size=1)
    for system in range(1, 33):
        bench.opens(station=type(US)(system, 1))
    assert bench.hears(1) == []
    (told,) = bench.asks(5, READ, session=session, size=1)
    assert told.error == NO_SESSION


def test_as_long_as_there_is_room_for_all_nobody_is_forgotten(bench):
    stations = [type(US)(system, 1) for system in range(1, 33)]
    sessions = [bench.opens(station=station) for station in stations]
    for sequence in (3, 5):
        answers = [
            bench.asks(sequence, READ, session=session, size=1, station=station)[0].opcode
            for session, station in zip(sessions, stations, strict=True)
        ]
        assert answers == [ACK] * 32


def test_of_too_many_who_was_heard_lately_is_kept(bench):
    session = bench.opens()
    for system in range(1, 40):
        bench.opens(station=type(US)(system, 1))
        (told,) = bench.asks(2 * system + 1, READ, session=session, size=1)
        assert told.opcode == ACK


REQUESTS = st.one_of(
    st.binary(max_size=251),
    st.builds(
        lambda sequence, session, opcode, size, offset, data: (
            HEAD.pack(sequence, session, opcode, size, 0, 0, 0, offset) + data
        ),
        st.integers(0, 3), st.integers(0, 4), st.integers(0, 17), st.sampled_from((0, 100, 239, 240)),
        st.sampled_from((0, 1, 4999, 5000, 0xFFFFFFFF)), st.sampled_from((b"", b"/", b"long.json", b"/short.json")),
    ),
)  # fmt: skip


ASKED = st.tuples(REQUESTS, st.integers(1, 40), st.sampled_from((HERE, THERE)), st.integers(0, 5))


@given(st.lists(ASKED, max_size=40))
def test_whatever_is_asked_one_answer_or_a_bounded_burst_comes(asked):
    bench = Bench()
    for payload, system, link, ticks in asked:
        answers = bench.sends(payload, type(US)(system, 1), link)
        assert len(answers) <= 1
        assert all(answer.opcode in (ACK, NAK) and answer.size <= MOST for answer in answers)
        bench.run(ticks)
    left = 32 * 8 * 50  # pieces of at least 100 bytes, of all sessions that it knows
    while bench.run():
        left -= PIECES_PER_TICK
    assert left > 0


@pytest.mark.parametrize("seed", range(10))
def test_with_a_third_of_everything_lost_a_station_that_asks_again_gets_the_whole_file(seed):
    bench, got, sequence, chance = Bench(), {}, 1, random.Random(seed)

    def asks(opcode, **about):
        nonlocal sequence
        sequence += 2
        while True:
            answers = bench.asks(sequence, opcode, **about) if chance.random() > 0.3 else []
            if answers and chance.random() > 0.3:
                return answers[0]

    session = asks(OPEN, data=b"long.json").session
    while (missing := next((at for at in range(0, len(LONG), 200) if at not in got), None)) is not None:
        if chance.random() < 0.5:
            got[missing] = asks(READ, session=session, size=200, offset=missing).data
        elif chance.random() > 0.3:
            sequence += 2
            bench.asks(sequence, BURST, session=session, size=200, offset=missing)
            got |= {piece.offset: piece.data for piece in bench.hears(chance.randrange(9)) if chance.random() > 0.3}
    assert asks(TERMINATE, session=session).opcode == ACK
    assert b"".join(got[at] for at in sorted(got)) == LONG
