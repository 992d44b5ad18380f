"""The file of an experiment: differences between conditions, number of people, and the steps of each person."""

import itertools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from pathlib import Path

from sim.numerics import noise
from sim.parameters import param
from thbridge.batch.settings import SettingCache
from thbridge.experiment.allocation.latin_square import Order, balanced_latin_square, cyclic_latin_square
from thbridge.experiment.allocation.places import Allocation
from thbridge.experiment.design.practice import practice_problems, practice_studies, without_bases
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
"""Largest number of conditions that one person goes through."""
MOST_PEOPLE = 100_000
MOST_TRIALS = 64
"""Number of trials of a person; practice games avoid the seeds of these trials."""
LONGEST_TITLE = 200
"""Largest number of letters of a title."""
LARGEST_SEED = 2**31 - 1
_OWN_READING = ("base", "within", "between")
"""Keys of an experiment that contain keys of studies."""


class OrderKind(StrEnum):
    """Rule by which conditions are ordered for each person."""

    BALANCED = "balanced"
    """Balanced Latin square: each condition comes equally often at every position, and after every other condition."""
    CYCLIC = "cyclic"
    """Plain Latin square: each condition comes equally often at every position.

    An odd number of conditions needs half as many orders as with a balanced square.
    """
    FIXED = "fixed"
    """The order in the file."""


class WhoBegins(StrEnum):
    """Person who begins the next run on the laboratory's computer."""

    PARTICIPANT = "participant"
    """The participant, who sits down and presses a button."""
    RESEARCHER = "researcher"
    """The researcher, in their own window or with a key combination."""


@dataclass(frozen=True, slots=True)
class RecruitingSection:
    """Questions to people whom a recruiting service has sent."""

    ask: str = param("", "question for the code from the service, before the first step; if empty, it is not asked")


@dataclass(frozen=True, slots=True)
class ExperimentFile:
    """Contents of the file of an experiment."""

    title: str = field(metadata={"help": "title of the study"})
    seed: int = param(1, "random seed", "", 0, LARGEST_SEED)
    study: Path | None = param(None, "study file of all games, relative to this file's folder; if null, the defaults")
    base: Mapping[str, str] = field(default_factory=dict, metadata={"help": "keys of the study, overriding its file"})
    within: Mapping[str, str] = field(
        default_factory=dict, metadata={"help": "factors with all of their levels for each participant"}
    )
    between: Mapping[str, str] = field(
        default_factory=dict, metadata={"help": "factors with one of their levels for each participant"}
    )
    quota: int = param(
        12, "number of runs that count, for each combination of levels between people", "", 1, MOST_PEOPLE
    )
    order: OrderKind = param(OrderKind.BALANCED, "how conditions are ordered for each person")
    in_block: int = param(1, "number of places per block for each combination of levels between people", "", 1, 100)
    seeds: tuple[int, ...] = param(
        (), "seeds of the games; the first one is for every person's first trial; if empty, drawn", "", 0, LARGEST_SEED
    )
    begins: WhoBegins = param(WhoBegins.PARTICIPANT, "who begins the run of the next person")
    recruiting: RecruitingSection = param(RecruitingSection(), "questions to people from a recruiting service")
    recruitment: str = param("", "sentence on how people were found and paid, for the methods text")
    ethics: str = param(
        "", "sentence on the approval by an ethics committee, with its name and number, for the methods text"
    )
    sample_size_reason: str = param("", "sentence on the reason for the quota, for the methods text")
    exclusions: tuple[str, ...] = param(
        (), "rules by which researchers exclude runs or answers, one sentence each, for the methods text"
    )
    preregistration: str = param("", "sentence on where the study is registered, for the methods text")
    deviations: tuple[str, ...] = param(
        (), "deviations from the preregistration with their reasons, one sentence each, for the methods text"
    )
    data_availability: str = param("", "sentence on where data and materials are, for the methods text")
    most_lag: float | None = param(
        None,
        "largest lag of a game behind real time (a slow machine lags); a run with a larger lag does not count, and its "
        "place is free again; if null, every run counts",
        "s",
        0,
        3600,
    )
    consent_elsewhere: str = param(
        "",
        "sentence on how participants gave consent outside of the program, such as on paper, for the methods text; "
        "if empty, a step asks for it",
    )
    markers: bool = param(default=False, help="send each event of the log to other recorders (Lab Streaming Layer)")
    steps: tuple[StepEntry, ...] = param((), "steps of a person, in this order")


@dataclass(frozen=True, slots=True)
class ExperimentCondition:
    """A condition that people meet.

    Attributes:
        name: its levels in words; empty if nothing differs within people.
        levels: the level of each factor within people.
    """

    name: str
    levels: Mapping[str, str]


@dataclass(frozen=True, slots=True)
class Cell:
    """A combination of levels of the factors between people.

    Attributes:
        name: its levels in words; empty if nothing differs between people.
        levels: the level of each factor between people.
        studies: the study of each condition in this cell.
    """

    name: str
    levels: Mapping[str, str]
    studies: tuple[Study, ...]


@dataclass(frozen=True, slots=True)
class ExperimentDesign:
    """An experiment, read and checked.

    Attributes:
        path: its file.
        `beside`: the folder that paths in its studies are relative to.
        file: contents of the file.
        study: the study of all games, before conditions change it.
        conditions: the conditions within people, in the file's order.
        cells: combinations between people.
        orders: orders of conditions that people are assigned to.
        forms: the form of each step that has one, by the step's index.
        practices: the studies of each practice game, by the step's index. For each combination between people, one
            study for each condition in which the person may play it.
        lines: line of each key and item of the file, by its path.
        form_files: each form with the lines of its file, by the step's index.
        doubts: possible mistakes in the files that studies name, if these files were read, too.
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
        """Return a fault at a key of the file, with the nearest line."""
        return Loaded(self.path, self.file, self.lines).fault(key, problem, remedy)

    @property
    def allocation(self) -> Allocation:
        """Assignment of places."""
        file = self.file
        return Allocation(len(self.cells), len(self.orders), file.quota, file.seed, file.in_block)

    def levels_at(self, cell: int, condition: int | None) -> Mapping[str, str]:
        """Return the level of each factor that a participant of a cell meets in a step.

        For steps that belong to no condition, factors within people are left out.
        """
        within = {} if condition is None else self.conditions[condition].levels
        return {**self.cells[cell].levels, **within}


def read_experiment(path: Path, *, with_files: bool = False) -> ExperimentDesign:
    """Read an experiment, with the study of every condition, and every form.

    Args:
        path: its file.
        with_files: True to also read the files that its games need (maps, templates, words), and check that they can
            start.

    Raises:
        BadFile: the experiment cannot be read, or it has faults. BadFiles reports all faults at once.
    """
    return experiment_of(path, parse(path, read_text(path)), with_files=with_files)


def experiment_of(path: Path, whole: Node, *, with_files: bool = False) -> ExperimentDesign:
    """Read the tree of an experiment's file, as `read_experiment` does; `path` is named in faults."""
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
        raise loaded.fault("within", f"{len(conditions)} conditions for each person", "Write fewer factors or levels")
    cells = []
    # Faults of combined values are reported with a line that people wrote.
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
        raise loaded.fault("between", f"{both} is a factor within people, too", "Keep one of the two")
    if "seed" in {*within, *between}:
        raise loaded.fault("within", "seed cannot be a factor: all conditions share one seed", "Write `seeds`")


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
        raise loaded.fault(f"steps[{index}].form", f"no form {entry.form} exists", f"Name a file, or one of {names}")
    form = read_form(path)
    if entry.step is StepKind.CHECK and not any(item.is_checked for item in form.value.items):
        remedy = "Write `correct` for at least one of its items"
        raise BadFile(path, "a check needs right answers", remedy, key="items")
    return form


_TEXTS = {StepKind.INSTRUCTIONS, StepKind.CONSENT, StepKind.DEBRIEF}
_FORMS = {StepKind.CHECK, StepKind.FORM}


def name_of(index: int, entry: StepEntry) -> str:
    """Return the name of a step: its own name, the name of its form, or its kind and its number in the file."""
    return entry.name or (Path(entry.form).stem if entry.form else f"{entry.step}_{index + 1}")


def _problems(loaded: Loaded[ExperimentFile], conditions: int) -> Iterator[BadFile]:
    """Yield faults of values that are valid alone, but not together."""
    file = loaded.value
    if len(file.title) > LONGEST_TITLE or visible(file.title) != file.title:
        problem = f"a title has at most {LONGEST_TITLE} letters, on one line"
        yield loaded.fault("title", problem, "Shorten it: exports name files and headings after it")
    if not file.steps:
        yield loaded.fault("steps", "participants have nothing to do", "Write at least one line '- {step: trial}'")
    trials = [entry.each_condition for entry in file.steps if entry.step is StepKind.TRIAL]
    played = sum(conditions if each else 1 for each in trials)
    if file.seeds and len(file.seeds) < played:
        remedy = f"Write {played}, one for each trial of a person"
        yield loaded.fault("seeds", f"{len(file.seeds)} seeds for {played} trials", remedy)
    if conditions > 1 and not any(trials):
        remedy = "Mark the trial: {step: trial, each_condition: true}"
        yield loaded.fault("steps", "no trial comes once for each condition", remedy)
    names: dict[str, int] = {}
    for index, entry in enumerate(file.steps):
        key, name = f"steps[{index}]", name_of(index, entry)
        if entry.step in _TEXTS and entry.text is None:
            yield loaded.fault(key, f"{entry.step} without a text", "Write text: FILE")
        if entry.text is not None and not is_regular(loaded.path.parent / entry.text):
            yield loaded.fault(f"{key}.text", f"file {entry.text} does not exist", "Write the path of a text")
        if entry.step in _FORMS and not entry.form:
            yield loaded.fault(key, f"a {entry.step} without a form", "Write form: NAME")
        if name in names:
            remedy = "Give each a name of its own: `name: ...`"
            yield loaded.fault(key, f"{name} is also the name of step {names[name] + 1}", remedy)
        if entry.repeat and entry.repeat not in names and entry.repeat != name:
            yield loaded.fault(f"{key}.repeat", f"no earlier step has the name {entry.repeat}", _one_of(names))
        for answer in entry.when:
            step, _, item = answer.rpartition(".")
            if step not in names:
                yield loaded.fault(f"{key}.when", f"no earlier step has the name {step or item}", _one_of(names))
        names.setdefault(name, index)


def _one_of(names: Mapping[str, int]) -> str:
    return f"Write one of {', '.join(names)}" if names else "Delete it: this is the first step"


def drawn_seed(design: ExperimentDesign, trial: int) -> int:
    """Return the seed of the game with this number, from 0. It is the same for all people."""
    file = design.file
    if file.seeds:
        return file.seeds[trial]
    return (file.seed * 1_000_003 + 7919 * trial) % LARGEST_SEED


def practice_seed(design: ExperimentDesign, attempt: int) -> int:
    """Return the seed of a practice attempt, from 1: the same for all people, and different from every trial's."""
    trials = {*design.file.seeds} or {drawn_seed(design, trial) for trial in range(MOST_TRIALS)}
    drawn = int(noise.key(design.file.seed, "experiment", "practice", str(attempt))) % LARGEST_SEED
    return next(seed for seed in itertools.count(drawn) if seed not in trials) % LARGEST_SEED
