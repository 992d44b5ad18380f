"""Builders of the game's roles: keeper, treasures and simulated participants."""

import unicodedata
from dataclasses import replace

from sim.common.observations import TICKS_PER_SECOND
from sim.common.robot_numbers import index_of
from sim.numerics import noise
from thbridge.app.compose.installed import installed_participant
from thbridge.app.compose.setting import StudySetting
from thbridge.dialogue.arguing import ArguingEngine
from thbridge.dialogue.conditions import DialogueCondition, Manner
from thbridge.dialogue.engine import DialogueEngine
from thbridge.dialogue.games.strategies import Attitude
from thbridge.dialogue.scripted.protocols import TemplateProtocol
from thbridge.dialogue.scripted.scripted_engine import ScriptedEngine
from thbridge.dialogue.scripted.strategies import TemplateStrategy
from thbridge.dialogue.scripted.templates import TemplatePhrasing
from thbridge.dialogue.worded import WordedPhrasing
from thbridge.dialogue.wording.language import Language
from thbridge.files.set_words import SetWords, values_of
from thbridge.files.template_files import TemplateSet
from thbridge.hunt.events import JournalEntry
from thbridge.hunt.seats import ONE_SEAT, PlayedBy
from thbridge.hunt.treasures import TreasureKind
from thbridge.roles.hider import Hider
from thbridge.roles.keeper.advice.adviser import Adviser
from thbridge.roles.keeper.disclosed.briefing import Briefing
from thbridge.roles.keeper.disclosed.floor_plan import floor_plan_of
from thbridge.roles.keeper.keeper import GameRules, Keeper
from thbridge.roles.participant.bot_strategy import BotStrategy
from thbridge.roles.participant.bots import Bot, TreasureKnowledge
from thbridge.roles.participant.installed_participant import InstalledParticipant
from thbridge.roles.participant.tabui import TabUI
from thbridge.roles.shared.notices import FloorPlan, GameTexts, RoomOutline
from thbridge.study.seats import seats_of
from thbridge.study.study_file import DialogueSection, MannerSection, Study


def build_keeper(setting: StudySetting, history: tuple[JournalEntry, ...] = (), last_game: int = 0) -> Keeper:
    """Return the keeper; `Keeper` describes the arguments for a resumed game."""
    study, words = setting.study, setting.set_words

    def engine(number: int) -> DialogueEngine:
        seed = int(noise.key(study.seed, "dialogue", str(number)))
        if study.dialogue.condition is not DialogueCondition.SCRIPT and setting.language and setting.rulebook:
            known = tuple(words.names.get(name, name) for name in treasure_names(setting))
            language = _with_words(setting.language, setting.templates, words)
            condition, names = study.dialogue.condition, setting.room_names
            phrasing = WordedPhrasing(language, condition, seed, names, setting.author, known)
            return ArguingEngine(setting.rulebook, manners_of(study.dialogue), phrasing, seed, setting.strategies)
        scripted = TemplatePhrasing(words.dialogue, seed, setting.texts, words.properties)
        return ScriptedEngine(TemplateProtocol(words.dialogue), TemplateStrategy(), scripted)

    talk = study.dialogue
    return Keeper(
        game_rules(study),
        engine,
        history,
        last_game,
        build_briefing(setting),
        Adviser(
            talk.planner,
            talk.adviser_error_rate,
            talk.says_confidence,
            talk.confidence_bias,
            talk.confidence_spread,
            setting.texts,
        ),
        None if talk.patience is None else round(talk.patience * TICKS_PER_SECOND),
        tells_refusals=study.server.tell_refusals,
    )


def game_rules(study: Study) -> GameRules:
    """Return the rules of a study's game."""
    game = study.game
    return GameRules(
        study.seed,
        game.energy,
        game.picture_cost,
        game.identify_cost,
        game.wrong_share,
        seats_of(study.seats),
        study.team.rules(),
    )


def _with_words(language: Language, templates: TemplateSet, words: SetWords) -> Language:
    """Return a language with the names of treasures and the values of properties from a template set."""
    names = dict(words.names)
    for written, said in zip(templates.properties, words.properties, strict=True):
        names |= {written.phrase(value): said.phrase(value) for value in values_of(written, templates.kinds)}
    changed = {name: word for name, word in names.items() if word != name}
    return replace(language, grammar=replace(language.grammar, names={**language.grammar.names, **changed}))


def manners_of(section: DialogueSection) -> dict[int | None, Manner]:
    """Return the manners of robots by index. The manner under the key None applies to all other robots."""

    def manner(of: MannerSection) -> Manner:
        return Manner(section.condition, of.attitude, of.persistence, of.talkative, of.gives_reasons, of.misheard)

    return {None: manner(section.manner), **{index_of(number): manner(own) for number, own in section.each.items()}}


def build_briefing(setting: StudySetting) -> Briefing:
    """Return the briefing of the participant."""
    words, shows = setting.set_words, setting.study.participant.shows
    treasures = sorted(treasure_names(setting), key=lambda name: _alphabetical(words.names.get(name, name)))
    worth = {name: {kind.points for kind in setting.templates.kinds if kind.name == name} for name in treasures}
    return Briefing(
        floor_plan=build_floor_plan(setting),
        texts=GameTexts.of(setting.texts),
        properties=setting.templates.properties,
        words=words.properties,
        names=tuple(treasures),
        called=words.names,
        pictures=setting.templates.pictures,
        consent=setting.consent,
        worth=tuple(min(each) if len(each) == 1 else None for each in worth.values()) if shows.points else (),
        answers=shows.answers,
        farewell=setting.farewell,
        sound=setting.study.participant.sound,
        kinds=known_treasures(setting.templates),
        condition=setting.study.dialogue.condition,
    )


def _alphabetical(word: str) -> str:
    """Return the sort key of a word. Letters with accents are sorted like letters without accents."""
    return unicodedata.normalize("NFKD", word).casefold()


def build_floor_plan(setting: StudySetting) -> FloorPlan:
    """Return the map that participants see, with the names of rooms in the participant's language."""
    place, names = setting.map, setting.room_names
    # Names that only repeat the number of the room, in any language, are omitted.
    called = {number: name for number, name in names.named.items() if name != setting.texts.room(number)}
    rooms = (replace(outline, name=called.get(outline.room, "")) for outline in room_outlines(setting))
    return floor_plan_of(place.name, place.grid, tuple(rooms), setting.study.world.footprint)


def room_outlines(setting: StudySetting) -> tuple[RoomOutline, ...]:
    """Return the rooms of the map, with the names that the map contains."""
    return tuple(
        RoomOutline(entry.room.people, entry.name, entry.region, (entry.goal.x, entry.goal.y, entry.goal.theta))
        for entry in setting.map.rooms
    )


def treasure_names(setting: StudySetting) -> tuple[str, ...]:
    """Return the names of treasures, in alphabetical order."""
    return tuple(sorted((kind.name for kind in setting.templates.kinds), key=str.casefold))


def known_treasures(templates: TemplateSet) -> tuple[TreasureKind, ...]:
    """Return the list of treasures without pictures, which participants may know."""
    return tuple(replace(kind, image=None) for kind in templates.kinds)


def knowledge_of(templates: TemplateSet) -> TreasureKnowledge:
    """Return the knowledge of a simulated participant, which includes the treasures in all pictures."""
    shown_by = {kind.image: kind.name for kind in templates.kinds if kind.image is not None}
    return TreasureKnowledge(known_treasures(templates), shown_by)


def build_hider(templates: TemplateSet, seed: int) -> Hider:
    """Return the role that hides the treasures."""
    return Hider(templates.kinds, seed, templates.rooms, templates.properties)


def build_participants(setting: StudySetting, strategy: str | None = None) -> tuple[TabUI, ...]:
    """Return a simulated participant for each seat of a study.

    Args:
        setting: the study.
        strategy: strategy of all participants. If None, the study has the strategies.

    Raises:
        BadFile: there is no participant with this name; see `installed_participant`.
    """
    seats = [entry.name for entry in setting.study.seats] or [ONE_SEAT.name]
    return tuple(build_participant(setting, seat, strategy) for seat in seats)


def build_participant(setting: StudySetting, seat: str, strategy: str | None = None) -> TabUI:
    """Return a simulated participant for the seat with this name; see `build_participants`."""
    study, who = setting.study, setting.study.participant
    chosen, attitude = strategy or who.strategy, who.attitude
    for entry in study.seats:
        if entry.name == seat:
            chosen, attitude = strategy or entry.strategy or who.strategy, entry.attitude or who.attitude
    bot = build_bot(setting.templates, chosen, seat_seed(study.seed, seat), attitude)
    return TabUI(bot, seat=seat, by=PlayedBy.PROGRAM)


def seat_seed(seed: int, seat: str) -> int:
    """Return the random seed of a simulated participant in a seat; `seat` is empty in a game with one participant."""
    return int(noise.key(seed, "seat", seat)) % 2**31 if seat else seed


def build_bot(
    templates: TemplateSet, strategy: str, seed: int, attitude: Attitude = Attitude.CREDULOUS
) -> Bot | InstalledParticipant:
    """Return the simulated participant with a built-in strategy, or the installed participant, with this name.

    Raises:
        BadFile: there is no participant with this name; see `installed_participant`.
    """
    knowledge = knowledge_of(templates)
    if strategy in set(BotStrategy):
        return Bot(BotStrategy(strategy), knowledge, seed, attitude)
    return installed_participant(strategy, knowledge, seed, attitude)
