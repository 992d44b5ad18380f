"""The design of a sweep: a study, the conditions, and the number of games in each condition."""

import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from sim.parameters import param
from thbridge.app.compose.setting import StudySetting
from thbridge.batch.measures import MEASURES, SEAT_MEASURES
from thbridge.batch.results import OWN_COLUMNS, FactorColumns
from thbridge.batch.settings import SettingCache
from thbridge.files.disk.text_files import read_text
from thbridge.files.errors import BadFile, FaultCollection
from thbridge.files.yaml.load import Loaded, load_tree
from thbridge.files.yaml.merge import nested, over
from thbridge.files.yaml.tree import Listing, Node, Scalar, Section, at_line, parse
from thbridge.study.external_nodes import ExternalNodes
from thbridge.study.factors import Level, check_keys_set_once, entries_of, factorial, levels_of, spread, written
from thbridge.study.overrides import merged, resolved_tree
from thbridge.study.study_file import Study, load_study

AN_HOUR = 3600.0
LARGEST_SEED = 2**31 - 1
MOST_CONDITIONS = 10_000
_ONE_IN = re.compile(r"1 in ([1-9]\d{0,8})")
_OWN_READING = ("base", "factors", "conditions")
"""Keys of a design whose sections contain keys of studies."""


@dataclass(frozen=True, slots=True)
class SweepFile:
    """Contents of the file of a design."""

    study: Path | None = param(
        None, "path of the study file for all games, relative to the folder of this file; if null, the defaults"
    )
    base: Mapping[str, str] = field(
        default_factory=dict, metadata={"help": "keys of the study that override the study file"}
    )
    factors: Mapping[str, str] = field(
        default_factory=dict,
        metadata={"help": "factors with their levels; each combination of levels is a condition"},
    )
    conditions: Mapping[str, str] = field(
        default_factory=dict, metadata={"help": "further conditions; write each as a line `- {key: value, ...}`"}
    )
    replicates: int = param(10, "number of games in each condition, with consecutive random seeds", "", 1, 10**9)
    first_seed: int = param(1, "random seed of the first game in each condition", "", 0, LARGEST_SEED)
    seeds: tuple[int, ...] | None = param(
        None, "list of random seeds, instead of replicates and first_seed", "", 0, LARGEST_SEED
    )
    max_seconds: float = param(AN_HOUR, "simulated time after which an unfinished game stops", "s", 1, 1e6)
    measures: tuple[str, ...] = param(
        tuple(measure for measure in MEASURES if measure not in SEAT_MEASURES),
        f"measures of each game in the results; games with several seats also have {', '.join(SEAT_MEASURES)}",
        choices=MEASURES,
    )
    bags: str = param("no", "games that are recorded in a bag: no, yes, or for example `1 in 50`")
    verify: int = param(
        100, "repeat one game in N on another worker, and compare the results; 0: no repetitions", "", 0
    )
    chunk: int = param(
        20, "number of games of a condition that a worker plays in a row and writes to one file", "", 1, 10**6
    )


@dataclass(frozen=True, slots=True)
class SweepCondition:
    """One condition of a sweep.

    Attributes:
        number: number of the condition, from 1.
        levels: the level of each factor, as written in the file. For a condition of the list `conditions`, its keys and
            values.
        study: the study. The seeds of the games replace its own seed.
    """

    number: int
    levels: Mapping[str, str]
    study: Study

    def __str__(self) -> str:
        levels = ", ".join(f"{factor}={level}" for factor, level in self.levels.items())
        return f"condition {self.number}" + (f" ({levels})" if levels else "")


@dataclass(frozen=True, slots=True)
class SweepDesign:
    """A design after reading and checking.

    Attributes:
        path: path of the design's file.
        `beside`: the folder for relative paths in the studies.
        conditions: conditions in order.
        factors: names of all factors.
        seeds: random seeds of the games in each condition. All conditions have the same seeds, and so the same random
            numbers.
        max_seconds: simulated time after which an unfinished game stops.
        measures: names of the measures in the results.
        one_bag_in: N if one game in N is recorded; 0 if no game is recorded.
        one_verified_in: N if one game in N is repeated; 0 if no game is repeated.
        chunk: maximum number of games in a chunk.
        doubts: possible mistakes in the files of the conditions.
    """

    path: Path
    beside: Path
    conditions: tuple[SweepCondition, ...]
    factors: tuple[str, ...]
    seeds: tuple[int, ...]
    max_seconds: float
    measures: tuple[str, ...]
    one_bag_in: int
    one_verified_in: int
    chunk: int
    doubts: tuple[BadFile, ...] = ()

    @property
    def games(self) -> int:
        """Number of games of all conditions."""
        return len(self.conditions) * len(self.seeds)

    @property
    def columns(self) -> FactorColumns:
        """Columns of the results for the factors."""
        return FactorColumns.of(self.factors, {each.number: each.levels for each in self.conditions})


def read_design(path: Path) -> SweepDesign:
    """Read a design. Check the study of every condition, with all files that the study names.

    Raises:
        BadFile: the design cannot be read, or a study has faults. BadFiles reports all faults at once.
    """
    whole = parse(path, read_text(path))
    entries = dict(_named(whole))
    plain = [(key, Section(key.line, []) if key.text in _OWN_READING else node) for key, node in entries_of(whole)]
    loaded = load_tree(path, Section(whole.line, plain) if isinstance(whole, Section) else whole, SweepFile)
    file, faults = loaded.value, FaultCollection()
    with faults.kept():
        _check(loaded)
    study, beside = Study(), path.parent
    if file.study is not None:
        study, beside = load_study(path.parent / file.study).value, (path.parent / file.study).parent
    if (base := entries.get("base")) is not None:
        study = merged(resolved_tree(study), path, spread(path, base)).value
    factors = {key.text: _levels(path, key, node) for key, node in entries_of(entries.get("factors"))}
    check_keys_set_once(path, base, factors)
    games = math.prod(map(len, factors.values())) * len(file.seeds or range(file.replicates))
    if games > MOST_GAMES:
        raise loaded.fault(
            "replicates", f"{games} games, but a sweep may have at most {MOST_GAMES}", "Write fewer games"
        )
    conditions: list[SweepCondition] = []
    start, settings = resolved_tree(study), SettingCache(beside)
    explicit = list(_explicit(path, entries.get("conditions")))
    combinations = list(factorial(factors)) if factors or not explicit else []
    for levels in (*combinations, *explicit):
        with faults.kept():
            conditions.append(_condition(path, start, levels, len(conditions) + 1, settings))
        if len(faults.found) > MOST_FAULTS:
            break
    if faults.found:
        raise faults.together()
    named = dict.fromkeys(factor for condition in conditions for factor in condition.levels)
    return SweepDesign(
        path,
        beside,
        tuple(conditions),
        tuple(named),
        file.seeds or tuple(range(file.first_seed, file.first_seed + file.replicates)),
        file.max_seconds,
        file.measures,
        _one_in(file.bags) or 0,
        file.verify,
        file.chunk,
        settings.doubts,
    )


MOST_GAMES = 10_000_000
"""Maximum number of games in a sweep. They need about one year on twenty cores."""
MOST_FAULTS = 10
"""Reading stops after this number of faults in conditions."""


def _check(loaded: Loaded[SweepFile]) -> None:
    """Raise BadFile for values that are valid alone, but contradict each other."""
    file = loaded.value
    if _one_in(file.bags) is None:
        raise loaded.fault("bags", f"{file.bags!r} is not a valid choice", "Write no, yes, or for example `1 in 50`")
    if file.seeds is not None and not file.seeds:
        raise loaded.fault(
            "seeds", "the list has no seeds, so there are no games", "Write some seeds, or delete the line"
        )
    if file.seeds is not None and len(set(file.seeds)) < len(file.seeds):
        raise loaded.fault(
            "seeds", "a seed is listed twice", "Write each seed once, because the same seed gives the same game"
        )
    for key in ("replicates", "first_seed"):
        if file.seeds is not None and key in loaded.lines:
            raise loaded.fault(key, "`seeds` already lists the seeds", "Keep one of the two")
    if file.first_seed + file.replicates - 1 > LARGEST_SEED:
        raise loaded.fault(
            "replicates", f"seeds would be above {LARGEST_SEED}", "Write fewer replicates, or a smaller first_seed"
        )
    if not file.measures:
        raise loaded.fault("measures", "the list has no measures", f"Write some of {', '.join(MEASURES)}")


def _one_in(words: str) -> int | None:
    """Return N for "1 in N", 1 for yes, 0 for no, and None for another text."""
    found = _ONE_IN.fullmatch(words.strip())
    return int(found[1]) if found else {"no": 0, "yes": 1}.get(words)


def _levels(path: Path, factor: Scalar, node: Node) -> list[Level]:
    if factor.text in OWN_COLUMNS:
        problem, key = "results already have a column with this name", f"factors.{factor.text}"
        raise BadFile(path, problem, "Give the factor another name", line=factor.line, key=key)
    return levels_of(path, "factors", factor, node)


def _explicit(path: Path, node: Node | None) -> Iterator[dict[str, Level]]:
    """Yield the conditions of the file's list `conditions`."""
    if node is None:
        return
    if not isinstance(node, Listing):
        remedy = "Write a line '- {KEY: VALUE, ...}' for each condition"
        raise BadFile(path, "this value must be a list", remedy, node.line, "conditions")
    for item in node.items:
        if not isinstance(item, Section):
            raise BadFile(path, "this value must be a section", "Write {KEY: VALUE, ...}", item.line, "conditions")
        yield {
            key.text: Level(written(child), nested(key.text, child, key.line), key.line) for key, child in item.entries
        }


def _condition(
    path: Path, start: Node, levels: Mapping[str, Level], number: int, settings: SettingCache
) -> SweepCondition:
    """Check and return a condition. Raises BadFile."""
    tree: Node = Section(1, [])
    line = 1
    for level in levels.values():
        tree, line = over(tree, level.tree), level.line
    labels = {factor: level.label for factor, level in levels.items()}
    if number > MOST_CONDITIONS:
        problem = f"the design has more than {MOST_CONDITIONS} conditions"
        raise BadFile(path, problem, "Write fewer factors or levels")
    # Faults of combined values are reported with the line number of the last factor.
    loaded = merged(at_line(start, line), path, tree)
    condition = SweepCondition(number, labels, loaded.value)
    if "seed" in {key.text for key, _ in entries_of(tree)}:
        problem = "a condition cannot have its own seed: all conditions use the same seeds"
        raise BadFile(path, problem, "Write `replicates` and `first_seed`, or `seeds`", line=line, key="seed")
    try:
        _playable(settings.of(condition.study, loaded), loaded)
    except BadFile as fault:
        problem = f"{fault.problem} ({condition})" if labels else fault.problem
        raise BadFile(fault.path, problem, fault.remedy, line=fault.line, key=fault.key) from None
    return condition


def _playable(setting: StudySetting, loaded: Loaded[Study]) -> None:
    """Raise BadFile if a sweep cannot simulate the study."""
    if setting.study.robots_from.is_real:
        raise loaded.fault("robots_from", "a sweep supports only simulated robots", "Write sim")
    if setting.study.external_nodes is not ExternalNodes.NONE:
        raise loaded.fault("external_nodes", "the robots of a sweep cannot use external ROS nodes", "Write none")


def _named(node: Node) -> Iterator[tuple[str, Node]]:
    for key, child in entries_of(node):
        yield key.text, child
