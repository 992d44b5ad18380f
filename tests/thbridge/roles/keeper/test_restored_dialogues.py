"""Dialogues outlive a server that is killed: the journal has them, and a new keeper takes them up where they were."""

from dataclasses import dataclass

import pytest
from msgspec import structs

from tests.support.hunts.hunt_without_simulator import RULES, HuntWithoutSimulator, scripted_engine, templates
from tests.support.hunts.scripted_hunt import LANGUAGE, RULEBOOK, ArguingHunt
from thbridge.app.compose.game import build_bot
from thbridge.dialogue.arguing import ArguingEngine
from thbridge.dialogue.conditions import DialogueCondition, Manner
from thbridge.dialogue.engine import DialogueEngine
from thbridge.dialogue.games.strategies import Attitude
from thbridge.dialogue.worded import WordedPhrasing
from thbridge.hunt.events import DialogueOpened, DialogueSaid, JournalEntry
from thbridge.roles.keeper.dialogues import GameDialogues
from thbridge.roles.keeper.keeper import Keeper
from thbridge.roles.participant.bot_strategy import BotStrategy
from thbridge.roles.participant.tabui import TabUI
from thbridge.roles.shared.view import AnswerDialogue, Consent, SelectRoom


def arguing(condition: DialogueCondition, *, talkative: bool, misheard: float = 0.0) -> ArguingEngine:
    manner = Manner(condition, persistence=1, talkative=talkative, misheard=misheard)
    return ArguingEngine(RULEBOOK, {None: manner}, WordedPhrasing(LANGUAGE, condition, 7), 7)


@dataclass(frozen=True)
class Standing:
    """How the dialogues of a game stand, as far as anything that follows depends on it."""

    views: object
    consents: object
    beliefs: object
    number: int

    @classmethod
    def of(cls, dialogues: GameDialogues) -> "Standing":
        conversations = {
            # Time and number of dialogues are part of what is believed.
            robot: (each.agents, each.plays, each.since)
            for robot, (_, each) in dialogues.memories._memories.items()
        }
        return cls(dialogues.views(), dialogues.agreements.all, conversations, dialogues.next_number)


def restored(hunt: HuntWithoutSimulator, talk: DialogueEngine, history: list[JournalEntry]) -> Keeper:
    return Keeper(RULES, lambda _: talk, history, 1, hunt.briefing)


@pytest.mark.parametrize(
    "talk",
    [
        pytest.param(arguing(DialogueCondition.COLLABORATOR, talkative=True, misheard=0.3), id="collaborator"),
        pytest.param(arguing(DialogueCondition.ADVISER, talkative=False), id="adviser"),
        pytest.param(arguing(DialogueCondition.AUTONOMOUS, talkative=True), id="autonomous", marks=pytest.mark.slow),
        pytest.param(scripted_engine(templates()), id="script"),
    ],
)
def test_a_keeper_that_is_restarted_at_any_moment_knows_what_was_said_and_agreed(talk):
    hunt = HuntWithoutSimulator(
        talk=talk, participant=TabUI(build_bot(templates(), BotStrategy.RANDOM, 3, Attitude.SCEPTICAL))
    )
    stands: dict[int, Standing] = {}
    while hunt.session.game is None or hunt.session.game.ended is None:
        hunt.run(1)
        stands[len(hunt.log.entries)] = Standing.of(hunt.keeper._game.dialogues)
    said = [entry for entry in hunt.log.entries if isinstance(entry, DialogueSaid)]
    assert len(said) >= 15, "nobody talks: the test shows nothing"
    for length, standing in [*stands.items()][1 :: len(stands) // 12]:
        keeper = restored(hunt, talk, hunt.log.entries[:length])
        assert keeper.dialogues_not_restored == ()
        assert Standing.of(keeper._game.dialogues) == standing
        keeper.step(0, ())
        assert keeper.decisions.entries == () and keeper.decisions.utterances == ()


def test_the_participant_answers_the_robot_after_a_restart_as_if_nothing_had_happened():
    table = ArguingHunt()
    room = table.another_room()
    table.wish(SelectRoom(0, room))
    before = table.dialogue()
    again = ArguingHunt(history=table.hunt.log.entries)
    assert again.dialogue() == before
    again.say(f"All right, not room {room}")
    again.say("Where would you go, then?")
    assert [Consent(0, "select-room", each.room) for each in again.say("All right").consents] == [*again.view.consents]


def test_a_robot_whose_answer_was_not_written_any_more_answers_after_the_restart():
    table = ArguingHunt()
    table.wish(SelectRoom(0, table.another_room()))
    talk = table.dialogue()
    table.wish(AnswerDialogue(talk.dialogue, talk.turn, talk.acts.index("challenge")))
    history = list(table.hunt.log.entries)
    answer = next(
        at
        for at, entry in enumerate(history)
        if isinstance(entry, DialogueSaid) and entry.move.startswith("challenge") and entry.speaker == "person"
    )
    cut = history[: answer + 1]
    assert history[answer + 1 :]
    again = ArguingHunt(history=cut)
    assert again.dialogue() == table.dialogue()
    assert again.hunt.log.entries[: len(history)] == history


def test_a_dialogue_that_the_rules_do_not_allow_any_more_is_withdrawn_and_told():
    table = ArguingHunt()
    table.wish(SelectRoom(0, table.another_room()))
    *before, last = table.hunt.log.entries
    assert isinstance(last, DialogueSaid)
    other = structs.replace(last, move="assert(nonsense)")
    keeper = restored(table.hunt, table.talk, [*before, other])
    assert keeper.dialogues_not_restored == (last.dialogue,)
    assert keeper._game.dialogues.views() == ()


def test_a_journal_has_every_sentence_with_its_speaker_and_author():
    table = ArguingHunt()
    table.wish(SelectRoom(0, table.another_room()))
    opened = [entry for entry in table.hunt.log.entries if isinstance(entry, DialogueOpened)][-1]
    said = [
        each for each in table.hunt.log.entries if isinstance(each, DialogueSaid) and each.dialogue == opened.dialogue
    ]
    assert [each.text for each in said] == [*table.dialogue().said]
    assert [each.speaker for each in said] == [*table.dialogue().speakers]
    assert [each.turn for each in said] == [*range(len(said))]
