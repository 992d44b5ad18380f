"""Practice games: their studies, and the requirements that participants must meet."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import chain
from pathlib import Path

from thbridge.app.compose.setting import StudySetting
from thbridge.batch.settings import SettingCache
from thbridge.dialogue.conditions import DialogueCondition
from thbridge.experiment.design.steps import LARGEST_COUNT, PracticeTerm, StepEntry, StepKind
from thbridge.files.yaml.tree import Listing, Node, Section, at_line
from thbridge.study.factors import entries_of, spread
from thbridge.study.overrides import merged, resolved_tree
from thbridge.study.study_file import Study

BASE = "base"


def without_bases(node: Node) -> Node:
    """Return a list of steps with every `base` replaced by an empty section. Return any other node unchanged."""
    return replace(node, items=list(map(_without_base, node.items))) if isinstance(node, Listing) else node


def _without_base(step: Node) -> Node:
    if not isinstance(step, Section):
        return step
    entries = [(key, Section(key.line, []) if key.text == BASE else node) for key, node in step.entries]
    return Section(step.line, entries)


def practice_studies(
    path: Path, step: Node, cells: Sequence[Sequence[Study]], files: SettingCache | None
) -> tuple[tuple[Study, ...], ...]:
    """Return the studies of a practice game: the studies of the conditions with the keys of the step's `base`.

    Args:
        path: the experiment's file, for faults.
        step: the step in the file.
        cells: for each combination of levels between people, the study of each condition.
        files: cache that reads the files of the games. If None, these files are not read.

    Raises:
        BadFile: a key of `base` has a fault, or a file that it names has a fault.
    """
    base = next((node for key, node in entries_of(step) if key.text == BASE), None)
    if base is None:
        return tuple(map(tuple, cells))
    keys, found = spread(path, base), []
    for studies in cells:
        read = [merged(at_line(resolved_tree(study), base.line), path, keys) for study in studies]
        for each in read if files is not None else ():
            if files is not None:
                files.of(each.value, each)
        found.append(tuple(each.value for each in read))
    return tuple(found)


def demands_of(entry: StepEntry, study: Study) -> Mapping[PracticeTerm, float]:
    """Return the requirements of a practice game. If robots never talk, dialogues are not required."""
    demands = {PracticeTerm(term): float(number) for term, number in entry.at_least.items()}
    if study.dialogue.condition is DialogueCondition.SUPERVISOR:
        demands.pop(PracticeTerm.DIALOGUES, None)
    return {term: number for term, number in demands.items() if number > 0.0}


def practice_problems(
    lines: Mapping[str, int], index: int, entry: StepEntry, studies: Sequence[Study], files: SettingCache | None
) -> Iterator[tuple[str, str, str]]:
    """Yield the key, problem and remedy of each requirement that no participant can meet in a practice game.

    Args:
        lines: line number of each key of the experiment's file, by its path.
        index: index of the step.
        entry: the step.
        studies: all studies in which the practice game may be played.
        files: as for `practice_studies`.
    """
    key = f"steps[{index}].at_least"
    if entry.step is not StepKind.PRACTICE:
        for name in (BASE, "at_least"):
            if f"steps[{index}].{name}" in lines:
                problem = f"this key is only for practice games, not for the step {entry.step}"
                yield f"steps[{index}].{name}", problem, "Delete the line"
        return
    most = math.inf if files is None else min((_most_moves(files.of(study)) for study in studies), default=math.inf)
    for term, text in entry.at_least.items():
        number = _number(text)
        if term not in list(PracticeTerm):
            yield f"{key}.{term}", f"{term} is not counted in practice games", f"Write one of {', '.join(PracticeTerm)}"
        elif number is None or not 0 <= number <= LARGEST_COUNT:
            yield f"{key}.{term}", f"{text!r} is not a number from 0 to {LARGEST_COUNT}", "Write a number such as 1"
        elif term == PracticeTerm.SECONDS:
            if number >= entry.max_seconds:
                remedy = f"Write less than {entry.max_seconds:g}, or a larger max_seconds"
                yield f"{key}.{term}", f"the game ends after {entry.max_seconds:g} s", remedy
        elif number != math.floor(number):
            yield f"{key}.{term}", f"{text} is not a whole number", "Write a whole number such as 1"
        elif term == PracticeTerm.DIALOGUES and number > 0 and all(map(_is_silent, studies)):
            remedy = "Delete the line, or write base: {dialogue.condition: ...}"
            yield f"{key}.{term}", "robots never talk in the condition supervisor", remedy
        elif term != PracticeTerm.DIALOGUES and number > most:
            remedy = f"Write at most {most:g}, or write base: {{game.energy: ...}}"
            yield f"{key}.{term}", f"the map and the robots' energy allow at most {most:g}", remedy


def _most_moves(setting: StudySetting) -> float:
    """Return the largest number of moves that a game allows: one for each room, limited by the robots' energy."""
    cheapest = min(chain.from_iterable(setting.costs.rows))
    energy, rooms = setting.study.game.energy, len(setting.map.rooms)
    return min(rooms, setting.study.robots * (energy // cheapest)) if cheapest > 0.0 else rooms


def _is_silent(study: Study) -> bool:
    return study.dialogue.condition is DialogueCondition.SUPERVISOR


def _number(text: str) -> float | None:
    try:
        number = float(text)
    except ValueError:
        return None
    return number if math.isfinite(number) else None
