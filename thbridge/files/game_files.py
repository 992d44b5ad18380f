"""Reads dialogue games and their locutions: YAML files, checked until nothing in them can go wrong in a dialogue."""

import dataclasses
import difflib
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from sim.parameters import param
from thbridge.dialogue.games.contents import ContentKind
from thbridge.dialogue.games.locutions import CONDITIONS, EFFECTS, Locution
from thbridge.dialogue.games.tables import DialogueEnd, GameRole, GameStage, GameTable, Reply, Rulebook, Slot
from thbridge.files.errors import BadFile, BadFiles, FaultCollection
from thbridge.files.resources import PACKAGE
from thbridge.files.yaml.load import Loaded, load

LOCUTIONS = "locutions.yaml"
SHIPPED_GAMES = PACKAGE / "dialogue" / "games" / "rules"
"""The folder of the games that come with the project."""
_KINDS_OF_SLOT: Mapping[tuple[Slot, str], tuple[ContentKind, ...]] = {
    **{(slot, about): (ContentKind(about),) for slot in Slot for about in ("literal", "rule")},
    **{(Slot.ARGUMENT, about): (ContentKind.ARGUMENT,) for about in ("literal", "rule")},
    **{(Slot.UNKNOWN, about): (ContentKind.UNKNOWN,) for about in ("literal", "rule")},
    **{(Slot.SUPPORT, about): (ContentKind.LITERAL,) for about in ("literal", "rule")},
}


@dataclass(frozen=True, slots=True)
class _LocutionYaml:
    name: str
    content: ContentKind
    before: tuple[str, ...] = ()
    before_person: tuple[str, ...] = ()
    after: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class _LocutionsYaml:
    locutions: tuple[_LocutionYaml, ...]


@dataclass(frozen=True, slots=True)
class _ReplyYaml:
    say: str
    of: Slot
    next: str
    last: str | None = None


@dataclass(frozen=True, slots=True)
class _StageYaml:
    name: str
    turn: GameRole
    replies: tuple[_ReplyYaml, ...]


@dataclass(frozen=True, slots=True)
class _GameYaml:
    name: str
    about: Literal["literal", "rule"]
    opening: str
    stages: tuple[_StageYaml, ...]
    most_turns: int = param(60, "moves after which no further one is legal", minimum=2, maximum=10_000)


def read_rulebook(folders: Iterable[Path] = (SHIPPED_GAMES,)) -> Rulebook:
    """Read the locutions and games of folders; a later folder's replace those of the same name.

    Raises:
        BadFile: a fault of a file, or all faults together.
    """
    locutions: dict[tuple[str, ContentKind], Locution] = {}
    games: dict[str, GameTable] = {}
    faults = FaultCollection()
    read: list[Loaded[_GameYaml]] = []
    for folder in folders:
        if (folder / LOCUTIONS).exists():
            with faults.kept():
                locutions |= {
                    (each.name, each.content): each for each in _locutions(load(folder / LOCUTIONS, _LocutionsYaml))
                }
        for path in sorted(folder.glob("*.yaml")):
            if path.name != LOCUTIONS:
                with faults.kept():
                    read.append(load(path, _GameYaml))
    for loaded in read:
        with faults.kept():
            games[loaded.value.name] = _game(loaded, locutions)
    if faults.found:
        raise faults.together()
    return Rulebook(tuple(locutions.values()), games)


def _locutions(loaded: Loaded[_LocutionsYaml]) -> list[Locution]:
    faults: list[BadFile] = []
    seen: set[tuple[str, ContentKind]] = set()
    for place, each in enumerate(loaded.value.locutions):
        key = f"locutions[{place}]"
        if (each.name, each.content) in seen:
            faults.append(loaded.fault(key, f"{each.name} of a {each.content} is there twice", "Keep one of them"))
        seen.add((each.name, each.content))
        for field, names, known in (
            ("before", each.before, CONDITIONS),
            ("before_person", each.before_person, CONDITIONS),
            ("after", each.after, EFFECTS),
        ):
            what = "effect" if field == "after" else "condition"
            faults += [
                _no_such(loaded, f"{key}.{field}[{at}]", what, name, known)
                for at, name in enumerate(names)
                if name not in known
            ]
    if faults:
        raise BadFiles(tuple(faults))
    return [
        Locution(**{field.name: getattr(each, field.name) for field in dataclasses.fields(each)})
        for each in loaded.value.locutions
    ]


def _game(loaded: Loaded[_GameYaml], locutions: Mapping[tuple[str, ContentKind], Locution]) -> GameTable:
    written = loaded.value
    faults = tuple(_faults(loaded, locutions))
    if faults:
        raise BadFiles(faults)
    stages = {
        stage.name: GameStage(
            stage.turn, tuple(Reply(reply.say, reply.of, reply.next, reply.last) for reply in stage.replies)
        )
        for stage in written.stages
    }
    return GameTable(written.name, written.about, written.opening, stages, written.most_turns)


def _faults(loaded: Loaded[_GameYaml], locutions: Mapping[tuple[str, ContentKind], Locution]) -> Iterator[BadFile]:
    written = loaded.value
    names = [stage.name for stage in written.stages]
    targets = [*names, *(end.value for end in DialogueEnd)]
    if written.opening not in names:
        yield _no_such(loaded, "opening", "stage", written.opening, names)
    for place, stage in enumerate(written.stages):
        key = f"stages[{place}]"
        if stage.name in names[:place]:
            yield loaded.fault(f"{key}.name", f"there are two stages {stage.name}", "Give each a name of its own")
        if stage.name in set(DialogueEnd):
            yield loaded.fault(f"{key}.name", f"{stage.name} is the name of an end", "Give the stage another name")
        if not stage.replies:
            yield loaded.fault(f"{key}.replies", "nothing can be said in this stage", "Add a reply, or take it away")
        if stage.name == written.opening and stage.turn is not GameRole.INITIATOR:
            yield loaded.fault(f"{key}.turn", "the initiator opens a game", "Write initiator")
        for at, reply in enumerate(stage.replies):
            yield from _reply_faults(loaded, f"{key}.replies[{at}]", reply, targets, locutions)
            if stage.name == written.opening and reply.of is not Slot.TOPIC:
                yield loaded.fault(
                    f"{key}.replies[{at}].of", f"a game is opened with its topic, not {reply.of}", "Write topic"
                )
    yield from _stage_faults(loaded, names)


def _reply_faults(
    loaded: Loaded[_GameYaml],
    key: str,
    reply: _ReplyYaml,
    targets: Collection[str],
    locutions: Mapping[tuple[str, ContentKind], Locution],
) -> Iterator[BadFile]:
    about = loaded.value.about
    forms = [kind for name, kind in locutions if name == reply.say]
    wanted = _KINDS_OF_SLOT[reply.of, about]
    if not forms:
        yield _no_such(loaded, f"{key}.say", "locution", reply.say, {name for name, _ in locutions})
    elif not set(wanted) & set(forms):
        have = " or ".join(forms)
        yield loaded.fault(
            f"{key}.of",
            f"{reply.say} has no form for a {wanted[0]}, only for a {have}",
            f"Add it to {LOCUTIONS}, with content: {wanted[0]}",
        )
    if reply.of is Slot.OPPOSITE and about == "rule":
        yield loaded.fault(f"{key}.of", "a rule has no opposite", "Write about: literal, or another slot")
    for field, target in (("next", reply.next), ("last", reply.last)):
        if target is not None and target not in targets:
            yield _no_such(loaded, f"{key}.{field}", "stage or end", target, targets)


def _stage_faults(loaded: Loaded[_GameYaml], names: Collection[str]) -> Iterator[BadFile]:
    """Stages that are never reached, and those from which no end is."""
    written = loaded.value
    after = {
        stage.name: {to for reply in stage.replies for to in (reply.next, reply.last) if to} for stage in written.stages
    }
    reached, waiting = set[str](), [written.opening]
    while waiting:
        name = waiting.pop()
        if name not in reached and name in after:
            reached.add(name)
            waiting += after[name]
    ending = {name for name, targets in after.items() if targets - set(names)}
    while grown := {name for name, targets in after.items() if targets & ending} - ending:
        ending |= grown
    for place, stage in enumerate(written.stages):
        if stage.name not in reached and written.opening in names:
            yield loaded.fault(
                f"stages[{place}].name", f"no reply leads to the stage {stage.name}", "Let one do so, or take it away"
            )
        elif stage.replies and stage.name not in ending:
            yield loaded.fault(
                f"stages[{place}].name",
                f"from the stage {stage.name} there is no way to an end",
                "Let a reply end the game",
            )


def _no_such(
    loaded: Loaded[_GameYaml] | Loaded[_LocutionsYaml], key: str, what: str, name: str, known: Iterable[str]
) -> BadFile:
    choices = sorted(known)
    near = difflib.get_close_matches(name, choices, n=1)
    remedy = f"The nearest is {near[0]}" if near else f"There are: {', '.join(choices)}"
    return loaded.fault(key, f"there is no {what} {name}", remedy)
