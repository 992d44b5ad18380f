"""Words for moves, by which recordings and programs tell them apart."""

from typing import get_args

from thbridge.dialogue import moves
from thbridge.dialogue.argumentation.propositions import Literal
from thbridge.dialogue.games.contents import DialogueMove
from thbridge.dialogue.propositions import NextRoom
from thbridge.hunt.rooms import Room


def test_every_kind_of_move_has_its_own_word_and_those_of_games_go_by_their_locutions():
    question = moves.Question.KNOWN
    made = [
        moves.Ask(0),
        moves.Continue(),
        moves.Stop(),
        moves.OpenQuestions(),
        moves.CloseQuestions(),
        moves.Enquire(question),
        moves.Explain(question, None, ()),
        moves.DecideAlone(1.0),
        moves.Echo(""),
        moves.Conclude(moves.Upshot.STAYS),
        moves.Override(),
        moves.Leave(),
    ]
    assert {type(move) for move in made} | {DialogueMove} == set(get_args(moves.Move))
    assert len({moves.word_of(move) for move in made}) == len(made)
    assert moves.word_of(DialogueMove("challenge", Literal(NextRoom(0, Room(1))))) == "challenge"
