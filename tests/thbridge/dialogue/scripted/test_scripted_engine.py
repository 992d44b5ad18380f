import pytest
from hypothesis import given
from hypothesis import strategies as st

from thbridge.dialogue.moves import Ask, Author, Continue, DialogueOutcome, DialogueTopic, Scenario, Speaker, Stop
from thbridge.dialogue.scripted.protocols import TemplateProtocol
from thbridge.dialogue.scripted.scripted_engine import ScriptedEngine
from thbridge.dialogue.scripted.strategies import TemplateStrategy
from thbridge.dialogue.scripted.templates import ScriptedQuestion, Template, TemplatePhrasing
from thbridge.files.language_texts import shipped_texts
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


def engine(template=TEMPLATE, seed=7):
    return ScriptedEngine(
        TemplateProtocol(template), TemplateStrategy(), TemplatePhrasing(template, seed, shipped_texts())
    )


def test_every_question_needs_its_continue():
    talk = engine()
    step = talk.open(1, TOPIC)
    heard = [said.text for said in step.utterances]
    for _ in range(2):
        step = talk.move(step.dialogue, Continue())
        assert step.outcome is None
        heard += [said.text for said in step.utterances if said.speaker is Speaker.ROBOT]
    assert heard == ["Do you want me to go to room 4", "It will cost me 13 to go to room 4", "Are you sure?"]
    step = talk.move(step.dialogue, Continue())
    assert step.outcome is DialogueOutcome.CONSENSUS


@pytest.mark.parametrize("agreed", [0, 1, 2])
def test_a_stop_anywhere_ends_without_consensus(agreed):
    talk = engine()
    step = talk.open(1, TOPIC)
    for _ in range(agreed):
        step = talk.move(step.dialogue, Continue())
    step = talk.move(step.dialogue, Stop())
    assert step.outcome is DialogueOutcome.NO_CONSENSUS


def test_no_questions_agree_at_once():
    step = engine().open(1, DialogueTopic(Scenario.TAKE_TREASURE, 0, Room(1), 2.0, 50.0))
    assert (step.outcome, step.utterances) == (DialogueOutcome.CONSENSUS, ())


def test_each_thing_said_can_be_recorded_alone():
    talk = engine()
    step = talk.open(1, TOPIC)
    step = talk.move(step.dialogue, Continue())
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
    step = talk.open(1, TOPIC)
    assert [(choice.move, choice.text) for choice in talk.choices(step.dialogue)] == [
        (Continue(), "Continue"),
        (Stop(), "Stop"),
    ]
    with pytest.raises(ValueError, match="not among the legal"):
        talk.move(step.dialogue, Ask(1))


def test_the_seed_chooses_among_wordings():
    wordings = {"Shall I?", "May I?", "Is that right?"}
    several = Template("w", {Scenario.DONT_KNOW: questions(" | ".join(sorted(wordings)))})

    def asked(seed, opened=1):
        return engine(several, seed).open(opened, TOPIC).utterances[0].text

    assert {asked(seed) for seed in range(40)} == wordings
    assert {asked(7, opened) for opened in range(40)} == wordings
    assert asked(7) == asked(7)


@given(st.lists(st.sampled_from([Continue(), Stop()])))
def test_consensus_only_ever_comes_of_as_many_continues_as_questions(moves):
    talk = engine()
    step = talk.open(1, TOPIC)
    for agreed, move in enumerate(moves, 1):
        if step.outcome is not None:
            break
        step = talk.move(step.dialogue, move)
        wanted = len(TEMPLATE.of(TOPIC.scenario))
        assert (step.outcome is DialogueOutcome.CONSENSUS) == (move == Continue() and agreed == wanted)


def test_a_held_dialogue_waits_where_the_robot_would_speak():
    talk = engine()
    step = talk.open(1, TOPIC, held=True)
    assert (step.utterances, step.outcome, step.dialogue.turns) == ((), None, ())
    assert talk.choices(step.dialogue) == ()
    assert [choice.text for choice in talk.choices(step.dialogue, Speaker.ROBOT)] == ["Do you want me to go to room 4"]
    with pytest.raises(ValueError, match="not among the legal"):
        talk.move(step.dialogue, Continue())
    with pytest.raises(ValueError, match="not among the legal"):
        talk.speak(step.dialogue, Ask(1))


def test_what_is_said_in_a_robots_place_is_marked_and_said_again_in_the_same_words():
    talk = engine()
    step = talk.open(1, TOPIC, held=True)
    step = talk.speak(step.dialogue, Ask(0), "Room 4, what do you say?")
    step = talk.move(step.dialogue, Continue(), held=True)
    assert talk.choices(step.dialogue) == ()
    step = talk.speak(step.dialogue, Ask(1))
    step = talk.move(step.dialogue, Continue())
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
    step = talk.open(1, TOPIC)
    with pytest.raises(ValueError, match="not among the legal"):
        talk.speak(step.dialogue, Ask(1))
    assert talk.release(step.dialogue).dialogue == step.dialogue


@given(st.lists(st.booleans(), max_size=8))
def test_a_robot_that_goes_on_says_what_it_would_have_said(held):
    talk = engine()
    plain, step = talk.open(1, TOPIC), talk.open(1, TOPIC, held=True)
    for hold in held:
        step = talk.release(step.dialogue)
        assert step.dialogue == plain.dialogue
        if plain.outcome is not None:
            return
        plain = talk.move(plain.dialogue, Continue())
        step = talk.move(step.dialogue, Continue(), held=hold)
        if step.outcome is not None:
            return


def test_a_strategy_cannot_break_the_protocol():
    class Hasty:
        def choose(self, dialogue, legal):
            return Ask(2)

    with pytest.raises(ValueError, match="not among the legal"):
        ScriptedEngine(TemplateProtocol(TEMPLATE), Hasty(), TemplatePhrasing(TEMPLATE, 7, shipped_texts())).open(
            1, TOPIC
        )


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
        def choose(self, dialogue, legal):
            return max(legal, key=lambda move: move.question)

    class Figures:
        def say(self, dialogue, move, speaker):
            return f"{move.question}"

    talk = ScriptedEngine(Haggle(), Dearest(), Figures())
    step = talk.open(1, TOPIC)
    assert step.utterances == ()
    step = talk.move(step.dialogue, Ask(10))
    assert [said.text for said in step.utterances] == ["10", "20"]
    assert talk.move(step.dialogue, Ask(20)).outcome is DialogueOutcome.CONSENSUS
