"""Editor's view of the file of a study with people, in the same form as a study file."""

import dataclasses
from collections.abc import Iterator, Mapping
from contextlib import suppress
from functools import cache
from itertools import chain
from pathlib import Path

from thbridge.app.compose.setting import read_map_of
from thbridge.experiment.design.advice import advice_on
from thbridge.experiment.design.experiment_file import ExperimentDesign, ExperimentFile, experiment_of
from thbridge.experiment.design.soundness import faults_of
from thbridge.experiment.design.steps import StepKind
from thbridge.experiment.folder import EXPERIMENT, ExperimentFolder
from thbridge.experiment.rehearsal.people import read_people
from thbridge.files.errors import BadFile, BadFiles, FaultCollection
from thbridge.files.language_texts import ENGLISH
from thbridge.files.yaml.tree import Section, parse
from thbridge.hunt.refusals import RequestRefused
from thbridge.study.study_file import Study, StudyFile
from ui.model.study_form.draft import StudyDraft
from ui.model.study_form.form import FieldKind, FormField, FormGroup, RepeatKind, form_of

HEADER = "# A study with people: the conditions, the number of people, and the steps of each person.\n"
_LABEL = "Study with people"
_LEVELS = "Write levels as [ONE, OTHER], {from: A, to: B, steps: N}, or {NAME: {KEY: VALUE, ...}, ...}"
_START = ExperimentFile(title="")

_OF_KINDS: Mapping[str, frozenset[StepKind]] = {
    "text": frozenset({StepKind.INSTRUCTIONS, StepKind.CONSENT, StepKind.DEBRIEF}),
    "form": frozenset({StepKind.CHECK, StepKind.FORM}),
    "results": frozenset({StepKind.DEBRIEF}),
    "right": frozenset({StepKind.CHECK}),
    "attempts": frozenset({StepKind.CHECK}),
    "repeat": frozenset({StepKind.CHECK}),
    "failed": frozenset({StepKind.CHECK}),
    "base": frozenset({StepKind.PRACTICE}),
    "at_least": frozenset({StepKind.PRACTICE}),
    "when_leaving": frozenset({StepKind.DEBRIEF}),
    "max_seconds": frozenset({StepKind.PRACTICE, StepKind.TRIAL}),
}
"""Keys that only some kinds of steps use."""


@dataclasses.dataclass(frozen=True, slots=True)
class ExperimentDraft(StudyDraft):
    """Text of the file of a study with people, with its form and its faults."""

    def keys_for(self, group: FormGroup) -> Mapping[str, FormField]:
        """Return the keys of study files that are not in a section yet."""
        taken = {field.label for field in group.fields}
        return {key: field for key, field in study_fields().items() if key not in taken}

    def allows_own_names(self, group: FormGroup) -> bool:
        """Return True for a section of factors. A factor whose name is not a key sets several keys in each level."""
        return group.key != "base"

    def add_key(self, group: FormGroup, name: str) -> str | RequestRefused:
        """Return the text after adding a key of a study file.

        If the key is a factor, the levels are all choices of the key. If the key has no choices, its
        default is the only level.
        """
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
            # The value belongs to a study, so a fault in it has no key of this file. The line of the fault decides.
            return field.line <= fault.line <= field.line + field.written.count("\n")
        # A fault of a whole step is shown at the field with the kind of the step.
        item, _, name = field.key.rpartition(".")
        return StudyDraft._is_of(self, fault, field) or (name == "step" and fault.key == item)


@cache
def study_fields() -> Mapping[str, FormField]:
    """Return the fields of study files that can be factors, by key."""
    form = form_of("", Section(1, []), StudyFile.of(Study()))
    return {field.key: field for field in form.all_fields()}


def is_experiment(path: Path) -> bool:
    """Return True for the file of a study with people; the name of the file decides."""
    return path.name == EXPERIMENT


def experiment_draft(path: Path, text: str) -> ExperimentDraft:
    """Read and check the text of the file of a study with people."""
    try:
        tree = parse(path, text)
    except BadFile as fault:
        form = form_of("", Section(1, []), _START, _LABEL)
        return ExperimentDraft(path, text, None, form, None, (fault,), ())
    draft = ExperimentDraft(path, text, tree, _heeded(form_of(text, tree, _START, _LABEL)), None, (), ())
    try:
        design = experiment_of(path, tree)
        faults = FaultCollection()
        faults.found += faults_of(design)
        with faults.kept():
            # After a change of factors or forms, the file for rehearsals may have faults.
            read_people(ExperimentFolder(path.parent).people, design)
        return dataclasses.replace(draft, faults=tuple(faults.found), notices=(*_on_maps(design), *advice_on(design)))
    except BadFiles as faults:
        return dataclasses.replace(draft, faults=faults.faults)
    except BadFile as fault:
        return dataclasses.replace(draft, faults=(fault,))


def _on_maps(design: ExperimentDesign) -> Iterator[str]:
    """Yield likely mistakes in maps.

    The costs of moves are not checked. That check takes half a second, which is too long while people type.
    """
    studies = {study.map: study for study in (design.study, *chain(*(cell.studies for cell in design.cells)))}
    for study in studies.values():
        yield from map(str, read_map_of(study, design.beside, with_costs=False).warnings)


def language_of(draft: StudyDraft) -> str:
    """Return the language of a study with people, or English if the file has faults."""
    with suppress(BadFile):
        return experiment_of(draft.path, parse(draft.path, draft.text)).study.dialogue.language
    return ENGLISH


def _heeded(form: FormGroup) -> FormGroup:
    """Return the form without keys that the kind of a step ignores, and with the help texts of study keys."""

    def heeded(group: FormGroup) -> FormGroup:
        if group.repeats is RepeatKind.STEPS:
            return dataclasses.replace(group, groups=tuple(map(_heeded_step, group.groups)))
        return _explained(group) if group.repeats is RepeatKind.KEYS else group

    return dataclasses.replace(form, groups=tuple(map(heeded, form.groups)))


def _explained(group: FormGroup) -> FormGroup:
    def explained(field: FormField) -> FormField:
        known = study_fields().get(field.label)
        meaning = "factor whose levels set several keys" if known is None else known.help
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
