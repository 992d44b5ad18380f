"""Reading of the words of arguing robots: YAML files, one folder per language, checked so that no sentence can fail."""

import dataclasses
import difflib
import unicodedata
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from thbridge.dialogue.argumentation.cases import Side
from thbridge.dialogue.games.contents import ContentKind
from thbridge.dialogue.games.locutions import Locution
from thbridge.dialogue.sentences import reserved_in, spelling_fault
from thbridge.dialogue.wording.authors import can_be_found
from thbridge.dialogue.wording.language import AboutRobot, Grammar, Language, MoveWording, PhraseWording
from thbridge.dialogue.wording.lines import LINES, LineKey
from thbridge.dialogue.wording.predicates import PREDICATES, Predicate, ValueKind, reserved_words
from thbridge.files.disk.inside import path_inside
from thbridge.files.errors import BadFile, BadFiles, FaultCollection
from thbridge.files.game_files import read_rulebook
from thbridge.files.resources import PACKAGE
from thbridge.files.yaml.load import Loaded, load

SHIPPED_LANGUAGES = PACKAGE / "dialogue" / "wording" / "languages"
"""Folder of the built-in languages."""
LONGEST_WORDING = 500
"""Largest length of a wording, in characters."""

_WORDS_OF_CONTENT: Mapping[ContentKind, tuple[str, ...]] = {
    ContentKind.LITERAL: ("content",),
    ContentKind.RULE: ("content",),
    ContentKind.ARGUMENT: ("conclusion", "support"),
    ContentKind.UNKNOWN: ("content",),
}
"""Words for the whole content of a move. A wording that does not name the values needs all of these words."""


@dataclass(frozen=True, slots=True)
class LanguageHead:
    """Name and grammar of a language.

    Attributes:
        path: the file with its section `language`.
        title: name of the language in itself, such as `English`.
        plural: index of the plural form for a number n; see `TextForms`.
        falls_back_on: language that is used where this language lacks words, or None.
        grammar: grammar of the language, or of the language on which it falls back.
    """

    path: Path
    title: str
    plural: str
    falls_back_on: str | None
    grammar: Grammar


@dataclass(frozen=True, slots=True)
class _LanguageYaml:
    title: str
    falls_back_on: str | None = None
    plural: str = "n != 1"


@dataclass(frozen=True, slots=True)
class _GrammarYaml:
    room: str
    to_room: str
    from_room: str
    in_room: str
    corridor: str
    to_corridor: str
    from_corridor: str
    in_corridor: str
    robot: str
    picture: str
    one_room: str
    many_rooms: str
    between: str
    between_clauses: str
    last_and: str
    last_or: str
    rule: str
    decimal: str
    capital_after_colon: bool
    negations: tuple[str, ...]
    bound: tuple[str, ...]
    first_stop: str = "£to_room£"
    next_stop: str = "£to_room£"
    names: Mapping[str, str] = dataclasses.field(default_factory=dict)
    capital_nouns: bool = False


@dataclass(frozen=True, slots=True)
class _LineYaml:
    key: str
    say: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class _WordsYaml:
    language: _LanguageYaml | None = None
    grammar: _GrammarYaml | None = None
    phrases: tuple[PhraseWording, ...] = ()
    moves: tuple[MoveWording, ...] = ()
    lines: tuple[_LineYaml, ...] = ()


def languages_in(folder: Path) -> tuple[str, ...]:
    """Return the names of the languages in a folder, in alphabetical order. A language may have only texts."""
    files = (*folder.glob("*/*.yaml"), *folder.glob("*/texts/*.yaml"))
    return tuple(sorted({path.relative_to(folder).parts[0] for path in files}))


def read_language(
    folders: Iterable[Path] = (SHIPPED_LANGUAGES,), name: str = "en", *, locutions: Sequence[Locution] | None = None
) -> Language:
    """Read a language, and the languages that it falls back on.

    Args:
        folders: folders with a subfolder for each language; wordings of a later folder replace earlier wordings for the
            same case.
        name: name of the language's folder.
        locutions: locutions that need words. If None, the built-in locutions are used.

    Raises:
        BadFile: a fault of a file, or all faults together; or the language does not exist or lacks words.
    """
    folders = tuple(folders)
    locutions = read_rulebook().locutions if locutions is None else locutions
    language = _read(folders, name, {each.name for each in locutions}, ())
    folder = next(path_inside(folder, name) for folder in reversed(folders) if name in languages_in(folder))
    faults = tuple(_lacking(folder, language, locutions))
    if faults:
        raise BadFiles(faults)
    return language


def check_words(folder: Path, *, locutions: Sequence[Locution] | None = None) -> tuple[Language, ...]:
    """Return the languages of a folder, read together with the built-in languages.

    Raises:
        BadFile: a fault of a file, or all faults together; or the folder has no language.
    """
    names = languages_in(folder)
    if not names:
        problem = "this folder has no language" if folder.is_dir() else "there is no such folder"
        raise BadFile(folder, problem, "Create a subfolder for each language, such as en, with .yaml files")
    faults, read = FaultCollection(), []
    for name in names:
        with faults.kept():
            read.append(read_language((SHIPPED_LANGUAGES, folder), name, locutions=locutions))
    if faults.found:
        raise faults.together()
    return tuple(read)


def read_head(folders: Sequence[Path], name: str) -> LanguageHead:
    """Read the name and grammar of a language. Raises BadFile as `read_language` does."""
    return _head([loaded for of_folder in _load(folders, name) for loaded in of_folder], folders, name, ())


def _read(folders: Sequence[Path], name: str, locutions: Collection[str], above: tuple[str, ...]) -> Language:
    """Read a language without checking for missing words; `above` are the languages that fall back on it."""
    by_folder = _load(folders, name)
    files = [loaded for of_folder in by_folder for loaded in of_folder]
    faults = FaultCollection()
    for of_folder in by_folder:
        for loaded in of_folder:
            faults.found += _faults(loaded, locutions)
        faults.found += _doubles(of_folder)
    if faults.found:
        raise faults.together()
    head = _head(files, folders, name, above)
    back = head.falls_back_on
    return Language(
        name,
        head.title,
        head.grammar,
        tuple(each for loaded in files for each in loaded.value.phrases),
        tuple(each for loaded in files for each in loaded.value.moves),
        {LineKey(each.key): each.say for loaded in files for each in loaded.value.lines},
        None if back is None else _read(folders, back, locutions, (name, *above)),
    )


def _load(folders: Sequence[Path], name: str) -> list[list[Loaded[_WordsYaml]]]:
    """Load the files of a language, a list for each folder."""
    known = sorted({each for folder in folders for each in languages_in(folder)})
    if name not in known:
        raise BadFile(folders[-1] / name, f"language {name} does not exist", _nearest(name, known))
    faults = FaultCollection()
    loaded: list[list[Loaded[_WordsYaml]]] = []
    for folder in folders:
        loaded.append([])
        for path in sorted(path_inside(folder, name).glob("*.yaml")):
            with faults.kept():
                loaded[-1].append(load(path, _WordsYaml))
    if faults.found:
        raise faults.together()
    return loaded


def _head(
    files: Sequence[Loaded[_WordsYaml]], folders: Sequence[Path], name: str, above: tuple[str, ...]
) -> LanguageHead:
    """Return the name and grammar of a language from its files; `above` are the languages that fall back on it."""
    headed = next((loaded for loaded in reversed(files) if loaded.value.language is not None), None)
    if headed is None or headed.value.language is None:
        remedy = "Add to one of its files: language: {title: ..., falls_back_on: en}"
        raise BadFile(path_inside(folders[-1], name), "this language has no section 'language'", remedy)
    head, key = headed.value.language, "language.falls_back_on"
    back = head.falls_back_on
    if back in (name, *above):
        raise headed.fault(key, "languages fall back on each other in a circle", "Write null")
    known = sorted({each for folder in folders for each in languages_in(folder)})
    if back is not None and back not in known:
        raise headed.fault(key, f"language {back} does not exist", _nearest(back, known))
    written = next((loaded.value.grammar for loaded in reversed(files) if loaded.value.grammar is not None), None)
    if written is None and back is None:
        remedy = "Add a section grammar, or let the language fall back on a language that has one"
        raise headed.fault("language", "this language has no section 'grammar'", remedy)
    if written is not None:
        return LanguageHead(headed.path, head.title, head.plural, back, _grammar(written))
    others = [loaded for of_folder in _load(folders, str(back)) for loaded in of_folder]
    grammar = _head(others, folders, str(back), (name, *above)).grammar
    return LanguageHead(headed.path, head.title, head.plural, back, grammar)


def _grammar(written: _GrammarYaml) -> Grammar:
    return Grammar(
        rooms={"": written.room, "to": written.to_room, "from": written.from_room, "in": written.in_room},
        corridor={
            "": written.corridor,
            "to": written.to_corridor,
            "from": written.from_corridor,
            "in": written.in_corridor,
        },
        first_stop=written.first_stop,
        next_stop=written.next_stop,
        robot=written.robot,
        picture=written.picture,
        one_room=written.one_room,
        many_rooms=written.many_rooms,
        between=written.between,
        between_clauses=written.between_clauses,
        last_and=written.last_and,
        last_or=written.last_or,
        rule=written.rule,
        decimal=written.decimal,
        capital_after_colon=written.capital_after_colon,
        negations=frozenset(word.casefold() for word in written.negations),
        bound=frozenset(word.casefold() for word in written.bound),
        names=written.names,
        capital_nouns=written.capital_nouns,
    )


def _faults(loaded: Loaded[_WordsYaml], locutions: Collection[str]) -> Iterator[BadFile]:
    """Yield the faults of one file."""
    if loaded.value.grammar is not None:
        yield from _grammar_faults(loaded, loaded.value.grammar)
    for place, phrase in enumerate(loaded.value.phrases):
        yield from _phrase_faults(loaded, f"phrases[{place}]", phrase)
    for place, move in enumerate(loaded.value.moves):
        yield from _move_faults(loaded, f"moves[{place}]", move, locutions)
    for place, line in enumerate(loaded.value.lines):
        key = f"lines[{place}]"
        if line.key in set(LineKey):
            allowed = reserved_words(LINES[LineKey(line.key)].values)
            yield from _wording_faults(loaded, f"{key}.say", line.say, allowed, ())
            if not line.say:
                yield _no_wording(loaded, f"{key}.say")
        else:
            yield loaded.fault(f"{key}.key", f"line {line.key} does not exist", _nearest(line.key, list(LineKey)))


def _grammar_faults(loaded: Loaded[_WordsYaml], grammar: _GrammarYaml) -> Iterator[BadFile]:
    number, stop = {"number": "number"}, reserved_words({"room": ValueKind.ROOM})
    forms: dict[str, tuple[str, Mapping[str, str]]] = {
        "room": (grammar.room, number),
        "to_room": (grammar.to_room, number),
        "from_room": (grammar.from_room, number),
        "in_room": (grammar.in_room, number),
        "corridor": (grammar.corridor, {}),
        "to_corridor": (grammar.to_corridor, {}),
        "from_corridor": (grammar.from_corridor, {}),
        "in_corridor": (grammar.in_corridor, {}),
        "first_stop": (grammar.first_stop, stop),
        "next_stop": (grammar.next_stop, stop),
        "robot": (grammar.robot, number),
        "picture": (grammar.picture, number),
        "one_room": (grammar.one_room, {}),
        "many_rooms": (grammar.many_rooms, number),
        "rule": (grammar.rule, {"premises": "premises", "conclusion": "conclusion"}),
        "between": (grammar.between, {}),
        "between_clauses": (grammar.between_clauses, {}),
        "last_and": (grammar.last_and, {}),
        "last_or": (grammar.last_or, {}),
        **{f"names.{name}": (said, {}) for name, said in grammar.names.items()},
    }
    for name, (form, words) in forms.items():
        for problem, remedy in _wrong_in(form, words, words.values()):
            yield loaded.fault(f"grammar.{name}", problem, remedy)
    if "1" not in grammar.one_room:
        yield loaded.fault("grammar.one_room", "the form for a single room needs the number 1", "Write 1 in it")
    if grammar.decimal not in {".", ","}:
        yield loaded.fault("grammar.decimal", "not a decimal mark", 'Write "." or ","')
    if not grammar.negations:
        remedy = "Write all words that negate a sentence"
        yield loaded.fault("grammar.negations", "a language needs negations", remedy)
    for name, listed in (("negations", grammar.negations), ("bound", grammar.bound)):
        for place, word in enumerate(listed):
            if not can_be_found(word.casefold()):
                remedy = "Write each word alone, without blanks and signs; a * in front means the end of words"
                yield loaded.fault(f"grammar.{name}[{place}]", f"{word!r} is not one word", remedy)


def _phrase_faults(loaded: Loaded[_WordsYaml], key: str, phrase: PhraseWording) -> Iterator[BadFile]:
    predicate = PREDICATES.get(phrase.of)
    if predicate is None:
        yield loaded.fault(f"{key}.of", f"predicate {phrase.of} does not exist", _nearest(phrase.of, list(PREDICATES)))
        return
    if phrase.robot is not None and predicate.robot is None:
        yield loaded.fault(f"{key}.robot", f"{phrase.of} is not about a robot", "Delete the key")
    allowed, needed = reserved_words(predicate.values), _needed(predicate, phrase.robot)
    said: Mapping[str, tuple[str, ...]] = {
        "yes": phrase.yes,
        "no": phrase.no,
        "simply_yes": phrase.simply_yes,
        "simply_no": phrase.simply_no,
        "yes_without_energy": phrase.yes_without_energy,
        "no_without_energy": phrase.no_without_energy,
    }
    amounts = {name for name, kind in predicate.values.items() if kind in {ValueKind.ENERGY, ValueKind.SUM}}
    if not any(said.values()):
        yield _no_wording(loaded, f"{key}.yes")
    for name, wordings in said.items():
        whole, possible = () if name.startswith("simply") else needed, allowed
        if name.endswith("energy"):
            whole, possible = needed - amounts, {word: of for word, of in allowed.items() if of not in amounts}
        yield from _wording_faults(loaded, f"{key}.{name}", wordings, possible, (whole,))
        for place, wording in enumerate(wordings):
            if wording.rstrip().endswith((".", "?", "!")):
                problem = "a phrase is a part of a sentence, so it does not end the sentence"
                yield loaded.fault(f"{key}.{name}[{place}]", problem, "Delete the punctuation mark at its end")
    for place, wording in enumerate(phrase.yes):
        if wording in phrase.no:
            problem = "the same words are used for yes and for no"
            yield loaded.fault(f"{key}.yes[{place}]", problem, "Write the negation in 'no'")


def _move_faults(
    loaded: Loaded[_WordsYaml], key: str, move: MoveWording, locutions: Collection[str]
) -> Iterator[BadFile]:
    if move.move not in locutions:
        yield loaded.fault(f"{key}.move", f"locution {move.move} does not exist", _nearest(move.move, locutions))
    whole = _WORDS_OF_CONTENT[move.content]
    allowed, ways = dict(zip(whole, whole, strict=True)), [frozenset(whole)]
    if move.of is not None:
        predicate = PREDICATES.get(move.of)
        if predicate is None:
            yield loaded.fault(f"{key}.of", f"predicate {move.of} does not exist", _nearest(move.of, list(PREDICATES)))
            return
        if move.content is ContentKind.RULE:
            yield loaded.fault(f"{key}.of", "wordings for rules apply to all predicates", "Delete the key")
        if move.robot is not None and predicate.robot is None:
            yield loaded.fault(f"{key}.robot", f"{move.of} is not about a robot", "Delete the key")
        allowed |= reserved_words(predicate.values)
        if move.holds is not None or move.content is ContentKind.UNKNOWN:
            ways.append(_needed(predicate, move.robot) | (set(whole) - {"content", "conclusion"}))
    if not move.say:
        yield _no_wording(loaded, f"{key}.say")
    yield from _wording_faults(loaded, f"{key}.say", move.say, allowed, ways)


def _needed(predicate: Predicate, robot: AboutRobot | None) -> frozenset[str]:
    """Return the values that a wording must name: all values, except a robot that speaks of itself."""
    return frozenset(predicate.values) - ({predicate.robot} if robot is AboutRobot.SELF else set())


def _wording_faults(
    loaded: Loaded[_WordsYaml],
    key: str,
    wordings: Sequence[str],
    allowed: Mapping[str, str],
    ways: Sequence[Collection[str]],
) -> Iterator[BadFile]:
    """Yield faults of wordings.

    A wording may use only the allowed words, and must name all values of one of these sets.
    """
    for place, wording in enumerate(wordings):
        for problem, remedy in _wrong_in(wording, allowed, *ways):
            yield loaded.fault(f"{key}[{place}]", problem, remedy)


def _wrong_in(wording: str, allowed: Mapping[str, str], *ways: Collection[str]) -> Iterator[tuple[str, str]]:
    """Yield problems of a wording, with their remedies."""
    if not wording.strip():
        yield "the wording is empty", "Write some words"
    if strange := next((sign for sign in wording if not sign.isprintable()), None):
        character = f"{unicodedata.name(strange, 'a line break or control sign').lower()}, U+{ord(strange):04X}"
        yield (
            f"a character that cannot be printed: {character}",
            "Write one line of printable characters and plain blanks",
        )
    if len(wording) > LONGEST_WORDING:
        yield f"{len(wording)} characters are too many", f"Write at most {LONGEST_WORDING} characters"
    fault = spelling_fault(wording, allowed)
    if fault is not None:
        yield fault.problem, fault.remedy
        return
    named = {allowed[word] for word in reserved_in(wording)}
    missing = [sorted(set(needed) - named) for needed in ways]
    if missing and all(missing):
        least = min(missing, key=len)
        words = " and ".join(f"£{value}£" for value in least)
        yield f"this sentence must contain {words}", f"Add {words} to it"


def _no_wording(loaded: Loaded[_WordsYaml], key: str) -> BadFile:
    return loaded.fault(key, "there is no wording", "Write at least one wording between [ and ]")


def _doubles(of_folder: Iterable[Loaded[_WordsYaml]]) -> Iterator[BadFile]:
    """Yield faults of sections and wordings that a folder has twice, because only one of the two would be used."""
    first: dict[tuple[object, ...], str] = {}
    for loaded in of_folder:
        value = loaded.value
        entries: list[tuple[str, tuple[object, ...]]] = []
        if value.language is not None:
            entries.append(("language", ("language",)))
        if value.grammar is not None:
            entries.append(("grammar", ("grammar",)))
        entries += [(f"phrases[{at}]", ("phrase", each.of, *each.narrowing)) for at, each in enumerate(value.phrases)]
        entries += [
            (f"moves[{at}]", ("move", each.move, each.content, each.speaker, *each.narrowing))
            for at, each in enumerate(value.moves)
        ]
        entries += [(f"lines[{at}]", ("line", each.key)) for at, each in enumerate(value.lines)]
        for key, narrowed in entries:
            place = f"{loaded.path.name}, line {loaded.lines.get(key, 1)}"
            if narrowed in first:
                problem = f"the same case is already in {first[narrowed]}"
                yield loaded.fault(key, problem, "Keep one of the two, with all wordings in it")
            first.setdefault(narrowed, place)


def _lacking(folder: Path, language: Language, locutions: Sequence[Locution]) -> Iterator[BadFile]:
    """Yield a fault for each word that a language and its fallback languages lack."""
    or_fall_back = "or let the language fall back on another language"
    for name, predicate in PREDICATES.items():
        robots = (None,) if predicate.robot is None else tuple(AboutRobot)
        for holds in (True, False):
            word = "yes" if holds else "no"
            if not all(language.phrase(name, side, robot, holds=holds) for side in Side for robot in robots):
                remedy = f"Add to phrases: {{of: {name}, {word}: [...]}}, {or_fall_back}"
                yield BadFile(
                    folder, f"phrase {name} with '{word}' does not cover every speaker and robot", remedy, key="phrases"
                )
    for name, content in dict.fromkeys((each.name, each.content) for each in locutions):
        for side in Side:
            if not language.move(name, content, side, holds=False) or not language.move(name, content, side):
                written = f"{{move: {name}, content: {content}, speaker: {side}, say: [...]}}"
                problem = f"some cases of {name} with a {content}, said by the {side}, have no wording"
                yield BadFile(folder, problem, f"Add to moves: {written}, {or_fall_back}", key="moves")
    for key, line in LINES.items():
        if not language.line(key):
            problem = f"line {key} for the {line.speaker} is missing: {line.meaning}"
            yield BadFile(folder, problem, f"Add to lines: {{key: {key}, say: [...]}}, {or_fall_back}", key="lines")


def _nearest(name: str, known: Iterable[str]) -> str:
    choices = sorted(known)
    near = difflib.get_close_matches(name, choices, n=1)
    return f"The nearest name is {near[0]}" if near else f"Write one of: {', '.join(choices)}"
