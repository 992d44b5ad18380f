"""Who took part by which key, and what was asked by it, is in the journal of the game."""

from tests.support.hunts.hunt_without_simulator import HuntWithoutSimulator
from thbridge.app.session.input_records import to_record
from thbridge.app.session.inputs import ConnectionOpened
from thbridge.credentials import Credentials, Right
from thbridge.hunt.events import KeyUsed
from thbridge.text_protocol.wire.router import TurnedAway


def test_a_game_has_the_keys_of_its_programs_and_what_was_asked_by_others() -> None:
    hunt = HuntWithoutSimulator(run="run")
    early = hunt.session.router.connect(0.0, Credentials("maria", (Right.PARTICIPANT,)))
    assert not isinstance(early, TurnedAway)
    hunt.session.router.receive_data(early, b"%%setid Anna extended\n", 0.0)
    while hunt.session.game is None:
        hunt.run(1)
    late = hunt.session.router.connect(1.0, Credentials("jo", (Right.ADMIN,)))
    assert not isinstance(late, TurnedAway)
    hunt.session.router.receive_data(late, b"%%setid Bert\n", 1.0)
    hunt.session.keys.granted("dora", 'ClearCostmaps {"robot": 0}')
    nobody = hunt.session.router.connect(1.0)
    assert not isinstance(nobody, TurnedAway)
    hunt.session.router.receive_data(nobody, b"%%setid Local\n", 1.0)
    hunt.run(2)
    assert [entry for entry in hunt.log.entries if isinstance(entry, KeyUsed)] == [
        KeyUsed("maria", "joined as Anna", "run/1"),
        KeyUsed("jo", "joined as Bert", "run/1"),
        KeyUsed("dora", 'asked: ClearCostmaps {"robot": 0}', "run/1"),
    ]
    opened = [item for tick in hunt.tick_records for item in tick.inputs if isinstance(item, ConnectionOpened)]
    assert [to_record(item).line for item in opened] == [
        "a connection is opened with the key maria (participant)",
        "a connection is opened with the key jo (admin)",
        "a connection is opened",
    ]
