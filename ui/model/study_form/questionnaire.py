"""Editor's view of a questionnaire of a study with people, in the same form as a study file."""

import dataclasses
import re
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from thbridge.experiment.folder import EXPERIMENT
from thbridge.experiment.questionnaires.form import MEASURED, Form, Scale, form_of_tree
from thbridge.files.disk.text_files import read_text
from thbridge.files.errors import BadFile, BadFiles
from thbridge.files.yaml.places import node_at, steps_of
from thbridge.files.yaml.tree import Listing, Scalar, Section, parse
from ui.model.study_form.draft import StudyDraft
from ui.model.study_form.form import FormField, FormGroup, form_of

START = """\
title: A questionnaire
items:
  - {id: item_1, text: "Text of the item", scale: likert, points: 7, low: not at all, high: very much}
"""
"""Text of a new questionnaire."""
_LABEL = "Questionnaire"
_ITEMS = re.compile(r"^items\s*:", re.MULTILINE)
_POINTS = frozenset({Scale.LIKERT, Scale.DIFFERENTIAL})
_OF_SCALES: Mapping[str, frozenset[Scale]] = {
    "points": _POINTS,
    "low": frozenset(MEASURED),
    "high": frozenset(MEASURED),
    "labels": frozenset({Scale.LIKERT}),
    "minimum": frozenset({Scale.ANALOGUE, Scale.NUMBER}),
    "maximum": frozenset({Scale.ANALOGUE, Scale.NUMBER}),
    "step": frozenset({Scale.ANALOGUE}),
    "unit": frozenset({Scale.NUMBER}),
    "options": frozenset({Scale.CHOICE}),
    "several": frozenset({Scale.CHOICE}),
    "shuffle": frozenset({Scale.CHOICE}),
    "pinned": frozenset({Scale.CHOICE}),
    "subscale": frozenset({*MEASURED, Scale.NUMBER}),
    "reverse": frozenset(MEASURED),
}
"""Keys of items that only some scales use."""


@dataclass(frozen=True, slots=True)
class QuestionnaireDraft(StudyDraft):
    """Text of a questionnaire, with its form and its faults."""

    def keys_for(self, group: FormGroup) -> Mapping[str, FormField]:
        """Return the keys that can be added to a section of values for all items."""
        taken = {field.label for field in group.fields} | {"id", "text"}
        return {key: field for key, field in _item_fields().items() if key not in taken}

    def _is_of(self, fault: BadFile, field: FormField) -> bool:
        # A fault of a whole item is shown at the field `text` of the item.
        item, _, name = field.key.rpartition(".")
        return StudyDraft._is_of(self, fault, field) or (
            name == "text" and fault.path == self.path and fault.key == item
        )


def is_questionnaire(path: Path, text: str) -> bool:
    """Return True for a file that has items, or that `experiment.yaml` in the same folder names as a form."""
    if _ITEMS.search(text):
        return True
    beside = path.parent / EXPERIMENT
    with suppress(BadFile):
        if beside.is_file():
            steps = node_at(parse(beside, read_text(beside)), steps_of("steps"))
            forms = [node_at(step, steps_of("form")) for step in steps.items] if isinstance(steps, Listing) else []
            return any(isinstance(form, Scalar) and form.text == path.name for form in forms)
    return False


def questionnaire_draft(path: Path, text: str) -> QuestionnaireDraft:
    """Read and check the text of a questionnaire."""
    start = Form(title="")
    try:
        tree = parse(path, text)
    except BadFile as fault:
        return QuestionnaireDraft(path, text, None, form_of("", Section(1, []), start, _LABEL), None, (fault,), ())
    draft = QuestionnaireDraft(path, text, tree, _heeded(form_of(text, tree, start, _LABEL)), None, (), ())
    try:
        form_of_tree(path, tree)
    except BadFiles as faults:
        return dataclasses.replace(draft, faults=faults.faults)
    except BadFile as fault:
        return dataclasses.replace(draft, faults=(fault,))
    return draft


@cache
def _item_fields() -> Mapping[str, FormField]:
    """Return the keys of items, each with its field."""
    tree = parse(Path("items"), "items: [{}]")
    form = form_of("items: [{}]", tree, Form(title=""))
    return {
        field.key.rpartition(".")[2]: dataclasses.replace(field, key=field.key.rpartition(".")[2])
        for group in form.groups
        if group.key == "items"
        for field in group.all_fields()
    }


def _heeded(form: FormGroup) -> FormGroup:
    """Return the form with the common values of the items as defaults, and without keys that an item's scale
    ignores."""
    groups = {group.key: group for group in form.groups}
    alike = {field.label: field.value for field in groups["like"].fields}

    def heeded(item: FormGroup) -> FormGroup:
        fields = {field.key.rpartition(".")[2]: field for field in item.fields}
        fields |= {
            name: dataclasses.replace(fields[name], default=value) for name, value in alike.items() if name in fields
        }
        scale = fields["scale"].value
        shown = (
            field
            for name, field in fields.items()
            if field.written is not None or name not in _OF_SCALES or scale in _OF_SCALES[name]
        )
        return dataclasses.replace(item, fields=tuple(shown))

    def explained(field: FormField) -> FormField:
        known = _item_fields().get(field.label)
        return field if known is None else dataclasses.replace(field, help=known.help)

    like = dataclasses.replace(groups["like"], fields=tuple(map(explained, groups["like"].fields)))
    items = dataclasses.replace(groups["items"], groups=tuple(map(heeded, groups["items"].groups)))
    groups |= {"like": like, "items": items}
    return dataclasses.replace(form, groups=tuple(groups.values()))
