"""The file of a study with people while it is edited, by the same form as a study file."""

import dataclasses
from collections.abc import Collection, Mapping
from difflib import get_close_matches
from functools import cache
from pathlib import Path

from thbridge.experiment.design.advice import advice_on
from thbridge.experiment.design.experiment_file import ExperimentFile, experiment_of
from thbridge.experiment.design.soundness import faults_of
from thbridge.experiment.design.steps import StepKind
from thbridge.experiment.folder import EXPERIMENT
from thbridge.files.errors import BadFile, BadFiles
from thbridge.files.yaml.tree import Section, parse
from thbridge.hunt.refusals import RequestRefused
from thbridge.study.study_file import Study, StudyFile
from ui.model.study_form.draft import HEADER, StudyDraft, draft_of, search_fields
from ui.model.study_form.form import FieldKind, FormField, FormGroup, RepeatKind, form_of

_HEADER = "# A study with people: what differs between conditions, how many people, and what each goes through.\n"
_LABEL = "Study with people"
_LEVELS = "Levels: [ONE, OTHER], {from: A, to: B, steps: N}, or {NAME: {KEY: VALUE, ...}, ...}"
_START = ExperimentFile(title="")

_OF_KINDS: Mapping[str, frozenset[StepKind]] = {
    "text": frozenset({StepKind.INSTRUCTIONS, StepKind.CONSENT, StepKind.DEBRIEF}),
    "form": frozenset({StepKind.CHECK, StepKind.FORM}),
    "right": frozenset({StepKind.CHECK}),
    "attempts": frozenset({StepKind.CHECK}),
    "repeat": frozenset({StepKind.CHECK}),
    "failed": frozenset({StepKind.CHECK}),
    "base": frozenset({StepKind.PRACTICE}),
    "at_least": frozenset({StepKind.PRACTICE}),
    "when_leaving": frozenset({StepKind.DEBRIEF}),
    "max_seconds": frozenset({StepKind.PRACTICE, StepKind.TRIAL}),
}
"""Keys of steps that only some kinds of them heed."""


@dataclasses.dataclass(frozen=True, slots=True)
class ExperimentDraft(StudyDraft):
    """A text of the file of a study with people, and all that follows from it."""

    def add_key(self, group: FormGroup, name: str) -> str | RequestRefused:
        """Return the text with another key of a study: a factor has all choices as its levels, or the default."""
        field = study_fields().get(name)
        value = "null" if field is None else field.default
        if group.key != "base" and field is not None:
            truth = ("true", "false") if field.kind is FieldKind.BOOLEAN else (field.default,)
            value = f"[{', '.join(field.choices or truth)}]"
        return self._put(f'{group.key}."{name}"', value)

    def _is_of(self, fault: BadFile, field: FormField) -> bool:
        if fault.path != self.path or fault.key is None:
            return False
        if field.own_key and field.line is not None and field.written is not None and fault.line is not None:
            # Its value is of a study, whose reader knows no keys of this file.
            return field.line <= fault.line <= field.line + field.written.count("\n")
        # A fault of a whole step stands at its kind.
        item, _, name = field.key.rpartition(".")
        return StudyDraft._is_of(self, fault, field) or (name == "step" and fault.key == item)


@cache
def study_fields() -> Mapping[str, FormField]:
    """The keys of studies, for factors, each with its field."""
    return {field.key: field for field in _study_form().all_fields()}


@cache
def _study_form() -> FormGroup:
    """The form of an empty study."""
    return form_of("", Section(1, []), StudyFile.of(Study()))


def keys_like(words: str, without: Collection[str] = ()) -> tuple[FormField, ...]:
    """Return the keys of studies for a search, the likeliest first; all of them if the words are empty.

    A key fits if each word occurs in its name, its meaning or its choices. If none fits, those with the most similar
    names are returned, so that a slip of the keyboard still finds its key.

    Args:
        words: what to search for.
        without: keys to leave out.
    """
    free = {key: field for key, field in study_fields().items() if key not in without}
    if not words.strip():
        return tuple(free.values())
    found = [field for field in search_fields(_study_form(), words) if field.key in free]
    if found:
        return tuple(found)
    last = {key.rpartition(".")[2]: key for key in reversed(free)}
    wanted = "_".join(words.lower().split())
    close = get_close_matches(wanted.rpartition(".")[2], last, n=5) or get_close_matches(wanted, free, n=5)
    return tuple(free[last.get(name, name)] for name in close)


def is_experiment(path: Path) -> bool:
    """Return True for the file of a study with people, which is known by its name."""
    return path.name == EXPERIMENT


def draft_of_file(path: Path, text: str) -> StudyDraft:
    """Read and check the text of a study file, or of a study with people, as `thbridge study check` does."""
    return _experiment_draft(path, text) if is_experiment(path) else draft_of(path, text)


def header_of(path: Path) -> str:
    """Return the first line of a new file."""
    return _HEADER if is_experiment(path) else HEADER


def _experiment_draft(path: Path, text: str) -> ExperimentDraft:
    try:
        tree = parse(path, text)
    except BadFile as fault:
        form = form_of("", Section(1, []), _START, _LABEL)
        return ExperimentDraft(path, text, None, form, None, (fault,), ())
    draft = ExperimentDraft(path, text, tree, _heeded(form_of(text, tree, _START, _LABEL)), None, (), ())
    try:
        design = experiment_of(path, tree)
        return dataclasses.replace(draft, faults=tuple(faults_of(design)), notices=advice_on(design))
    except BadFiles as faults:
        return dataclasses.replace(draft, faults=faults.faults)
    except BadFile as fault:
        return dataclasses.replace(draft, faults=(fault,))


def _heeded(form: FormGroup) -> FormGroup:
    """The form without those keys of steps that their kinds do not heed, and with the meaning of studies' keys."""

    def heeded(group: FormGroup) -> FormGroup:
        if group.repeats is RepeatKind.STEPS:
            return dataclasses.replace(group, groups=tuple(map(_heeded_step, group.groups)))
        return _explained(group) if group.repeats is RepeatKind.KEYS else group

    return dataclasses.replace(form, groups=tuple(map(heeded, form.groups)))


def _explained(group: FormGroup) -> FormGroup:
    def explained(field: FormField) -> FormField:
        known = study_fields().get(field.label)
        meaning = "levels of several keys each" if known is None else known.help
        choices = "" if known is None or not known.choices else f" ({', '.join(known.choices)})"
        how = "" if group.key == "base" else f". {_LEVELS}"
        return dataclasses.replace(field, help=f"{meaning}{choices}{how}")

    return dataclasses.replace(group, fields=tuple(map(explained, group.fields)))


def _heeded_step(step: FormGroup) -> FormGroup:
    values = {field.key.rpartition(".")[2]: field for field in step.fields}
    kind = values["step"].value
    fields = tuple(
        field
        for name, field in values.items()
        if field.written is not None or name not in _OF_KINDS or kind in _OF_KINDS[name]
    )
    name = values["name"].written or values["form"].written
    number = step.label.partition(":")[0]
    label = f"{number}: {kind}" + (f" ({name})" if name and name != kind else "")
    return dataclasses.replace(step, label=label, fields=fields)
