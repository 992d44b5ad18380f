"""A study in German: nothing that reaches the participant is in the language of map and templates, English."""

import re
from collections.abc import Iterator, Sequence
from pathlib import Path

import pytest
from msgspec import structs

from tests.support.hunts.hunt_without_simulator import Log, Puppets
from tests.support.windows.english import english_names
from thbridge.app.compose.game import build_bot, build_hider, build_keeper
from thbridge.app.compose.setting import StudySetting, read_setting
from thbridge.app.session.session import Session
from thbridge.dialogue.conditions import DialogueCondition
from thbridge.hunt.codec import to_json
from thbridge.hunt.events import DialogueOpened, DialogueSaid, JournalEntry
from thbridge.roles.keeper.disclosed.disclosure import plain_costs
from thbridge.roles.participant.bot_strategy import BotStrategy
from thbridge.roles.participant.tabui import ParticipantUpdate, TabUI
from thbridge.roles.shared.notices import FloorPlan
from thbridge.roles.shared.view import AnswerDialogue, OpenDialogue, ParticipantRequest, View
from thbridge.study.study_file import DialogueSection, Study


class Reader:
    """A participant who notes all that she could read, and plays as a bot; contrary: she names wrongly and asks why."""

    def __init__(self, setting: StudySetting, contrary: bool = False) -> None:
        self.bot = build_bot(setting.templates, BotStrategy.SUGGESTION, seed=7)
        self.contrary = contrary
        self.views: list[View] = []
        self.read: set[str] = set()

    def requests(self, view: View) -> Sequence[ParticipantRequest]:
        wanted = self.bot.requests(view)
        return [_contrary(view, each) for each in wanted] if self.contrary else wanted

    def observe(self, update: ParticipantUpdate) -> None:
        if isinstance(update, View):
            self.views.append(update)
            self.read.update(words_in(update))
        elif isinstance(update, FloorPlan):
            self.read.update(outline.name for outline in update.rooms)


def _contrary(view: View, wanted: ParticipantRequest) -> ParticipantRequest:
    match wanted:
        case OpenDialogue(name=str(name)) if name:
            names = sorted(view.names)
            return structs.replace(wanted, name=names[names.index(name) - 1])
        case AnswerDialogue(number):
            acts = next(dialogue.acts for dialogue in view.dialogues if dialogue.dialogue == number)
            return structs.replace(wanted, choice=acts.index("challenge")) if "challenge" in acts else wanted
        case _:
            return wanted


def words_in(view: View) -> Iterator[str]:
    """All words of a view that are read, and no names for programs."""
    for dialogue in (*view.dialogues, *view.last_words):
        yield from dialogue.said
    for dialogue in view.dialogues:
        yield from dialogue.choices
    yield from map(view.word_for, view.names)
    yield from (view.word_for(room.name) for room in (() if view.debrief is None else view.debrief.rooms))
    for each in view.properties:
        known = [room.known[each.name] for room in view.rooms if each.name in room.known]
        yield from (each.label, each.sensor, *map(each.phrase, (*each.values, *known)))


def played(study: Study, contrary: bool = False) -> tuple[StudySetting, Reader, Log]:
    """A whole game."""
    setting = read_setting(study, Path())
    reader, log = Reader(setting, contrary), Log()
    roles = [
        Puppets(study.robots, plain_costs(setting.costs), place=setting.map.name),
        TabUI(reader, reader),
        build_hider(setting.templates, study.seed),
    ]
    session = Session(build_keeper(setting), roles, log=log)
    for _ in range(20_000):
        session.step()
        if session.game is not None and session.game.ended is not None:
            break
    for _ in range(5):
        session.step()
    return setting, reader, log


@pytest.mark.parametrize("condition", [DialogueCondition.SCRIPT, DialogueCondition.COLLABORATOR])
@pytest.mark.parametrize("templates", ["four-properties", "everyday-things"])
def test_a_german_study_says_nothing_in_the_english_of_map_and_templates(
    templates: str, condition: DialogueCondition
) -> None:
    talk = DialogueSection(language="de", condition=condition)
    setting, reader, _ = played(Study(map="office", templates=templates, robots=2, dialogue=talk))
    assert reader.views[-1].debrief is not None
    assert {*setting.set_words.names.values(), "Bibliothek", "Küche"} <= reader.read
    assert any("Raum " in words for words in reader.read)
    english = re.compile("|".join(rf"\b{re.escape(word)}\b" for word in sorted(english_names(setting))), re.IGNORECASE)
    assert [words for words in sorted(reader.read) if english.search(words)] == []


def test_scripted_robots_give_reasons_in_the_language_of_the_study() -> None:
    _, reader, _ = played(Study(map="office", templates="practice", dialogue=DialogueSection(language="de")))
    suggested = [words for words in reader.read if words.startswith("Ich schlage Raum ")]
    reasons = r"Kein anderer Raum kostet mich weniger|Raum \d kostet mich (jetzt )?weniger, aber .*|Das kostet mich .*"
    assert suggested
    assert all(re.search(rf": ({reasons})\. Soll ich hinfahren\?$", words) for words in suggested)


@pytest.mark.parametrize("templates", ["four-properties", "everyday-things"])
def test_robots_argue_about_names_in_the_words_of_the_set(templates: str) -> None:
    talk = DialogueSection(language="de", condition=DialogueCondition.COLLABORATOR)
    setting, reader, _ = played(Study(map="office", templates=templates, robots=2, dialogue=talk), contrary=True)
    names = "|".join(setting.set_words.names.values())
    assert any(re.search(rf"Meine Gründe: .* ist .*, und „({names})“ ist ", words) for words in reader.read)
    english = re.compile("|".join(rf"\b{re.escape(word)}\b" for word in sorted(english_names(setting))), re.IGNORECASE)
    assert [words for words in sorted(reader.read) if english.search(words)] == []


@pytest.mark.parametrize("condition", [DialogueCondition.SCRIPT, DialogueCondition.COLLABORATOR])
def test_the_same_is_recorded_in_each_language_but_for_sentences(condition: DialogueCondition) -> None:
    def recorded(language: str) -> list[str]:
        """The journal; declarations of properties in it have no words."""
        talk = DialogueSection(language=language, condition=condition)
        study = Study(map="office", templates="four-properties", robots=2, dialogue=talk)
        log = played(study, contrary=condition is not DialogueCondition.SCRIPT)[2]
        return [to_json(_without_sentences(entry)) for entry in log.entries]

    assert recorded("de") == recorded("en")
    assert not any('"words"' in line for line in recorded("de"))


def _without_sentences(entry: JournalEntry) -> JournalEntry:
    if isinstance(entry, DialogueSaid):
        return structs.replace(entry, text="")
    return structs.replace(entry, reason="") if isinstance(entry, DialogueOpened) else entry


def test_words_of_values_are_told_as_the_values_are_and_those_of_names_with_the_names() -> None:
    talk = DialogueSection(language="de")
    _, reader, _ = played(Study(map="office", templates="everyday-things", dialogue=talk))
    for view in reader.views:
        known = {(name, value) for room in view.rooms for name, value in room.known.items()}
        assert {(each.name, value) for each in view.properties for value in each.words} == known
        told = {*view.names, *(room.name for room in (() if view.debrief is None else view.debrief.rooms))}
        assert set(view.called) == told
    first, last = reader.views[0], reader.views[-1]
    assert (first.called, {each.label for each in first.properties}) == ({}, {"Farbe", "Standfläche"})
    assert last.word_for("beer_bottle") == "Bierflasche"


def test_a_set_of_2016_without_words_has_labels_of_the_study() -> None:
    setting = read_setting(Study(templates="original-2016", dialogue=DialogueSection(language="de")), Path())
    assert [each.label for each in setting.set_words.properties] == ["Farbe", "Standfläche"]
    english = read_setting(Study(templates="original-2016"), Path())
    assert english.set_words.properties == english.templates.properties
