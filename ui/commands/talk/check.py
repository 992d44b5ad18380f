"""Output of `thbridge talk check` and `talk words`."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from thbridge.dialogue.games.contents import ContentKind, TableWord
from thbridge.dialogue.games.locutions import CONDITIONS, EFFECTS, Postcondition, Precondition
from thbridge.dialogue.games.tables import DialogueEnd, GameRole, GameTable, Reply, Rulebook, Slot
from thbridge.dialogue.wording.language import Language
from thbridge.dialogue.wording.lines import LINES
from thbridge.dialogue.wording.predicates import PREDICATES, ValueKind
from thbridge.files.errors import BadFile, FaultCollection
from thbridge.files.game_files import SHIPPED_GAMES, read_rulebook
from thbridge.files.language_texts import advice_on_texts, read_texts
from thbridge.files.word_files import SHIPPED_LANGUAGES, check_words, languages_in


@dataclass(frozen=True, slots=True)
class TalkCheck:
    """Result of checking a folder.

    Attributes:
        folder: folder that was checked.
        games: games that the folder adds or replaces; empty if they have faults.
        languages: languages to which the folder adds words; empty if they have faults.
        faults: faults of the files.
        advice: missing parts of the languages.
    """

    folder: Path
    games: tuple[GameTable, ...] = ()
    languages: tuple[Language, ...] = ()
    faults: tuple[BadFile, ...] = ()
    advice: tuple[str, ...] = ()

    def lines(self) -> Iterator[str]:
        """Yield the output for people."""
        yield from map(str, self.faults)
        for game in self.games:
            yield from _game_lines(game)
        if self.languages:
            yield f"languages: {', '.join(f'{each.name} ({each.title})' for each in self.languages)}"
        yield from self.advice
        found = (counted("game", self.games), counted("language", self.languages), counted("fault", self.faults))
        yield f"{self.folder}: {', '.join(found)}"

    def as_json(self) -> Mapping[str, object]:
        """Return the output for programs."""
        return {
            "folder": str(self.folder),
            "games": [_game_as_json(game) for game in self.games],
            "languages": [language.name for language in self.languages],
            "faults": [
                {
                    "file": str(fault.path),
                    "line": fault.line,
                    "key": fault.key,
                    "problem": fault.problem,
                    "remedy": fault.remedy,
                }
                for fault in self.faults
            ],
            "advice": list(self.advice),
        }


def shipped_folder() -> Path:
    """Return the folder of the games that come with thbridge."""
    return SHIPPED_GAMES


def rulebook_with(folders: Sequence[Path]) -> Rulebook:
    """Return the games that come with thbridge, and the games of folders. Raise BadFile for faults."""
    return read_rulebook((SHIPPED_GAMES, *(folder for folder in folders if any(folder.glob("*.yaml")))))


def check_folder(folder: Path) -> TalkCheck:
    """Check a folder of games and of words for games, together with the files that come with thbridge."""
    faults, rulebook = FaultCollection(), read_rulebook()
    games, languages = rulebook.games, tuple[Language, ...]()
    with_words = bool(languages_in(folder))
    if folder.resolve() != SHIPPED_GAMES:
        shipped, games = games, {}
        with faults.kept():
            if any(folder.glob("*.yaml")) or not with_words:
                rulebook = read_rulebook((SHIPPED_GAMES, folder))
                games = {name: game for name, game in rulebook.games.items() if shipped.get(name) != game}
    with faults.kept():
        if with_words:
            languages = check_words(folder, locutions=rulebook.locutions)
    advice: list[str] = []
    for language in languages:
        with faults.kept():
            folders = (SHIPPED_LANGUAGES, folder)
            read_texts(folders, language.name)
            advice += filter(None, [advice_on_texts(folders, language.name)])
    return TalkCheck(folder, tuple(games.values()), languages, tuple(faults.found), tuple(advice))


def counted(what: str, things: Sequence[object]) -> str:
    """Return a phrase with the number of things, such as "2 games" or "no faults"."""
    return f"{len(things) or 'no'} {what}{'' if len(things) == 1 else 's'}"


def _game_lines(game: GameTable) -> Iterator[str]:
    yield f"{game.name}, about a {game.about}; it ends after at most {game.most_turns} moves"
    names, turns = (max(map(len, column)) for column in (game.stages, [each.turn for each in game.stages.values()]))
    for name, stage in game.stages.items():
        for at, reply in enumerate(stage.replies):
            row, turn = (name, stage.turn) if at == 0 else ("", "")
            yield f"  {row:{names}}  {turn:{turns}}  {reply.locution} {reply.slot} -> {_targets(reply)}"
    yield f"  ends: {', '.join(_ends(game))}; {DialogueEnd.STALEMATE}, when no legal move is left"


def _targets(reply: Reply) -> str:
    last = "" if reply.last is None else f"; {reply.last}, when no support is left"
    return f"{reply.next}{last}" + (
        "" if reply.questioned is None else f"; {reply.questioned}, when the refusal is questioned"
    )


def _ends(game: GameTable) -> list[str]:
    named = {target for stage in game.stages.values() for reply in stage.replies for target in reply.targets}
    return [end for end in DialogueEnd if end in named - {DialogueEnd.STALEMATE}]


def _game_as_json(game: GameTable) -> Mapping[str, object]:
    return {
        "name": game.name,
        "about": game.about,
        "opening": game.opening,
        "most_turns": game.most_turns,
        "ends": _ends(game),
        "stages": [
            {
                "name": name,
                "turn": stage.turn,
                "replies": [
                    {
                        "say": reply.locution,
                        "of": reply.slot,
                        "next": reply.next,
                        "last": reply.last,
                        "questioned": reply.questioned,
                    }
                    for reply in stage.replies
                ],
            }
            for name, stage in game.stages.items()
        ],
    }


def words() -> Iterator[str]:
    """Yield all keywords of game files and wording files, with their meanings."""
    yield from _section("content: the kind of content in one form of a locution", _meanings(ContentKind))
    yield from _section(
        "before, before_person: conditions that must hold before a locution is said", _rules(CONDITIONS)
    )
    yield from _section(
        "after: further conditions that hold after a locution is said; it also enters the speaker's commitment store",
        _rules(EFFECTS),
    )
    yield from _section("turn: the side that moves in a stage", _meanings(GameRole))
    yield from _section(
        "of: the content of a reply; in a locution, support: a form for the content of support", _meanings(Slot)
    )
    yield from _section(
        "next, last: the stage or the end that follows a reply; questioned: the stage that follows when the reply "
        "refused support, and the other side questions the refusal",
        _meanings(DialogueEnd),
    )
    yield from _section(
        "of: the belief of a phrase, with the reserved words for its values; for a room, also £to_room£", _predicates()
    )
    yield from _section(
        "key: lines that are said in addition to the moves of games, with their reserved words", _lines()
    )


def _meanings(words: Iterable[TableWord]) -> list[tuple[str, str]]:
    return [(word, word.meaning) for word in words]


def _rules(rules: Mapping[str, Precondition] | Mapping[str, Postcondition]) -> list[tuple[str, str]]:
    return [(name, f"{rule.meaning}{_kinds(rule.kinds)}") for name, rule in rules.items()]


def _predicates() -> list[tuple[str, str]]:
    return [(name, _reserved(predicate.values)) for name, predicate in PREDICATES.items()]


def _lines() -> list[tuple[str, str]]:
    rows = [(key, f"the {line.speaker}: {line.meaning}", _reserved(line.values)) for key, line in LINES.items()]
    return [(key, f"{meaning}; {words}" if words else meaning) for key, meaning, words in rows]


def _reserved(values: Mapping[str, ValueKind]) -> str:
    return " ".join(f"£{word}£" for word in values)


def _kinds(kinds: frozenset[ContentKind]) -> str:
    return "" if len(kinds) == len(ContentKind) else f" ({', '.join(kind for kind in ContentKind if kind in kinds)})"


def _section(heading: str, rows: Sequence[tuple[str, str]]) -> Iterator[str]:
    yield heading
    width = max(len(word) for word, _ in rows)
    for word, meaning in rows:
        yield f"  {word.ljust(width)}  {meaning}"
