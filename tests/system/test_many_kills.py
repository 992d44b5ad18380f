"""SIGKILL of the server, and of server and robots at once, again and again: no event is lost, the game goes on."""

import random
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.support.programs.ports import free_port
from tests.support.programs.processes import Program, until
from thbridge.recording.bag.reading.reader import messages
from thbridge.recording.bag.repair import reindex

pytestmark = [pytest.mark.slow, pytest.mark.timeout(3600)]

RATE = "10"


class Party:
    """The four programs of hunts, one game after the other."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        address = f"127.0.0.1:{free_port()}"
        port = address.rpartition(":")[2]
        self.server = Program(folder, "server", "--port", port)
        self.simr = Program(folder, "simr", "--server", address, "--rate", RATE, "--bag", "robots.bag")
        self.others = [Program(folder, name, "--server", address) for name in ("hider", "tabui")]

    @property
    def programs(self) -> list[Program]:
        return [self.server, self.simr, *self.others]

    @property
    def journals(self) -> dict[str, bytes]:
        """The whole lines of each game's journal."""
        files = sorted((self.folder / "journal").glob("*.jsonl"))
        return {file.name: (data := file.read_bytes())[: data.rfind(b"\n") + 1] for file in files}

    def wait_for_events(self, count: int) -> dict[str, bytes]:
        """Wait until so many more events are in the journals, or until the game ends.

        A server begins no other game by itself once one has ended; after it is started again it does. Whoever has
        played a game to its end plays another.
        """
        before = self._events

        def more() -> bool:
            for number, program in enumerate(self.others):
                if program.process.poll() is not None:
                    program.close()
                    self.others[number] = program.again()
            came = len(self._events) - len(before)
            return came >= count or (came > 0 and b'"event":"ended"' in self._events[-1])

        until("events", more, self.programs)
        return self.journals

    @property
    def _events(self) -> list[bytes]:
        return [line for text in self.journals.values() for line in text.splitlines()]

    def close(self) -> None:
        for program in self.programs:
            program.close()


@pytest.fixture
def party(tmp_path: Path) -> Iterator[Party]:
    party = Party(tmp_path)
    yield party
    party.close()


def goes_on(before: dict[str, bytes], after: dict[str, bytes]) -> bool:
    return all(after[name].startswith(text) for name, text in before.items())


def test_a_server_that_is_killed_fifty_times_loses_no_event(party: Party) -> None:
    chance = random.Random(1)
    known: dict[str, bytes] = {}
    for _ in range(50):
        known = party.wait_for_events(chance.randrange(1, 6))
        party.server.kill()
        party.server.close()
        party.server = party.server.again()
        assert goes_on(known, party.journals)
    assert goes_on(known, party.wait_for_events(5))
    assert len(party.journals) > 1, "more than one game was played"
    assert not any("Traceback" in program.text for program in party.programs)


def test_server_and_robots_that_are_killed_at_once_twenty_times_leave_journals_and_bags_whole(party: Party) -> None:
    chance = random.Random(2)
    for _ in range(20):
        known = party.wait_for_events(chance.randrange(1, 6))
        for program in (party.server, party.simr):
            program.kill()
            program.close()
        party.server = party.server.again()
        party.simr = party.simr.again()
        assert goes_on(known, party.journals)
    party.wait_for_events(5)
    assert party.simr.stop() == 0
    bags = [*party.folder.glob("robots*.bag"), *party.folder.glob("robots*.bag.active")]
    # Some were killed before they had begun to record, or had said anything.
    assert 10 < len(bags) <= 21
    for bag in bags:
        if bag.name.endswith(".active"):
            reindex(bag)
    whole = [bag for bag in party.folder.glob("robots*.bag") if not bag.stem.endswith(".orig")]
    heard = [sum(message.topic == "/robot1/odom" for message in messages(bag)) for bag in whole]
    assert len(heard) == len(bags)
    assert sum(count > 0 for count in heard) > 10
