"""The file of an experiment: conditions, number of people, and the steps of each person."""

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from pathlib import Path

from sim.numerics import noise
from sim.parameters import param
from thbridge.batch.settings import SettingCache
from thbridge.experiment.allocation.latin_square import Order, balanced_latin_square, cyclic_latin_square
from thbridge.experiment.allocation.places import Allocation
from thbridge.experiment.design.lobby import LobbySection, lobby_problems
from thbridge.experiment.design.practice import practice_problems, practice_studies, without_bases
from thbridge.experiment.design.presence import PresenceSection
from thbridge.experiment.design.recruiting import RecruitingSection, recruiting_problems
from thbridge.experiment.design.steps import StepEntry, StepKind
from thbridge.experiment.questionnaires.form import SHIPPED, Form, read_form, shipped_form
from thbridge.files.disk.inside import fault_of_name
from thbridge.files.disk.regular_files import is_regular
from thbridge.files.disk.text_files import read_text
from thbridge.files.errors import BadFile, FaultCollection, visible
from thbridge.files.yaml.load import Loaded, load_tree
from thbridge.files.yaml.merge import over
from thbridge.files.yaml.tree import Listing, Node, Section, at_line, parse
from thbridge.study.factors import Level, check_keys_set_once, entries_of, factorial, levels_of, spread
from thbridge.study.overrides import merged, resolved_tree
from thbridge.study.study_file import Study, load_study

MOST_CONDITIONS = 16
"""Maximum number of conditions for each person."""
MOST_PEOPLE = 100_000
MOST_TRIALS = 64
"""Number of trials whose seeds practice games never use."""
LONGEST_TITLE = 200
"""Maximum length of a title, in characters."""
LARGEST_SEED = 2**31 - 1
_OWN_READING = ("base", "within", "between")
"""Keys of an experiment whose sections contain keys of studies."""


class OrderKind(StrEnum):
    """Rule for the order of the conditions of each person."""

    BALANCED = "balanced"
    """Balanced Latin square: each condition occurs equally often at each position, and equally often after each other
    condition."""
    CYCLIC = "cyclic"
    """Cyclic Latin square: each condition occurs equally often at each position.

    For an odd number of conditions, this rule needs only half the number of orders of a balanced square.
    """
    FIXED = "fixed"
    """The same order for each person, as in the file."""


class WhoBegins(StrEnum):
    """Person who starts the next run on the laboratory's computer."""

    PARTICIPANT = "participant"
    """The participant presses a button to start."""
    RESEARCHER = "researcher"
    """The researcher starts the run in the desk window or with a key combination."""


@dataclass(frozen=True, slots=True)
class ExperimentFile:
    """Contents of the file of an experiment."""

    title: str = field(metadata={"help": "title of the study"})
    seed: int = param(1, "random seed", "", 0, LARGEST_SEED)
    study: Path | None = param(
        None, "path of the study file for all games, relative to the folder of this file; if null, the defaults"
    )
    base: Mapping[str, str] = field(
        default_factory=dict, metadata={"help": "keys of the study that override the study file"}
    )
    within: Mapping[str, str] = field(
        default_factory=dict,
        metadata={"help": "within-participant factors: each participant plays with every level of the factor"},
    )
    between: Mapping[str, str] = field(
        default_factory=dict, metadata={"help": "factors between people: each participant plays at only one level"}
    )
    quota: int = param(
        12, "number of valid runs that each combination of levels between people needs", "", 1, MOST_PEOPLE
    )
    order: OrderKind = param(OrderKind.BALANCED, "rule for the order of each person's conditions")
    in_block: int = param(1, "number of places of each combination of levels between people in a block", "", 1, 100)
    seeds: tuple[int, ...] = param(
        (),
        "random seeds of the trials, in the order of play and the same for all people; if empty, the program chooses "
        "the seeds",
        "",
        0,
        LARGEST_SEED,
    )
    begins: WhoBegins = param(WhoBegins.PARTICIPANT, "who starts the run of the next person")
    recruiting: RecruitingSection = param(RecruitingSection(), "how people enter from a recruiting service")
    presence: PresenceSection = param(PresenceSection(), "presence of people who take part in a browser")
    lobby: LobbySection = param(
        LobbySection(),
        "games of several people (studies with `seats`): who plays together, and what follows if people are missing",
    )
    recruitment: str = param("", "sentence for the methods text: how people were recruited and paid")
    ethics: str = param(
        "", "sentence for the methods text: approval by an ethics committee, with the committee's name and the number"
    )
    sample_size_reason: str = param("", "sentence for the methods text: reason for the quota")
    exclusions: tuple[str, ...] = param(
        (), "sentences for the methods text: one for each rule by which researchers exclude runs or answers"
    )
    preregistration: str = param("", "sentence for the methods text: where the study is registered")
    deviations: tuple[str, ...] = param(
        (), "sentences for the methods text: one for each deviation from the preregistration, with its reason"
    )
    data_availability: str = param("", "sentence for the methods text: where data and materials are available")
    most_lag: float | None = param(
        None,
        "largest delay of a game behind real time (on a slow machine, games are late); a run with a larger delay does "
        "not count, and its place becomes free; if null, the delay does not matter",
        "s",
        0,
        3600,
    )
    consent_elsewhere: str = param(
        "",
        "sentence for the methods text: how participants gave consent outside of the program, for example on paper; "
        "if empty, a step of the study must ask for consent",
    )
    markers: bool = param(
        default=False, help="send each event of the log to other recording programs (Lab Streaming Layer)"
    )
    steps: tuple[StepEntry, ...] = param((), "steps of each person, in order")


@dataclass(frozen=True, slots=True)
class ExperimentCondition:
    """A combination of levels of the factors within people.

    Attributes:
        name: the levels in words; empty if there are no factors within people.
        levels: the level of each factor within people.
    """

    name: str
    levels: Mapping[str, str]


@dataclass(frozen=True, slots=True)
class Cell:
    """A combination of levels of the factors between people.

    Attributes:
        name: the levels in words; empty if there are no factors between people.
        levels: the level of each factor between people.
        studies: the study of each condition in this cell.
    """

    name: str
    levels: Mapping[str, str]
    studies: tuple[Study, ...]


@dataclass(frozen=True, slots=True)
class ExperimentDesign:
    """An experiment after reading and checking.

    Attributes:
        path: its file.
        `beside`: the folder for relative paths in the studies.
        file: contents of the file.
        study: the common study of all games, without the changes of the conditions.
        conditions: the conditions within people, in the file's order.
        cells: the combinations of levels between people.
        orders: possible orders of the conditions.
        forms: the form of each step with a form, by the step's index.
        practices: the studies of each practice game, by the step's index. For each combination of levels between
            people, there is one study for each condition.
        lines: line number of each key and item of the file, by its path.
        form_files: each form and the line numbers of its file, by the step's index.
        doubts: possible mistakes in the files that the studies name. Empty if these files were not read.
    """

    path: Path
    beside: Path
    file: ExperimentFile
    study: Study
    conditions: tuple[ExperimentCondition, ...]
    cells: tuple[Cell, ...]
    orders: tuple[Order, ...]
    forms: Mapping[int, Form]
    practices: Mapping[int, tuple[tuple[Study, ...], ...]] = field(default_factory=dict)
    lines: Mapping[str, int] = field(default_factory=dict)
    form_files: Mapping[int, Loaded[Form]] = field(default_factory=dict)
    doubts: tuple[BadFile, ...] = ()

    def fault(self, key: str, problem: str, remedy: str) -> BadFile:
        """Return a fault at a key of the file, with the line number of the key or of the nearest key above."""
        return Loaded(self.path, self.file, self.lines).fault(key, problem, remedy)

    @property
    def allocation(self) -> Allocation:
        """Assignment of places to groups and orders."""
        file = self.file
        return Allocation(
            len(self.cells), len(self.orders), file.quota, file.seed, file.in_block, tuple(self._people_together())
        )

    @property
    def has_groups(self) -> bool:
        """True if a game of the study has several people."""
        return any(study.seats for studies in self._games() for study in studies)

    @property
    def pairing_factor(self) -> str:
        """Factor between people by which groups are formed; empty if there is none."""
        return self.file.lobby.by if self.file.lobby.by in self.cells[0].levels else ""

    def family(self, cell: int) -> str:
        """Return the levels of a cell in words, without the factor by which groups are formed.

        People of the same family can play together.
        """
        levels = self.cells[cell].levels.items()
        return ", ".join(f"{factor}={level}" for factor, level in levels if factor != self.pairing_factor)

    def _games(self) -> Iterator[Sequence[Study]]:
        """Yield the studies of all games of each cell: of trials, and of each practice."""
        yield from (cell.studies for cell in self.cells)
        yield from itertools.chain.from_iterable(self.practices.values())

    def _people_together(self) -> Iterator[tuple[int, ...]]:
        """Yield the cells of the people who come together in a group, for each family of cells.

        Yield nothing if all games have one participant.
        """
        if not self.has_groups:
            return
        lobby = self.file.lobby
        families: dict[str, list[int]] = {}
        for cell in range(len(self.cells)):
            families.setdefault(self.family(cell), []).append(cell)
        for cells in families.values():
            if self.pairing_factor:
                values = [self.cells[cell].levels[self.pairing_factor] for cell in cells]
                yield tuple(
                    cell for cell, value in zip(cells, values, strict=True) for _ in range(lobby.people_of(value))
                )
                continue
            (cell,) = cells
            games = itertools.chain(self.cells[cell].studies, *(each[cell] for each in self.practices.values()))
            yield (cell,) * math.lcm(*(len(study.seats) or 1 for study in games))

    def levels_at(self, cell: int, condition: int | None) -> Mapping[str, str]:
        """Return the level of each factor for a participant of a cell in a step.

        If the step belongs to no condition, the result has no factors within people.
        """
        within = {} if condition is None else self.conditions[condition].levels
        return {**self.cells[cell].levels, **within}


def read_experiment(path: Path, *, with_files: bool = False) -> ExperimentDesign:
    """Read an experiment, with the study of every condition and all forms.

    Args:
        path: the file of the experiment.
        with_files: True to also read the files that the games need (maps, templates, words), and to check that the
            games can start.

    Raises:
        BadFile: the experiment cannot be read, or it has faults. BadFiles reports all faults at once.
    """
    return experiment_of(path, parse(path, read_text(path)), with_files=with_files)


def experiment_of(path: Path, whole: Node, *, with_files: bool = False) -> ExperimentDesign:
    """Read the tree of an experiment's file; see `read_experiment`. Error messages name `path` as the file."""
    entries = {key.text: node for key, node in entries_of(whole)}
    plain = [
        (key, Section(key.line, []) if key.text in _OWN_READING else without_bases(node))
        for key, node in entries_of(whole)
    ]
    loaded = load_tree(path, Section(whole.line, plain) if isinstance(whole, Section) else whole, ExperimentFile)
    file, faults = loaded.value, FaultCollection()
    study, beside = Study(), path.parent
    if file.study is not None:
        study, beside = load_study(path.parent / file.study).value, (path.parent / file.study).parent
    line = 1
    if (base := entries.get("base")) is not None:
        study, line = merged(resolved_tree(study), path, spread(path, base)).value, base.line
    within = _factors(path, "within", entries)
    between = _factors(path, "between", entries)
    with faults.kept():
        _check_factors(loaded, within, between)
        check_keys_set_once(path, base, {**between, **within})
    conditions = tuple(ExperimentCondition(_named(levels), _labels(levels)) for levels in factorial(within))
    if len(conditions) > MOST_CONDITIONS:
        raise loaded.fault(
            "within",
            f"each person would play {len(conditions)} conditions",
            f"Write factors and levels for at most {MOST_CONDITIONS}",
        )
    cells = []
    # Faults of combined values are reported with a line number of the experiment's file.
    start, files = at_line(resolved_tree(study), line), SettingCache(beside)
    for cell in factorial(between):
        studies = []
        for condition in factorial(within):
            with faults.kept():
                read = _study(path, start, {**cell, **condition})
                studies.append(read.value)
                if with_files:
                    files.of(read.value, read)
            if faults.found:
                break
        cells.append(Cell(_named(cell), _labels(cell), tuple(studies)))
        if faults.found:
            break
    forms: dict[int, Loaded[Form]] = {}
    for problem in _problems(loaded, len(conditions)):
        faults.found.append(problem)
    for index, entry in enumerate(file.steps):
        if entry.form:
            with faults.kept():
                forms[index] = _form(loaded, index, entry, study.dialogue.language)
        if with_files and entry.text is not None and is_regular(text := path.parent / entry.text):
            with faults.kept():
                read_text(text)
    if faults.found:
        raise faults.together()
    practices = _practices(loaded, entries.get("steps"), cells, files if with_files else None)
    return ExperimentDesign(
        path,
        beside,
        file,
        study,
        conditions,
        tuple(cells),
        _orders(file.order, len(conditions)),
        {index: form.value for index, form in forms.items()},
        practices,
        lines=loaded.lines,
        form_files=forms,
        doubts=files.doubts,
    )


def _practices(
    loaded: Loaded[ExperimentFile], steps: Node | None, cells: Sequence[Cell], files: SettingCache | None
) -> dict[int, tuple[tuple[Study, ...], ...]]:
    practices, faults = {}, FaultCollection()
    written = steps.items if isinstance(steps, Listing) else []
    for index, (entry, node) in enumerate(zip(loaded.value.steps, written, strict=True)):
        studies: tuple[tuple[Study, ...], ...] = ()
        if entry.step is StepKind.PRACTICE:
            with faults.kept():
                studies = practice_studies(loaded.path, node, [cell.studies for cell in cells], files)
                practices[index] = studies
        for problem in practice_problems(loaded.lines, index, entry, list(itertools.chain(*studies)), files):
            faults.found.append(loaded.fault(*problem))
    if faults.found:
        raise faults.together()
    return practices


def _orders(kind: OrderKind, conditions: int) -> tuple[Order, ...]:
    if kind is OrderKind.FIXED:
        return (tuple(range(conditions)),)
    return balanced_latin_square(conditions) if kind is OrderKind.BALANCED else cyclic_latin_square(conditions)


def _factors(path: Path, section: str, entries: Mapping[str, Node]) -> dict[str, list[Level]]:
    return {key.text: levels_of(path, section, key, node) for key, node in entries_of(entries.get(section))}


def _check_factors(
    loaded: Loaded[ExperimentFile], within: Mapping[str, list[Level]], between: Mapping[str, list[Level]]
) -> None:
    if both := next((factor for factor in within if factor in between), None):
        raise loaded.fault("between", f"{both} is also a factor within people", "Keep one of the two")
    if "seed" in {*within, *between}:
        raise loaded.fault(
            "within", "seed cannot be a factor, because all conditions use the same seed", "Write `seeds`"
        )


def _labels(levels: Mapping[str, Level]) -> dict[str, str]:
    return {factor: level.label for factor, level in levels.items()}


def _named(levels: Mapping[str, Level]) -> str:
    return ", ".join(f"{factor}={level.label}" for factor, level in levels.items())


def _study(path: Path, start: Node, levels: Mapping[str, Level]) -> Loaded[Study]:
    tree: Node = Section(1, [])
    for level in levels.values():
        tree = over(tree, level.tree)
    return merged(start, path, tree)


def _form(loaded: Loaded[ExperimentFile], index: int, entry: StepEntry, language: str) -> Loaded[Form]:
    path = loaded.path.parent / entry.form
    if not is_regular(path) and not fault_of_name(entry.form):
        shipped = shipped_form(entry.form, language)
        path = shipped if is_regular(shipped) else path
    if not is_regular(path):
        names = ", ".join(sorted(form.stem for form in SHIPPED.glob("*.yaml")))
        raise loaded.fault(
            f"steps[{index}].form",
            f"the form {entry.form} does not exist",
            f"Write the path of a form, or one of {names}",
        )
    form = read_form(path)
    if entry.step is StepKind.CHECK and not any(item.is_checked for item in form.value.items):
        remedy = "Write `correct` for at least one item of the form"
        raise BadFile(path, "no item of this check has a right answer", remedy, key="items")
    return form


_TEXTS = {StepKind.INSTRUCTIONS, StepKind.CONSENT, StepKind.DEBRIEF}
_FORMS = {StepKind.CHECK, StepKind.FORM}


def name_of(index: int, entry: StepEntry) -> str:
    """Return the name of a step: its key `name`, the name of its form, or its kind with its number in the file."""
    return entry.name or (Path(entry.form).stem if entry.form else f"{entry.step}_{index + 1}")


def _problems(loaded: Loaded[ExperimentFile], conditions: int) -> Iterator[BadFile]:
    """Yield faults of values that are valid alone, but contradict each other."""
    file = loaded.value
    if len(file.title) > LONGEST_TITLE or visible(file.title) != file.title:
        problem = f"a title must be one line of at most {LONGEST_TITLE} characters"
        yield loaded.fault("title", problem, "Shorten the title: exports use it in file names and headings")
    for problem_of_section in (*recruiting_problems(file.recruiting), *lobby_problems(file.lobby)):
        yield loaded.fault(*problem_of_section)
    if not file.steps:
        yield loaded.fault("steps", "the study has no steps", "Write at least one line '- {step: trial}'")
    trials = [entry.each_condition for entry in file.steps if entry.step is StepKind.TRIAL]
    played = sum(conditions if each else 1 for each in trials)
    if file.seeds and len(file.seeds) < played:
        remedy = "Write one seed for each trial"
        yield loaded.fault("seeds", f"{played} trials need {played} seeds, but the list has {len(file.seeds)}", remedy)
    if conditions > 1 and not any(trials):
        remedy = "Mark the trial: {step: trial, each_condition: true}"
        yield loaded.fault("steps", "no trial is repeated for each condition", remedy)
    names: dict[str, int] = {}
    for index, entry in enumerate(file.steps):
        key, name = f"steps[{index}]", name_of(index, entry)
        if entry.step in _TEXTS and entry.text is None:
            yield loaded.fault(key, f"the step {entry.step} has no text", "Write text: FILE")
        if entry.text is not None and not is_regular(loaded.path.parent / entry.text):
            yield loaded.fault(f"{key}.text", f"the file {entry.text} does not exist", "Write the path of a text file")
        if entry.step in _FORMS and not entry.form:
            yield loaded.fault(key, f"the step {entry.step} has no form", "Write form: NAME")
        if name in names:
            remedy = "Write a different name for each step: `name: ...`"
            yield loaded.fault(key, f"{name} is also the name of step {names[name] + 1}", remedy)
        if entry.repeat and entry.repeat not in names and entry.repeat != name:
            yield loaded.fault(f"{key}.repeat", f"no earlier step has the name {entry.repeat}", _one_of(names))
        for answer in entry.when:
            step, _, item = answer.rpartition(".")
            if step not in names:
                yield loaded.fault(f"{key}.when", f"no earlier step has the name {step or item}", _one_of(names))
        names.setdefault(name, index)


def _one_of(names: Mapping[str, int]) -> str:
    return f"Write one of {', '.join(names)}" if names else "Delete the key, because this is the first step"


def drawn_seed(design: ExperimentDesign, trial: int) -> int:
    """Return the random seed of a trial, which is the same for all people.

    Args:
        design: the experiment.
        trial: number of the trial in the person's order, from 0.
    """
    file = design.file
    if file.seeds:
        return file.seeds[trial]
    return (file.seed * 1_000_003 + 7919 * trial) % LARGEST_SEED


def practice_seed(design: ExperimentDesign, attempt: int) -> int:
    """Return the random seed of a practice attempt. It is the same for all people, and no trial has this seed.

    Args:
        design: the experiment.
        attempt: number of the attempt, from 1.
    """
    trials = {*design.file.seeds} or {drawn_seed(design, trial) for trial in range(MOST_TRIALS)}
    drawn = int(noise.key(design.file.seed, "experiment", "practice", str(attempt))) % LARGEST_SEED
    return next(seed for seed in itertools.count(drawn) if seed not in trials) % LARGEST_SEED
