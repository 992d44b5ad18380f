"""Study with all files that it names, read and checked."""

import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from operator import attrgetter
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from sim.common.geometry import Pose2
from sim.common.robot_numbers import index_of
from sim.common.traversability import TraversabilityMap
from sim.parameters import installed_names
from sim.robot.costmap.footprint import radii
from thbridge.app.compose.installed import installed_author, installed_strategy, participant_factory
from thbridge.app.compose.move_costs import costs_file, doubts_of_costs, read_costs
from thbridge.dialogue.conditions import DialogueCondition
from thbridge.dialogue.games.tables import Rulebook
from thbridge.dialogue.robot_strategies import StrategyFactory
from thbridge.dialogue.wording.authors import WordingAuthor
from thbridge.dialogue.wording.language import Language
from thbridge.dialogue.wording.texts import Texts
from thbridge.files.disk.regular_files import is_regular
from thbridge.files.disk.text_files import read_text
from thbridge.files.errors import BadFile, BadFiles, FaultCollection
from thbridge.files.game_files import SHIPPED_GAMES, read_rulebook
from thbridge.files.language_texts import advice_on_texts, read_texts, shipped_texts
from thbridge.files.map_files import Map, missing_room_names, read_map
from thbridge.files.resources import Resources, shipped
from thbridge.files.set_words import SetWords
from thbridge.files.template_files import TemplateSet, missing_words, read_template_set
from thbridge.files.word_files import SHIPPED_LANGUAGES, check_words, languages_in, read_language
from thbridge.files.yaml.load import Loaded
from thbridge.hunt.costs import CostMatrix
from thbridge.hunt.properties import OF_2016, TreasureProperty
from thbridge.hunt.rooms import RoomNames
from thbridge.roles.participant.bot_strategy import BotStrategy
from thbridge.study.study_file import CostModel, DialogueSection, Study

if TYPE_CHECKING:  # Only studies with installed parts need these modules.
    from sim.robot.installed_parts import InstalledParts

LARGEST_CONSENT = 8000
"""Largest size of the consent text and of the farewell, in bytes: a line must have space for a complete view."""


@dataclass(frozen=True, slots=True)
class StudySetting:
    """Study with all files that it names, read and checked. Sessions are built from this data.

    Attributes:
        study: the study.
        map: map of the study.
        templates: template set of the study.
        costs: energy of every move between places of the game.
        by_position: True if the cost of a move depends on the position of the robot; False if `costs` applies to all
            positions.
        rulebook: rulebook of the dialogue games; None if robots ask scripted questions.
        language: language in which robots argue; None if robots ask scripted questions.
        strategies: strategies of robots that argue, by index of the robot. The key None means all other robots.
            The value None means the robot's own strategy.
        author: author of wordings for robots' sentences. If None, all sentences come from the language's files.
        parts: parts of robots' software that are plug-ins; None if the study names no plug-ins.
        consent: text to which participants must agree; None if they are not asked.
        farewell: text for the end of a game; may be empty.
        texts: texts of the game's language, for participants.
        doubts: warnings about map, templates and costs, for people; the game can still be played.
    """

    study: Study
    map: Map
    templates: TemplateSet
    costs: CostMatrix
    by_position: bool
    rulebook: Rulebook | None
    language: Language | None
    strategies: Mapping[int | None, StrategyFactory | None]
    author: WordingAuthor | None
    parts: "InstalledParts | None" = None
    consent: str | None = None
    farewell: str = ""
    texts: Texts = field(default_factory=shipped_texts)
    doubts: tuple[BadFile, ...] = ()

    @property
    def room_names(self) -> RoomNames:
        """Names of the rooms in the game's language."""
        return self.map.room_names_in(self.texts.language)

    @property
    def set_words(self) -> SetWords:
        """Words of the templates in the game's language, as participants read them."""
        words = self.templates.in_language(self.texts.language)
        if self.templates.properties != OF_2016:
            return words
        # Files of 2016 have no labels, so built-in labels are used.
        return replace(words, properties=tuple(_labelled(each, self.texts) for each in words.properties))

    def floor(self) -> TraversabilityMap:
        """Return the floor of the map, for robots with the study's footprint."""
        return _floor(self.study, self.map)


def _labelled(declared: TreasureProperty, texts: Texts) -> TreasureProperty:
    """Return a property of 2016 with a label in a language; unchanged if the set has words for this property."""
    label = texts.text(f"properties.{declared.name}") if declared in OF_2016 else declared.label
    return replace(declared, label=label)


def read_setting(
    study: Study, beside: Path, resources: Resources | None = None, written: Loaded[Study] | None = None
) -> StudySetting:
    """Read the files that a study names.

    Args:
        study: the study.
        beside: folder to which paths in the study are relative.
        resources: maps and templates that are known by name. If None, these are the built-in maps and templates.
        written: the study as it was read from its file, so that errors contain lines; None if the study has no file.

    Raises:
        BadFile: a file is missing or wrong, or files do not fit together. BadFiles contains several faults.
    """
    resources = resources or shipped()
    faults, keys = FaultCollection(), StudyKeys(study, written, resources)
    place: Map | None = None
    templates: TemplateSet | None = None
    costs: CostMatrix | None = None
    doubts: tuple[BadFile, ...] = ()
    by_position, consent, farewell = False, None, ""
    rulebook: Rulebook | None = None
    language: Language | None = None
    texts = shipped_texts()
    strategies: dict[int | None, StrategyFactory | None] = {}
    author: WordingAuthor | None = None
    parts: InstalledParts | None = None
    with faults.kept():
        place = read_map_of(study, beside, resources, written=written)
    with faults.kept():
        with keys.naming("templates"):
            folder = resources.find("templates", study.templates, beside)
        templates = read_template_set(folder)
    if place is not None and templates is not None:
        with faults.kept():
            path = costs_file(study, beside, place, folder, templates, resources)
            with keys.naming("game.costs", study.game.costs is not None and not is_regular(path)):
                costs = read_costs(path, place)
            doubts = tuple(doubts_of_costs(path, costs, study, place, templates, resources))
            model = study.game.cost_model
            by_position = path == place.costs if model is None else model is CostModel.POSITION
    talk = study.dialogue
    games = () if talk.games is None else (beside / talk.games,)
    # The rulebook is read only if needed, because reading it takes 0.2 s.
    if talk.condition is not DialogueCondition.SCRIPT or (talk.games, talk.words, talk.language) != (None, None, "en"):
        # If the folder is missing, the error names the line of the study. If files in the folder have faults, the error
        # names the lines of these files.
        with faults.kept(), keys.naming("dialogue.games", not all(folder.is_dir() for folder in games)):
            rulebook = read_rulebook((SHIPPED_GAMES, *games))
            with faults.kept():
                language = _language(talk, beside, keys, rulebook)
                texts = texts_of(study, beside)
    with faults.kept(), keys.naming("dialogue.author"):
        author = None if talk.author is None else installed_author(talk.author)
    for robot, key, name in _strategy_names(talk):
        with faults.kept(), keys.naming(key):
            strategies[robot] = None if name is None else installed_strategy(name)
    with faults.kept():
        parts = _parts(study, keys)
    with faults.kept(), keys.naming("participant.strategy"):
        if study.participant.strategy not in set(BotStrategy):
            participant_factory(study.participant.strategy)
    with faults.kept(), keys.naming("participant.consent"):
        consent = _consent(study, beside)
    with faults.kept(), keys.naming("participant.farewell"):
        farewell = _farewell(study, beside)
    if faults.found or place is None or templates is None or costs is None:
        raise faults.together()
    return StudySetting(
        study,
        place,
        templates,
        costs,
        by_position,
        rulebook,
        language,
        strategies,
        author,
        parts,
        consent,
        farewell,
        texts,
        (*place.warnings, *templates.warnings, *doubts),
    )


def _parts(study: Study, keys: "StudyKeys") -> "InstalledParts | None":
    """Return the parts of robots' software that are plug-ins; None if the study names no plug-ins."""
    robots = {"robot": study.robot, **{f"each.{number}": software for number, software in study.each.items()}}
    named = [(key, *part) for key, software in robots.items() for part in installed_names(software)]
    if not named:
        return None
    # The import is here, so that a text server, which has no robots, does not load the software of robots.
    from thbridge.app.compose.installed_parts import installed_parts, load_part  # noqa: PLC0415

    faults = FaultCollection()
    for key, kind, parameter, name in named:
        with faults.kept(), keys.naming(f"{key}.{parameter}"):
            load_part(kind, name)
    faults.raise_any()
    return installed_parts(robots.values())


def _strategy_names(talk: DialogueSection) -> Iterator[tuple[int | None, str, str | None]]:
    """Yield index of the robot, key of the study and name of the strategy, for each robot with a separate strategy.

    The common strategy of all other robots comes first, with the index None.
    """
    common = talk.strategy_of(talk.manner)
    yield None, "dialogue.strategy" if talk.manner.strategy is None else "dialogue.manner.strategy", common
    for number, manner in talk.each.items():
        if (name := talk.strategy_of(manner)) != common:
            yield index_of(number), f"dialogue.each.{number}.strategy", name


def _language(talk: DialogueSection, beside: Path, keys: "StudyKeys", rulebook: Rulebook) -> Language:
    """Return the language in which robots argue; words in the study's folder of words replace built-in words."""
    folders = _folders(talk, beside)
    if talk.words is not None:
        with keys.naming("dialogue.words", not languages_in(folders[-1])):
            check_words(folders[-1], locutions=rulebook.locutions)
    known = {name for folder in folders for name in languages_in(folder)}
    with keys.naming("dialogue.language", talk.language not in known):
        return read_language(folders, talk.language, locutions=rulebook.locutions)


def texts_of(study: Study, beside: Path) -> Texts:
    """Return the texts of a study's language; texts in the study's folder of words replace built-in texts.

    Args:
        study: the study.
        beside: folder to which paths in the study are relative.

    Raises:
        BadFile: a file is missing or wrong. BadFiles contains several faults.
    """
    talk = study.dialogue
    return shipped_texts(talk.language) if talk.words is None else read_texts(_folders(talk, beside), talk.language)


def missing_in(study: Study, beside: Path, resources: Resources | None = None) -> tuple[BadFile, ...]:
    """Return the words of a study's map and templates that are missing in the study's language.

    The result names the files in which to write these words. The arguments are as in `read_setting`.

    Raises:
        BadFile: map or templates have a fault.
    """
    resources, language = resources or shipped(), study.dialogue.language
    maps, sets = (resources.find(*named, beside) for named in (("maps", study.map), ("templates", study.templates)))
    of_map = missing_room_names(read_map(maps, study.world.footprint, with_costs=False), maps, language)
    return (*of_map, *missing_words(read_template_set(sets), sets, language))


def advice_on_language(study: Study, beside: Path) -> str | None:
    """Return a sentence about texts that are missing in a study's language; None if no text is missing.

    The arguments are as in `texts_of`.
    """
    return advice_on_texts(_folders(study.dialogue, beside), study.dialogue.language)


def _folders(talk: DialogueSection, beside: Path) -> list[Path]:
    """Return the folders with languages for a study."""
    return [SHIPPED_LANGUAGES] if talk.words is None else [SHIPPED_LANGUAGES, beside / talk.words]


class StudyKeys:
    """Converter of faults in files that a study names into faults in lines of the study's own file.

    Args:
        study: the study; some values may not come from the study's file.
        written: the study as it was read from its file; None if the study has no file.
        resources: maps and templates that are known by name.
    """

    def __init__(self, study: Study, written: Loaded[Study] | None, resources: Resources) -> None:
        self._study = study
        self._written = written
        self._resources = resources

    def fault(self, key: str, fault: BadFile) -> BadFile:
        """Convert a fault into a fault in the key's line, unless the value of the key does not come from the file."""
        written = self._written
        if written is None or attrgetter(_field(key))(written.value) != attrgetter(_field(key))(self._study):
            return fault
        # An unknown name is a fault only of the study, so the message does not name the searched folder.
        unknown = fault.path.parent == self._resources.root
        problem = fault.problem if unknown else f"{fault.path}: {fault.problem}"
        return written.fault(key, problem, fault.remedy)

    @contextmanager
    def naming(self, key: str, when: bool = True) -> Iterator[None]:
        """Convert a fault that is raised in this context into a fault in the key's line.

        If `when` is False, do not convert it.
        """
        try:
            yield
        except BadFile as fault:
            raise (self.fault(key, fault) if when else fault) from None


def _field(key: str) -> str:
    """Return the path of a study's key without indices of lists and numbers in mappings."""
    return re.split(r"\[|\.\d", key)[0]


def read_map_of(
    study: Study,
    beside: Path,
    resources: Resources | None = None,
    *,
    with_costs: bool = True,
    written: Loaded[Study] | None = None,
) -> Map:
    """Read the map that a study names, and check that the study's robots fit on it.

    Args:
        study: the study.
        beside: folder to which paths in the study are relative.
        resources: maps that are known by name. If None, these are the built-in maps.
        with_costs: False if travel costs are not needed; see `read_map`.
        written: as in `read_setting`.

    Raises:
        BadFile: the map has a fault, or the study does not fit the map.
    """
    resources = resources or shipped()
    keys = StudyKeys(study, written, resources)
    with keys.naming("map"):
        folder = resources.find("maps", study.map, beside)
    place = read_map(folder, study.world.footprint, with_costs=with_costs)
    most = study.participant.robots or (0, 0)
    largest = max(study.robots, *most)
    if largest > len(place.starts):
        problem = f"there are start poses for {len(place.starts)} robots, but the study has {largest}"
        few = BadFile(folder / "rooms.yaml", problem, "add start poses or lower `robots` in the study", key="starts")
        raise keys.fault("robots" if study.robots == largest else "participant.robots", few)
    faults = tuple(keys.fault(key, fault) for key, fault in _misplaced(study, place, folder / "map.yaml"))
    if faults:
        raise BadFiles(faults)
    return place


def _consent(study: Study, beside: Path) -> str | None:
    """Return the consent text that the study names; None if the study names no consent text."""
    if study.participant.consent is None:
        return None
    path = beside / study.participant.consent
    text = read_text(path, LARGEST_CONSENT).strip()
    if not text:
        problem, remedy = "the consent text is empty", "write a text, or delete `participant: consent:` in the study"
        raise BadFile(path, problem, remedy)
    return text


def _farewell(study: Study, beside: Path) -> str:
    """Return the text for the end of a game; empty if the study names no farewell."""
    farewell = study.participant.farewell
    return "" if farewell is None else read_text(beside / farewell, LARGEST_CONSENT).strip()


def _floor(study: Study, place: Map) -> TraversabilityMap:
    """Return the floor of a map, for robots with the study's footprint."""
    return TraversabilityMap.of(place.grid, *radii(np.array(study.world.footprint)))


def _misplaced(study: Study, place: Map, map_yaml: Path) -> Iterator[tuple[str, BadFile]]:
    """Yield a key of the study and a fault for each scheduled failure that moves a robot into a wall or off the map."""
    carried = [(index, mishap, mishap.to) for index, mishap in enumerate(study.mishaps) if mishap.to is not None]
    floor = _floor(study, place) if carried else None
    for index, mishap, (x, y, yaw) in carried:
        if floor is not None and floor.clearance_at(Pose2(x, y, yaw)) < floor.inscribed:
            problem = f"robot {mishap.robot} would be moved to ({x:g}, {y:g}), where it does not fit on this map"
            key = f"mishaps[{index}].to"
            yield key, BadFile(map_yaml, problem, f"correct {key} in the study")
