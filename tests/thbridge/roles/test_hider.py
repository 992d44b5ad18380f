"""Hider without a keeper: it answers by itself, as in 2016."""

from thbridge.hunt.treasures import TreasureKind
from thbridge.roles.hider import KEEPER_TIMEOUT, Hider
from thbridge.roles.shared.notices import KEEPER, HideRequest
from thbridge.text_protocol.wire import legacy
from thbridge.text_protocol.wire.notice_format import encode_notice

KINDS = [TreasureKind({"colour": "Red", "footprint": "Round and Large"}, 10, "Red Ball", "ball.jpg")]


def answers(hider: Hider, question) -> list[str]:
    said = [m.line() for m in hider.step(100, [question.message()])]
    assert said == []
    return [m.line() for m in hider.step(100 + KEEPER_TIMEOUT, [])]


def test_it_answers_by_itself_when_there_is_no_keeper():
    hider = Hider(KINDS, seed=1, rooms=8)
    assert answers(hider, legacy.AskTreasure(2)) == [
        '%%found Hider TabUI 2 2 "(Colour: Red) (Footprint: Round and Large)" '
    ]
    assert answers(hider, legacy.SnapTreasure(2)) == ["%%image Hider TabUI 2 ball.jpg "]
    assert answers(hider, legacy.NameTreasure(2, "red  ball")) == ["%%score Hider TabUI ,10 "]
    assert answers(hider, legacy.NameTreasure(2, "Blue Ball")) == ["%%score Hider TabUI ,-10 "]
    assert answers(hider, legacy.AskTreasure(8)) == []


def test_with_a_keeper_it_waits_to_be_told():
    hider = Hider(KINDS, seed=1, rooms=8)
    assert len(hider.step(0, [encode_notice(KEEPER, legacy.HIDER, HideRequest(1, 8))])) == 1
    assert answers(hider, legacy.AskTreasure(2)) == []


def test_a_game_is_hidden_by_its_seed_and_number():
    many = [TreasureKind({"colour": "Red", "footprint": "Round"}, 10, f"thing{i}", None) for i in range(20)]

    def hidden(seed: int, game: int) -> str:
        (said,) = Hider(many, seed, 8).step(0, [encode_notice(KEEPER, legacy.HIDER, HideRequest(game, 8))])
        return said.line().partition("treasures")[2]

    assert hidden(1, 1) == hidden(1, 1)
    assert len({hidden(1, 1), hidden(1, 2), hidden(2, 1)}) == 3
