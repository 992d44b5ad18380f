"""Faults of an experiment that would spoil or lose data.

An experiment with these faults can be read, because a study with data must open, continue and export. But the commands
`study check`, `study freeze` and the first `study run` refuse the experiment.
"""

from collections.abc import Iterator
from itertools import chain

from thbridge.experiment.allocation.places import Place
from thbridge.experiment.design.experiment_file import ExperimentDesign, name_of
from thbridge.experiment.design.lobby_faults import faults_of_lobby
from thbridge.experiment.design.plan import plan_of, repeated_from
from thbridge.experiment.design.steps import StepEntry, StepKind
from thbridge.experiment.questionnaires.form import MEASURED, Form, Item, Scale
from thbridge.experiment.questionnaires.scoring import NOT_APPLICABLE
from thbridge.files.disk.text_files import read_text
from thbridge.files.errors import BadFile, FaultCollection
from thbridge.files.yaml.load import Loaded
from thbridge.study.external_nodes import ExternalNodes
from thbridge.study.study_file import check_manners

GATHERING = {StepKind.PRACTICE, StepKind.CHECK, StepKind.TRIAL, StepKind.FORM}
"""Kinds of steps that record actions or answers of participants."""

_COLUMNS = """
actor advice advice_from advice_right advised advised_known after_advice_s after_advice_wall_s agreed agreed_at answer
answered appropriate attempt attention attention_checks attention_passed attention_s author away away_s bag began
began_s booked calibration cause cell challenges changes choice collisions concurrent_activity condition confidence
consent_sha256 content counts crashed data debriefed decided_by decision decision_s decision_wall_s dialogues
disagreed duration_s end ended ended_s energy_left energy_spent error_rate error_rate_set fan_out finished
first_choice front_end functional_delay game game_number game_s gave_in hesitation_s human_idle identified idle
interaction_s item items keyed kind late_share locution lsl_s matter misheard monotonic_ns most_lag_s moves
moves_failed name neglect_s not_applicable opener options options_shown order outcome over parent participant pasted
place points read_again reason recording refused_when_wrong repeated replied_s reply_s reply_wall_s resumed right
robot robot_idle rooms_reached rooms_visited scale score seed seen_s sequence sha256 shown_s shown_wall_s sim_seconds
simulated_s speaker stands state step subscale switched taken_when_right talk text time_s timed_out topic trial trust
under_way_s value waiting_s wall wall_seconds words
"""
TAKEN_COLUMNS = frozenset(_COLUMNS.split())
"""Names of columns of exported tables. A factor with one of these names would overwrite the column."""

_GROUP_COLUMNS = """
after_proposal_s agreed agreed_by agrees author_holder author_participant characters decided decided_by empty_seats
filled_s followed group handed_over holder holder_at_end incomplete left_s line most_waited_s moves needs objections
objections_followed objector objector_holder objector_participant people pictures programs proposed proposed_by
proposed_by_holder proposed_by_participant proposed_s read_after_s read_s reader reader_holder reader_participant
rejected_by replies resumed_s room seat seats texts to_all toward toward_participant treasure turn_share turns
typing_s vote_after_s voter voter_holder voter_participant votes votes_for waited_s
"""
GROUP_COLUMNS = frozenset(_GROUP_COLUMNS.split())
"""Names of further columns in studies with games of several people."""


def faults_of(design: ExperimentDesign) -> Iterator[BadFile]:
    """Yield all faults that would spoil data, with line numbers and remedies."""
    yield from _of_consent(design)
    yield from _of_factors(design)
    yield from _of_games(design)
    yield from faults_of_lobby(design)
    for index, entry in enumerate(design.file.steps):
        yield from _of_branch(design, index, entry)
        yield from _of_levels(design, index, entry)
        if entry.step is StepKind.TRIAL and not entry.each_condition and len(design.conditions) > 1:
            problem = f"this trial is not assigned to one of the {len(design.conditions)} conditions"
            yield design.fault(f"steps[{index}]", problem, "Write each_condition: true, or step: practice")
        if entry.step is StepKind.CHECK:
            yield from _of_check(design, index, entry)
        if entry.step in {StepKind.CHECK, StepKind.FORM}:
            yield from _of_right_answers(design, index, entry)
    yield from _of_repetitions(design)
    for form in {form.path: form for form in design.form_files.values()}.values():
        yield from _of_answers(form)


def _of_consent(design: ExperimentDesign) -> Iterator[BadFile]:
    """Yield faults of a study that would record people without their earlier consent."""
    for entry in design.file.steps:
        if entry.step is StepKind.CONSENT and entry.text is not None:
            path = design.path.parent / entry.text
            if not read_text(path).strip():
                yield BadFile(path, "the consent text is empty", "Write the text that participants must agree to")
    if design.file.consent_elsewhere.strip():
        return
    for cell in design.cells:
        # Consent steps that all participants of the group see.
        asked = [
            index
            for index, entry in enumerate(design.file.steps)
            if entry.step is StepKind.CONSENT and not entry.when and entry.only_at.items() <= cell.levels.items()
        ]
        where = f" at {cell.name}" if asked != _consents(design) and cell.name else ""
        if not asked:
            remedy = (
                "Write {step: consent, text: FILE} before all recorded steps; if participants give their consent "
                "outside of the program, write how: `consent_elsewhere: SENTENCE`"
            )
            yield design.fault("steps", f"no step asks for consent{where}", remedy)
            return
        for index, entry in enumerate(design.file.steps[: asked[0]]):
            if entry.step in GATHERING:
                problem = f"{name_of(index, entry)} is before the consent{where}, which is step {asked[0] + 1}"
                yield design.fault(f"steps[{index}]", problem, "Move the consent before this step")
                return


def _consents(design: ExperimentDesign) -> list[int]:
    return [index for index, entry in enumerate(design.file.steps) if entry.step is StepKind.CONSENT]


def _of_factors(design: ExperimentDesign) -> Iterator[BadFile]:
    taken = TAKEN_COLUMNS | GROUP_COLUMNS if design.has_groups else TAKEN_COLUMNS
    for section, levels in (("within", design.conditions[0].levels), ("between", design.cells[0].levels)):
        for factor in levels:
            if factor in taken:
                problem = "exported tables already have a column with this name"
                yield design.fault(f"{section}.{factor}", problem, f"Write another name, such as {factor}_level")


def _of_games(design: ExperimentDesign) -> Iterator[BadFile]:
    """Yield faults of studies whose games the kiosk's simulated robots cannot play."""
    faults = FaultCollection()
    practices = chain.from_iterable(design.practices.values())
    for study in chain.from_iterable((*(cell.studies for cell in design.cells), *practices)):
        with faults.kept():
            check_manners(Loaded(design.path, study, design.lines), "base.")
        if study.robots_from.is_real:
            faults.found.append(
                design.fault("base.robots_from", "the kiosk supports only simulated robots", "Write sim")
            )
        if study.external_nodes is not ExternalNodes.NONE:
            problem = "the kiosk's robots cannot use external ROS nodes"
            faults.found.append(design.fault("base.external_nodes", problem, "Write none"))
    # A fault may occur in each condition; report it once.
    yield from {str(fault): fault for fault in faults.found}.values()


def _of_branch(design: ExperimentDesign, index: int, entry: StepEntry) -> Iterator[BadFile]:
    """Yield faults of a step whose condition on earlier answers can never be met."""
    names = {name_of(number, step): number for number, step in enumerate(design.file.steps[:index])}
    for branch, answer in entry.when.items():
        key = f"steps[{index}].when"
        step, _, name = branch.rpartition(".")
        form = design.forms.get(names.get(step, -1))
        if form is None:
            yield design.fault(key, f"{step} has no form, so it has no answers", "Write the name of a step with a form")
            continue
        item = next((item for item in form.items if item.id == name), None)
        if item is None:
            remedy = f"Write one of {', '.join(f'{step}.{item.id}' for item in form.items)}"
            yield design.fault(key, f"{step} has no item {name}", remedy)
        elif item.scale is not Scale.CHOICE or item.several:
            yield design.fault(
                key, f"{branch} is not an item with one chosen answer", "Name an item with the scale choice"
            )
        elif answer not in (offered := [*item.options, *([NOT_APPLICABLE] if item.not_applicable else [])]):
            yield design.fault(
                key, f"{answer!r} is not a possible answer to {branch}", f"Write one of {', '.join(offered)}"
            )


def _of_levels(design: ExperimentDesign, index: int, entry: StepEntry) -> Iterator[BadFile]:
    """Yield faults of the key `only_at` of a step: unknown levels, and levels that do not apply to this step."""
    key, factors = f"steps[{index}].only_at", _levels_of(design)
    for factor, level in entry.only_at.items():
        if factor not in factors:
            remedy = f"Write one of {', '.join(factors)}" if factors else "Delete the line: the study has no factors"
            yield design.fault(key, f"{factor} is not a factor", remedy)
        elif level not in factors[factor]:
            yield design.fault(key, f"{factor} has no level {level}", f"Write one of {', '.join(factors[factor])}")
        elif factor in design.conditions[0].levels and not entry.each_condition:
            problem = f"each participant plays at all levels of {factor}, but this step belongs to no condition"
            yield design.fault(key, problem, "Write each_condition: true, or delete the line")


def _levels_of(design: ExperimentDesign) -> dict[str, tuple[str, ...]]:
    """Return the levels of each factor, in the file's order."""
    found: dict[str, dict[str, None]] = {}
    for combination in (*(each.levels for each in design.conditions), *(each.levels for each in design.cells)):
        for factor, level in combination.items():
            found.setdefault(factor, {})[level] = None
    return {factor: tuple(levels) for factor, levels in found.items()}


def _of_check(design: ExperimentDesign, index: int, entry: StepEntry) -> Iterator[BadFile]:
    """Yield faults of a check that no participant can pass."""
    asked = [item for item in design.forms[index].items if item.is_checked]
    if entry.right is not None and entry.right > len(asked):
        problem = f"the check needs {entry.right} right answers, but only {len(asked)} items have a right answer"
        yield design.fault(f"steps[{index}].right", problem, f"Write at most {len(asked)}")


def _of_right_answers(design: ExperimentDesign, index: int, entry: StepEntry) -> Iterator[BadFile]:
    """Yield faults of right answers that participants cannot give, in checks and in attention checks."""
    form, is_check = design.form_files[index], entry.step is StepKind.CHECK
    for number, item in enumerate(form.value.items):
        if not item.is_checked or not (item.attention or is_check):
            continue
        correct = {"correct": item.correct} if item.correct is not None else {}
        keys = {f"correct_by_condition.{key}": answer for key, answer in item.correct_by_condition.items()}
        for key, answer in {**correct, **keys}.items():
            if never := _why_never_given(item, answer):
                yield form.fault(f"items[{number}].{key}", *never)
        if item.correct_by_condition:
            for fault in _of_answer_key(design, entry, item):
                yield form.fault(f"items[{number}].correct_by_condition", *fault)


def _why_never_given(item: Item, answer: str) -> tuple[str, str] | None:
    """Return the problem and the remedy if no participant can give this right answer, or None."""
    if item.scale is Scale.CHOICE:
        if item.several:
            return "an item with several answers has no single right answer", "Delete `several`"
        if answer not in item.options:
            return f"{answer!r} is not one of the item's options", f"Write one of {', '.join(item.options)}"
    elif item.scale in {*MEASURED, Scale.NUMBER}:
        try:
            within = item.least <= float(answer) <= item.greatest
        except ValueError:
            within = False
        if not within:
            return f"{answer!r} is not a possible answer", f"Write a number from {item.least:g} to {item.greatest:g}"
    return None


def _of_answer_key(design: ExperimentDesign, entry: StepEntry, item: Item) -> Iterator[tuple[str, str]]:
    """Yield the problem and the remedy, unless each participant has exactly one right answer by condition."""
    factors = _levels_of(design)
    named = dict.fromkeys(key.partition("=")[0] for key in item.correct_by_condition)
    unknown = [factor for factor in named if factor not in factors]
    if unknown:
        known = f"Write FACTOR=LEVEL with one of {', '.join(factors)}" if factors else "Write `correct` instead"
        yield f"{unknown[0]} is not a factor of the study", known
        return
    if len(named) > 1:
        yield f"the right answers depend on several factors ({', '.join(named)})", "Use only one factor"
        return
    (factor,) = named
    levels = factors[factor]
    written = [key.partition("=")[2] for key in item.correct_by_condition]
    if lost := next((level for level in written if level not in levels), None):
        yield f"{factor} has no level {lost}", f"Write one of {', '.join(levels)}"
    missing = [level for level in levels if level not in written]
    if missing and item.correct is None:
        yield (
            f"the right answer at {factor}={missing[0]} is missing",
            "Write a right answer for each level, or add `correct` for all other levels",
        )
    if factor in design.conditions[0].levels and not entry.each_condition:
        problem = f"each participant plays at all levels of {factor}, but this item is asked only once"
        yield problem, "Write each_condition: true for the step and move it next to the trial, or write only `correct`"


def _of_repetitions(design: ExperimentDesign) -> Iterator[BadFile]:
    """Yield faults of checks that may repeat steps, if these include steps that count as data."""
    # The order of the kinds of steps is the same at each place.
    plan, found = plan_of(design, Place(0, 0, 0)), dict[int, BadFile]()
    for check in plan:
        if check.entry.step is not StepKind.CHECK or check.entry.attempts == 1:
            continue
        again = plan[repeated_from(plan, check) - 1 : check.number - 1]
        data = next((step for step in again if step.entry.step in {StepKind.TRIAL, StepKind.FORM}), None)
        if data is not None:
            problem = f"a participant who fails the check would repeat {data.name}, which counts as data"
            remedy = "Name a later step (for a check with each_condition, in the same condition), or delete `repeat`"
            found.setdefault(check.index, design.fault(f"steps[{check.index}].repeat", problem, remedy))
    yield from found.values()


def _of_answers(form: Loaded[Form]) -> Iterator[BadFile]:
    """Yield faults of items with two equal answers, or with labels that their scale does not support."""
    for number, item in enumerate(form.value.items):
        key = f"items[{number}]"
        for name, words in (("options", item.options), ("labels", item.labels if item.options else ())):
            if twice := next((word for word in words if words.count(word) > 1), None):
                yield form.fault(f"{key}.{name}", f"{twice!r} is listed twice", "Keep one of the two")
        if item.not_applicable and NOT_APPLICABLE in item.options:
            yield form.fault(
                f"{key}.options", f"`not_applicable` already adds the answer {NOT_APPLICABLE!r}", "Delete this option"
            )
        if item.labels and item.scale not in {Scale.LIKERT, Scale.CHOICE}:
            yield form.fault(
                f"{key}.labels", f"an item with the scale {item.scale} has words only at its ends", "Write low and high"
            )
