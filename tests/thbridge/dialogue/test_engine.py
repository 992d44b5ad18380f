import pytest
from hypothesis import given
from hypothesis import strategies as st

from thbridge.dialogue.engine import DialogueReason, Dialogues, Engine
from thbridge.dialogue.moves import Ask, Author, Continue, DialogueOutcome, DialogueTopic, Scenario, Speaker, Stop
from thbridge.dialogue.protocols import TemplateProtocol
from thbridge.dialogue.strategies import TemplateStrategy
from thbridge.dialogue.templates import ScriptedQuestion, Template, TemplatePhrasing
from thbridge.hunt.rooms import Room


def questions(*lines):
    return tuple(ScriptedQuestion(tuple(line.split(" | "))) for line in lines)


TEMPLATE = Template(
    "test",
    {
        Scenario.DONT_KNOW: questions(
            "Do you want me to go to room £room£",
            "It will cost me £cost£ to go to room £room£",
            "Are you sure?",
        ),
        Scenario.SPECIFIC_ROOM: questions("It will cost me £cost£ to go to room £room£", "Are you sure?"),
        Scenario.TAKE_PICTURE: questions("It is £colour£. Shall I?"),
    },
)
TOPIC = DialogueTopic(Scenario.DONT_KNOW, 0, Room(4), 13.0, 87.0)
CHOSEN = DialogueTopic(Scenario.SPECIFIC_ROOM, 1, Room(2), 14.0, 100.0)


def engine(template=TEMPLATE, seed=7):
    return Engine(TemplateProtocol(template), TemplateStrategy(), TemplatePhrasing(template, seed))


def test_every_question_needs_its_continue():
    talk = engine()
    step = talk.open(Dialogues(), TOPIC)
    heard = [said.text for said in step.utterances]
    for _ in range(2):
        step = talk.move(step.dialogues, 1, Continue())
        assert step.outcome is None
        heard += [said.text for said in step.utterances if said.speaker is Speaker.ROBOT]
    assert heard == ["Do you want me to go to room 4", "It will cost me 13 to go to room 4", "Are you sure?"]
    step = talk.move(step.dialogues, 1, Continue())
    assert step.outcome is DialogueOutcome.CONSENSUS
    assert step.dialogues.open == ()


@pytest.mark.parametrize("agreed", [0, 1, 2])
def test_a_stop_anywhere_ends_without_consensus(agreed):
    talk = engine()
    step = talk.open(Dialogues(), TOPIC)
    for _ in range(agreed):
        step = talk.move(step.dialogues, 1, Continue())
    step = talk.move(step.dialogues, 1, Stop())
    assert step.outcome is DialogueOutcome.NO_CONSENSUS
    assert step.dialogues.open == ()


def test_no_questions_agree_at_once():
    step = engine().open(Dialogues(), DialogueTopic(Scenario.TAKE_TREASURE, 0, Room(1), 2.0, 50.0))
    assert (step.outcome, step.utterances, step.dialogues) == (DialogueOutcome.CONSENSUS, (), Dialogues(opened=1))


def test_each_thing_said_can_be_recorded_alone():
    talk = engine()
    step = talk.open(Dialogues(), TOPIC)
    step = talk.move(step.dialogues, 1, Continue())
    told, asked = step.utterances
    assert (told.dialogue, told.index, told.speaker, told.move, told.text) == (
        1,
        1,
        Speaker.PERSON,
        Continue(),
        "Continue",
    )
    assert (asked.dialogue, asked.index, asked.speaker, asked.move) == (1, 2, Speaker.ROBOT, Ask(1))
    assert asked.topic == TOPIC


def test_the_person_is_offered_the_legal_moves_only():
    talk = engine()
    step = talk.open(Dialogues(), TOPIC)
    assert [(choice.move, choice.text) for choice in talk.choices(step.dialogue)] == [
        (Continue(), "Continue"),
        (Stop(), "Stop"),
    ]
    assert talk.move(step.dialogues, 1, Ask(1)).reason == DialogueReason.NOT_LEGAL
    assert talk.move(step.dialogues, 9, Continue()).reason == DialogueReason.NO_SUCH_DIALOGUE


def test_robots_talk_at_the_same_time_but_each_in_one_dialogue():
    talk = engine()
    first = talk.open(Dialogues(), TOPIC)
    second = talk.open(first.dialogues, CHOSEN)
    assert (first.dialogue.number, second.dialogue.number) == (1, 2)
    assert talk.open(second.dialogues, TOPIC).reason == DialogueReason.ALREADY_TALKING
    step = talk.move(second.dialogues, 1, Stop())
    assert step.dialogues.of_robot(0) is None
    assert step.dialogues.of_robot(1) == second.dialogue
    assert talk.open(step.dialogues, TOPIC).dialogue.number == 3


def test_a_dialogue_can_be_withdrawn():
    talk = engine()
    step = talk.open(Dialogues(), TOPIC)
    gone = talk.withdraw(step.dialogues, 1)
    assert (gone.outcome, gone.dialogues.open) == (DialogueOutcome.WITHDRAWN, ())
    assert talk.withdraw(gone.dialogues, 1).reason == DialogueReason.NO_SUCH_DIALOGUE


def test_the_seed_chooses_among_wordings():
    wordings = {"Shall I?", "May I?", "Is that right?"}
    several = Template("w", {Scenario.DONT_KNOW: questions(" | ".join(sorted(wordings)))})

    def asked(seed, opened=0):
        return engine(several, seed).open(Dialogues(opened), TOPIC).utterances[0].text

    assert {asked(seed) for seed in range(40)} == wordings
    assert {asked(7, opened) for opened in range(40)} == wordings
    assert asked(7) == asked(7)


@given(st.lists(st.sampled_from(["open 0", "open 1", "continue 1", "continue 2", "stop 1", "stop 2", "continue 3"])))
def test_consensus_only_ever_comes_of_as_many_continues_as_questions(requests):
    talk = engine()
    dialogues = Dialogues()
    agreed = {}
    for request in requests:
        verb, number = request.split()
        number = int(number)
        if verb == "open":
            step = talk.open(dialogues, (TOPIC, CHOSEN)[number])
        else:
            step = talk.move(dialogues, number, Continue() if verb == "continue" else Stop())
        if not hasattr(step, "outcome"):
            continue
        dialogues = step.dialogues
        said = step.dialogue.number
        agreed[said] = agreed.get(said, 0) + (verb == "continue")
        wanted = len(TEMPLATE.of(step.dialogue.topic.scenario))
        assert (step.outcome is DialogueOutcome.CONSENSUS) == (verb != "stop" and agreed[said] == wanted)


def test_a_held_dialogue_waits_where_the_robot_would_speak():
    talk = engine()
    step = talk.open(Dialogues(), TOPIC, held=True)
    assert (step.utterances, step.outcome, step.dialogue.turns) == ((), None, ())
    assert talk.choices(step.dialogue) == ()
    assert [choice.text for choice in talk.choices(step.dialogue, Speaker.ROBOT)] == ["Do you want me to go to room 4"]
    assert talk.move(step.dialogues, 1, Continue()).reason == DialogueReason.NOT_LEGAL
    assert talk.speak(step.dialogues, 1, Ask(1)).reason == DialogueReason.NOT_LEGAL


def test_what_is_said_in_a_robots_place_is_marked_and_said_again_in_the_same_words():
    talk = engine()
    step = talk.open(Dialogues(), TOPIC, held=True)
    step = talk.speak(step.dialogues, 1, Ask(0), "Room 4, what do you say?")
    step = talk.move(step.dialogues, 1, Continue(), held=True)
    assert talk.choices(step.dialogue) == ()
    step = talk.speak(step.dialogues, 1, Ask(1))
    step = talk.move(step.dialogues, 1, Continue())
    said = talk.utterances(step.dialogue)
    assert [(turn.author, turn.text) for turn in said] == [
        (Author.WIZARD, "Room 4, what do you say?"),
        (Author.PERSON, "Continue"),
        (Author.WIZARD, "It will cost me 13 to go to room 4"),
        (Author.PERSON, "Continue"),
        (Author.ROBOT, "Are you sure?"),
    ]


def test_nobody_can_be_spoken_for_at_the_persons_turn():
    talk = engine()
    step = talk.open(Dialogues(), TOPIC)
    assert talk.speak(step.dialogues, 1, Ask(1)).reason == DialogueReason.NOT_LEGAL
    assert talk.speak(step.dialogues, 2, Ask(1)).reason == DialogueReason.NO_SUCH_DIALOGUE
    assert talk.release(step.dialogues, 2).reason == DialogueReason.NO_SUCH_DIALOGUE
    assert talk.release(step.dialogues, 1).dialogues == step.dialogues


@given(st.lists(st.booleans(), max_size=8))
def test_a_robot_that_goes_on_says_what_it_would_have_said(held):
    talk = engine()
    plain, step = talk.open(Dialogues(), TOPIC), talk.open(Dialogues(), TOPIC, held=True)
    for hold in held:
        step = talk.release(step.dialogues, 1)
        assert step.dialogue == plain.dialogue
        if plain.outcome is not None:
            return
        plain = talk.move(plain.dialogues, 1, Continue())
        step = talk.move(step.dialogues, 1, Continue(), held=hold)
        if step.outcome is not None:
            return


def test_a_strategy_cannot_break_the_protocol():
    class Hasty:
        def choose(self, view, legal):
            return Ask(2)

    with pytest.raises(ValueError, match="not among the legal"):
        Engine(TemplateProtocol(TEMPLATE), Hasty(), TemplatePhrasing(TEMPLATE, 7)).open(Dialogues(), TOPIC)


def test_another_way_of_talking_fits_without_changing_the_engine():
    """A protocol in which the person opens and the robot's strategy really chooses."""

    class Haggle:
        def outcome(self, dialogue):
            return DialogueOutcome.CONSENSUS if len(dialogue.turns) == 4 else None

        def speaker(self, dialogue):
            return Speaker.PERSON if len(dialogue.turns) % 2 == 0 else Speaker.ROBOT

        def legal(self, dialogue):
            return (Ask(10), Ask(20))

    class Dearest:
        def choose(self, view, legal):
            assert view.side is Speaker.ROBOT
            return max(legal, key=lambda move: move.question)

    class Figures:
        def say(self, dialogue, move):
            return f"{move.question}"

    talk = Engine(Haggle(), Dearest(), Figures())
    step = talk.open(Dialogues(), TOPIC)
    assert step.utterances == ()
    step = talk.move(step.dialogues, 1, Ask(10))
    assert [said.text for said in step.utterances] == ["10", "20"]
    assert talk.move(step.dialogues, 1, Ask(20)).outcome is DialogueOutcome.CONSENSUS
