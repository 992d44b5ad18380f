"""Words of `thbridge talk check` and `talk words`."""

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
    """Result of the check of a folder.

    Attributes:
        folder: the folder.
        games: those that it adds or replaces; none where they have faults.
        languages: those that it adds words to; likewise.
        faults: of its files.
        advice: what its languages lack.
    """

    folder: Path
    games: tuple[GameTable, ...] = ()
    languages: tuple[Language, ...] = ()
    faults: tuple[BadFile, ...] = ()
    advice: tuple[str, ...] = ()

    def lines(self) -> Iterator[str]:
        """Yield what people are told."""
        yield from map(str, self.faults)
        for game in self.games:
            yield from _game_lines(game)
        if self.languages:
            yield f"languages: {', '.join(f'{each.name} ({each.title})' for each in self.languages)}"
        yield from self.advice
        found = (counted("game", self.games), counted("language", self.languages), counted("fault", self.faults))
        yield f"{self.folder}: {', '.join(found)}"

    def as_json(self) -> Mapping[str, object]:
        """Return what programs are told."""
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
    """Return the folder of the games that come with the project."""
    return SHIPPED_GAMES


def rulebook_with(folders: Sequence[Path]) -> Rulebook:
    """Return the shipped games with those of folders. Raises BadFile for faults."""
    return read_rulebook((SHIPPED_GAMES, *(folder for folder in folders if any(folder.glob("*.yaml")))))


def check_folder(folder: Path) -> TalkCheck:
    """Check all that a folder holds about dialogues, beside what comes with the project: games, and words for them."""
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
    """Return the number of things, as people say it."""
    return f"{len(things) or 'no'} {what}{'' if len(things) == 1 else 's'}"


def _game_lines(game: GameTable) -> Iterator[str]:
    yield f"{game.name}, about a {game.about}; it ends after {game.most_turns} moves at the latest"
    names, turns = (max(map(len, column)) for column in (game.stages, [each.turn for each in game.stages.values()]))
    for name, stage in game.stages.items():
        for at, reply in enumerate(stage.replies):
            row, turn = (name, stage.turn) if at == 0 else ("", "")
            yield f"  {row:{names}}  {turn:{turns}}  {reply.locution} {reply.slot} -> {_targets(reply)}"
    yield f"  ends: {', '.join(_ends(game))}; {DialogueEnd.STALEMATE}, when nothing legal is left to say"


def _targets(reply: Reply) -> str:
    last = "" if reply.last is None else f"; {reply.last}, when no support is left"
    return f"{reply.next}{last}" + (
        "" if reply.questioned is None else f"; {reply.questioned}, when that is questioned"
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
    """Yield all words of files of games and of words for them, with their meanings."""
    yield from _section("content: what a form of a locution is about", _meanings(ContentKind))
    yield from _section("before, before_person: what must hold before a locution is said", _rules(CONDITIONS))
    yield from _section(
        "after: what holds after it; besides, it enters the speaker's commitment store", _rules(EFFECTS)
    )
    yield from _section("turn: whose turn it is in a stage", _meanings(GameRole))
    yield from _section(
        "of: what a reply is about; in a locution, support: a form for what is said as support", _meanings(Slot)
    )
    yield from _section(
        "next, last: the stage that follows a reply, or an end; questioned: the stage that follows when the game has "
        "ended by the reply, and that is questioned in another game",
        _meanings(DialogueEnd),
    )
    yield from _section(
        "of: what a phrase says, with the reserved words for its values; of a room, £to_room£, too", _predicates()
    )
    yield from _section("key: lines that are said beside the moves of games, with their reserved words", _lines())


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
