"""Reading of dialogue games and their locutions from YAML files, checked so that no dialogue can fail later."""

import dataclasses
import difflib
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from sim.parameters import param
from thbridge.dialogue.games.contents import ContentKind
from thbridge.dialogue.games.locutions import CONDITIONS, CONTRADICTIONS, EFFECTS, Locution
from thbridge.dialogue.games.positions import NO_CLAIM, Obstacle, obstacle, positions, refuses_support, speaker_in
from thbridge.dialogue.games.tables import DialogueEnd, GameRole, GameStage, GameTable, Reply, Rulebook, Slot
from thbridge.files.errors import BadFile, BadFiles, FaultCollection
from thbridge.files.resources import PACKAGE
from thbridge.files.yaml.load import Loaded, load

LOCUTIONS = "locutions.yaml"
SHIPPED_GAMES = PACKAGE / "dialogue" / "games" / "rules"
"""Folder of the built-in games."""
_KIND_OF_SLOT: Mapping[Slot, ContentKind] = {
    Slot.ARGUMENT: ContentKind.ARGUMENT,
    Slot.UNKNOWN: ContentKind.UNKNOWN,
    Slot.SUPPORT: ContentKind.LITERAL,
}
"""Kind of content of each slot. All other slots have the kind of the game's topic."""
LONGEST_NAME = 60
_NAMES = f"A name has 1 to {LONGEST_NAME} letters, without blanks at its ends"
_FormKey = tuple[str, ContentKind, str | None]
_Forms = Mapping[_FormKey, Locution]


@dataclass(frozen=True, slots=True)
class _LocutionYaml:
    name: str
    content: ContentKind
    before: tuple[str, ...] = ()
    before_person: tuple[str, ...] = ()
    after: tuple[str, ...] = ()
    of: Literal["support"] | None = None


@dataclass(frozen=True, slots=True)
class _LocutionsYaml:
    locutions: tuple[_LocutionYaml, ...]


@dataclass(frozen=True, slots=True)
class _ReplyYaml:
    say: str
    of: Slot
    next: str
    last: str | None = None
    questioned: str | None = None


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
    most_turns: int = param(60, "number of moves after which no further move is legal", minimum=2, maximum=10_000)


def read_rulebook(folders: Iterable[Path] = (SHIPPED_GAMES,)) -> Rulebook:
    """Read the locutions and games of folders. Later folders replace locutions and games of the same name.

    Raises:
        BadFile: a fault of a file, or all faults together.
    """
    forms: dict[_FormKey, Locution] = {}
    read: dict[str, Loaded[_GameYaml]] = {}
    faults = FaultCollection()
    for folder in folders:
        with faults.kept():
            paths, own_forms = _game_paths(folder), _read_locutions(folder)
            forms |= own_forms
            own = _load_games(paths, read)
            if own_forms:
                _check_others(folder / LOCUTIONS, [game for name, game in read.items() if name not in own], forms)
            read |= own
            for game in own.values():
                with faults.kept():
                    _check(game, forms)
    if faults.found:
        raise faults.together()
    return Rulebook(tuple(forms.values()), {name: _table(loaded.value) for name, loaded in read.items()})


def _game_paths(folder: Path) -> list[Path]:
    if folder.is_file():
        raise BadFile(folder, "this is a file, not a folder", f"Name its folder: {folder.parent}")
    if not folder.is_dir():
        raise BadFile(folder, "there is no such folder", f"Create the folder, and add games or a {LOCUTIONS}")
    paths = sorted(path for path in folder.glob("*.yaml") if path.name != LOCUTIONS)
    if not paths and not (folder / LOCUTIONS).exists():
        raise BadFile(folder, f"this folder has neither games (*.yaml) nor a {LOCUTIONS}", "Name a folder that has one")
    return paths


def _read_locutions(folder: Path) -> _Forms:
    if not (folder / LOCUTIONS).exists():
        return {}
    return {(each.name, each.content, each.of): each for each in _locutions(load(folder / LOCUTIONS, _LocutionsYaml))}


def _load_games(paths: Iterable[Path], others: Mapping[str, Loaded[_GameYaml]]) -> dict[str, Loaded[_GameYaml]]:
    """Return the games of one folder by name, before their tables are checked.

    Args:
        paths: files of games.
        others: games of earlier folders, which are replaced by games with the same name.
    """
    faults, games = FaultCollection(), dict[str, Loaded[_GameYaml]]()
    for path in paths:
        with faults.kept():
            loaded = load(path, _GameYaml)
            name, about = loaded.value.name, loaded.value.about
            if not _is_name(name):
                raise loaded.fault("name", f"{name!r} is not a valid name", _NAMES)
            if name in games:
                problem = f"{games[name].path.name} also has a game {name}"
                raise loaded.fault("name", problem, "Give each game its own name")
            games[name] = loaded
            if name in others and about != others[name].value.about:
                kind = others[name].value.about
                problem = f"this game replaces {name} of {others[name].path}, which is about a {kind}"
                raise loaded.fault("about", problem, f"Write {kind}, or give this game another name")
    if faults.found:
        raise faults.together()
    return games


def _check_others(path: Path, games: Iterable[Loaded[_GameYaml]], forms: _Forms) -> None:
    """Raise BadFile for a file of locutions that makes a game of an earlier folder unplayable."""
    for game in games:
        try:
            _check(game, forms)
        except BadFile as fault:
            why = f"{fault.path}, line {fault.line}: {fault.problem}"
            problem = f"with these locutions the game {game.value.name} cannot be played ({why})"
            remedy = "Give your locutions other names, or write a game that replaces this game"
            raise BadFile(path, problem, remedy, line=1, key="locutions") from None


def _locutions(loaded: Loaded[_LocutionsYaml]) -> list[Locution]:
    faults: list[BadFile] = []
    seen: set[_FormKey] = set()
    for place, each in enumerate(loaded.value.locutions):
        key = f"locutions[{place}]"
        if (each.name, each.content, each.of) in seen:
            faults.append(loaded.fault(key, f"{each.name} of a {each.content} is defined twice", "Keep only one"))
        seen.add((each.name, each.content, each.of))
        for field, names, known in (
            ("before", each.before, CONDITIONS),
            ("before_person", each.before_person, CONDITIONS),
            ("after", each.after, EFFECTS),
        ):
            what = "effect" if field == "after" else "condition"
            for at, name in enumerate(names):
                place_of_word = f"{key}.{field}[{at}]"
                if name not in known:
                    faults.append(_no_such(loaded, place_of_word, what, name, known))
                elif each.content not in known[name].kinds:
                    kinds = ", ".join(kind for kind in ContentKind if kind in known[name].kinds)
                    problem = f"{name} is for content: {kinds}; not for {each.content}"
                    faults.append(loaded.fault(place_of_word, problem, "Delete it"))
        for field, names in (("before", each.before), ("before_person", each.before_person)):
            faults += [
                loaded.fault(f"{key}.{field}", f"{one} and {other} exclude each other", "Delete one of the two")
                for one, other in CONTRADICTIONS
                if {one, other} <= set(names)
            ]
        if not _is_name(each.name):
            faults.append(loaded.fault(f"{key}.name", f"{each.name!r} is not a valid name", _NAMES))
    if faults:
        raise BadFiles(tuple(faults))
    return [
        Locution(**{field.name: getattr(each, field.name) for field in dataclasses.fields(each)})
        for each in loaded.value.locutions
    ]


def _table(written: _GameYaml) -> GameTable:
    stages = {
        stage.name: GameStage(
            stage.turn,
            tuple(Reply(reply.say, reply.of, reply.next, reply.last, reply.questioned) for reply in stage.replies),
        )
        for stage in written.stages
    }
    return GameTable(written.name, written.about, written.opening, stages, written.most_turns)


def _check(loaded: Loaded[_GameYaml], forms: _Forms) -> None:
    """Raise the faults of the individual entries of a game. If there are none, raise the faults of its course."""
    for find in (_faults, _course_faults):
        if faults := tuple(find(loaded, forms)):
            raise BadFiles(faults)


def _faults(loaded: Loaded[_GameYaml], forms: _Forms) -> Iterator[BadFile]:
    written = loaded.value
    names = [stage.name for stage in written.stages]
    targets = [*names, *(end.value for end in DialogueEnd)]
    if written.opening not in names:
        yield _no_such(loaded, "opening", "stage", written.opening, names)
    for place, stage in enumerate(written.stages):
        key = f"stages[{place}]"
        if not _is_name(stage.name):
            yield loaded.fault(f"{key}.name", f"{stage.name!r} is not a valid name", _NAMES)
        if stage.name in names[:place]:
            yield loaded.fault(f"{key}.name", f"two stages have the name {stage.name}", "Give each stage its own name")
        if stage.name in set(DialogueEnd):
            problem = f"{stage.name} is already the name of an end"
            yield loaded.fault(f"{key}.name", problem, "Give the stage another name")
        if not stage.replies:
            yield loaded.fault(f"{key}.replies", "this stage has no replies", "Add a reply, or delete the stage")
        for at, reply in enumerate(stage.replies):
            yield from _reply_faults(loaded, f"{key}.replies[{at}]", reply, targets, forms)
            yield from _questioned_faults(loaded, f"{key}.replies[{at}]", reply, names)
            if any((reply.say, reply.of) == (other.say, other.of) for other in stage.replies[:at]):
                problem = f"{reply.say} of {reply.of} is already a reply of this stage"
                yield loaded.fault(f"{key}.replies[{at}]", problem, "Keep only one")
        if stage.name == written.opening:
            yield from _opening_faults(loaded, key, stage)
    yield from _stage_faults(loaded, names)


def _opening_faults(loaded: Loaded[_GameYaml], key: str, stage: _StageYaml) -> Iterator[BadFile]:
    if stage.turn is not GameRole.INITIATOR:
        yield loaded.fault(f"{key}.turn", "the initiator must open the game", "Write initiator")
    for at, reply in enumerate(stage.replies):
        if reply.of is not Slot.TOPIC:
            problem = f"the first move must be about the topic, not {reply.of}"
            yield loaded.fault(f"{key}.replies[{at}].of", problem, "Write topic")
    if stage.replies and all(reply.next in set(DialogueEnd) for reply in stage.replies):
        remedy = "Let one reply lead to a stage in which the respondent replies"
        yield loaded.fault(f"{key}.replies[0].next", "every opening ends the game without a reply", remedy)


def _reply_faults(
    loaded: Loaded[_GameYaml],
    key: str,
    reply: _ReplyYaml,
    targets: Collection[str],
    forms: _Forms,
) -> Iterator[BadFile]:
    about = loaded.value.about
    have = list(dict.fromkeys(kind for name, kind, of in forms if name == reply.say and of in {None, reply.of}))
    wanted = _kind_of(reply.of, about)
    if not have:
        yield _no_such(loaded, f"{key}.say", "locution", reply.say, {name for name, _, _ in forms})
    elif wanted not in have:
        yield loaded.fault(
            f"{key}.of",
            f"{reply.say} has no form with content: {wanted}, only with {', '.join(have)}",
            f"Add this form to {LOCUTIONS}, or write another slot",
        )
    if reply.of in {Slot.OPPOSITE, Slot.UNKNOWN} and about == "rule":
        problem = f"a rule has no {'opposite' if reply.of is Slot.OPPOSITE else 'form for not knowing'}"
        yield loaded.fault(f"{key}.of", problem, "Write about: literal, or another slot")
    for field, target in (("next", reply.next), ("last", reply.last)):
        if target is not None and target not in targets:
            yield _no_such(loaded, f"{key}.{field}", "stage or end", target, targets)
    if reply.last is not None and reply.of not in {Slot.SUPPORT, Slot.ARGUMENT}:
        problem = f"`last` is for the last support of a claim, not for {reply.of}"
        yield loaded.fault(f"{key}.last", problem, "Delete the line, or write `of: support` or `of: argument`")


def _questioned_faults(
    loaded: Loaded[_GameYaml], key: str, reply: _ReplyYaml, names: Collection[str]
) -> Iterator[BadFile]:
    if reply.questioned is None:
        return
    if reply.questioned not in names:
        yield _no_such(loaded, f"{key}.questioned", "stage", reply.questioned, names)
    if reply.next in names:
        problem = "`questioned` is for a refusal that ends the game, but this reply does not end the game"
        yield loaded.fault(f"{key}.questioned", problem, "Delete the line, or write the name of an end as `next`")


def _course_faults(loaded: Loaded[_GameYaml], forms: _Forms) -> Iterator[BadFile]:
    """Yield faults of turns without a speaker, and of replies that are never legal in the game."""
    table = _table(loaded.value)

    def form_of(reply: Reply) -> Locution:
        kind = _kind_of(reply.slot, table.about)
        return forms.get((reply.locution, kind, reply.slot)) or forms[reply.locution, kind, None]

    found = positions(table, form_of)
    for place, stage in enumerate(table.stages):
        here = [position for position in found if position.stage == stage]
        if any(speaker_in(table, position) is None for position in here):
            turn = table.stages[stage].turn
            problem = f"the {turn} may get the turn here although {NO_CLAIM.problem}"
            yield loaded.fault(f"stages[{place}].turn", problem, f"Write initiator or respondent. {NO_CLAIM.remedy}")
            continue
        for at, reply in enumerate(table.stages[stage].replies):
            obstacles = [obstacle(table, position, reply, form_of) for position in here]
            if obstacles and all(obstacles) and isinstance(first := obstacles[0], Obstacle):
                problem = f"{reply.locution} of {reply.slot} is never legal here: {first.problem}"
                yield loaded.fault(f"stages[{place}].replies[{at}].of", problem, first.remedy)
            elif reply.questioned is not None and not any(
                refuses_support(table, position, reply, form_of) for position in here
            ):
                problem = "no refusal here can be questioned, because the reply does not answer a support"
                remedy = "Delete the line, or move the reply to a stage in which the challenger answers `of: support`"
                yield loaded.fault(f"stages[{place}].replies[{at}].questioned", problem, remedy)


def _stage_faults(loaded: Loaded[_GameYaml], names: Collection[str]) -> Iterator[BadFile]:
    """Yield faults of stages that are never reached, and of stages from which no end can be reached."""
    written = loaded.value
    after = {
        stage.name: {to for reply in stage.replies for to in (reply.next, reply.last, reply.questioned) if to}
        for stage in written.stages
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
    lost = [name for name in names if name not in reached] if reached else []
    # A stage is not reported if only unreachable stages lead to it: the first unreachable stage is the cause.
    first_lost = [name for name in lost if not any(name in after[other] for other in lost)] or lost[:1]
    for place, stage in enumerate(written.stages):
        if stage.name in first_lost:
            yield loaded.fault(
                f"stages[{place}].name", f"no reply leads to the stage {stage.name}", "Add a reply, or delete the stage"
            )
        elif stage.replies and stage.name not in ending:
            yield loaded.fault(
                f"stages[{place}].name",
                f"the stage {stage.name} leads to no end",
                "Let a reply end the game",
            )


def _no_such(
    loaded: Loaded[_GameYaml] | Loaded[_LocutionsYaml], key: str, what: str, name: str, known: Iterable[str]
) -> BadFile:
    choices = sorted(set(known))
    near = difflib.get_close_matches(name, choices, n=1)
    remedy = f"The nearest name is {near[0]}" if near else f"Write one of: {', '.join(choices) or 'none'}"
    return loaded.fault(key, f"{what} {name} does not exist", remedy)


def _kind_of(slot: Slot, about: str) -> ContentKind:
    return _KIND_OF_SLOT.get(slot, ContentKind(about))


def _is_name(name: str) -> bool:
    return bool(name) and name == name.strip() and name.isprintable() and len(name) <= LONGEST_NAME
