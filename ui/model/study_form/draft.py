"""Editor's view of a study file: text, form and faults."""

import dataclasses
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path

from thbridge.app.compose.setting import read_setting
from thbridge.files.errors import BadFile, BadFiles
from thbridge.files.yaml.edit import moved, with_value, without
from thbridge.files.yaml.places import node_at, path_of, steps_of
from thbridge.files.yaml.tree import Node, Section, parse
from thbridge.hunt.refusals import RequestRefused
from thbridge.study.built_in import STANDARD
from thbridge.study.noise import TARGET_PATHS
from thbridge.study.study_file import Study, StudyFile, load_study_tree, study_before
from ui.model.shared.differences import differences
from ui.model.study_form.form import FormField, FormGroup, RepeatKind, editable_text, form_of, typed_as_yaml

HEADER = f"""\
# A study. Every key is optional. If a key is missing, its default applies.
templates: {STANDARD.templates}
"""
"""Beginning of a new file."""

_NEW_ITEMS: Mapping[str, str] = {
    "things": '{{name: "thing {number}", shape: crate, at: [0, 0, 0]}}',
    "mishaps": "{{robot: 1, what: dies, time: 60}}",
    "steps": "{{step: pause}}",
    "items": '{{id: item_{number}, text: "Text of the item"}}',
}


@dataclass(frozen=True, slots=True)
class StudyDraft:
    """Text of a study file, with the form, the study and the faults that result from it.

    Attributes:
        path: path of the file. Relative paths in the text start from the folder of the file.
        text: the present text.
        tree: the text as a tree; None if the text is not YAML.
        form: fields of the text; if the text is not YAML, fields of an empty file.
        study: study that the text describes; None if there is a fault.
        faults: faults, found by the same reader that all programs use.
        notices: valid entries of the text that have no effect.
    """

    path: Path
    text: str
    tree: Node | None
    form: FormGroup
    study: Study | None
    faults: tuple[BadFile, ...]
    notices: tuple[str, ...]

    def faults_of(self, field: FormField) -> tuple[BadFile, ...]:
        """Return the faults of one field."""
        return tuple(fault for fault in self.faults if self._is_of(fault, field))

    def field_of(self, fault: BadFile) -> FormField | None:
        """Return the field that has a fault; None if no field has it."""
        return next((field for field in self.form.all_fields() if self._is_of(fault, field)), None)

    def _is_of(self, fault: BadFile, field: FormField) -> bool:
        if fault.key is None or fault.path != self.path:
            return False
        keys = {field.key, field.place}
        section, _, inner = field.key.partition(".")
        if section == "noise" and inner in TARGET_PATHS:
            keys.add(TARGET_PATHS[inner])
        return any(fault.key == key or fault.key.startswith(f"{key}[") for key in keys)

    def fields(self) -> Mapping[str, FormField]:
        """Return all fields by their keys."""
        return {field.key: field for field in self.form.all_fields()}

    def groups(self) -> Mapping[str, FormGroup]:
        """Return all sections by their keys."""
        return {group.key: group for group in self.form.all_groups()}

    def set(self, field: FormField, typed: str) -> str | RequestRefused:
        """Return the text with a new value in a field. An empty value resets the field, except in fields for text."""
        if not typed.strip() and (field.optional or not field.is_text):
            # A key that a person chose remains while the person types its value again.
            return self._put(field.place, "null") if field.own_key else self.reset(field)
        # A written default would only make the file longer.
        value = typed_as_yaml(field, typed)
        if field.written is None and value == field.default:
            return self.text
        return self._put(field.place, value)

    def reset(self, field: FormField) -> str | RequestRefused:
        """Return the text without a field's key, so that its default applies."""
        return without(self.text, field.place, self.tree)

    def reset_group(self, group: FormGroup) -> str | RequestRefused:
        """Return the text without the keys of a section."""
        text: str | RequestRefused = self.text
        for field in reversed(list(group.all_fields())):
            if field.written is not None and isinstance(text, str):
                text = without(text, field.place)
        return text

    def add(self, group: FormGroup, robot: int | None = None) -> str | RequestRefused:
        """Return the text with one more item in a section of items.

        If the item is for a robot, `robot` is its number. If `robot` is None, the item gets the next number.
        """
        if group.repeats is RepeatKind.ROBOTS:
            taken = {item.key.rpartition(".")[2] for item in group.groups}
            number = robot or next(n for n in range(1, len(taken) + 2) if str(n) not in taken)
            return self._put(f"{group.key}.{number}", "{}")
        number = len(group.groups)
        fields = [field for item in group.groups for field in item.fields]
        names = {editable_text(field) for field in fields if field.key.endswith((".name", ".id"))}
        free = next(n for n in range(1, number + 2) if not {f"thing {n}", f"item_{n}"} & names)
        value = _NEW_ITEMS[group.key].format(number=free)
        if number == 0 and (self.tree is None or node_at(self.tree, steps_of(group.key)) is None):
            return self._put(group.key, f"[{value}]")
        return self._put(f"{group.key}[{number}]", value)

    def keys_for(self, group: FormGroup) -> Mapping[str, FormField]:
        """Return the fields that can be added to a section whose keys a person can choose, by key."""
        return {}

    def allows_own_names(self, group: FormGroup) -> bool:
        """Return True if a person may also add keys that are not in `keys_for`."""
        return False

    def add_key(self, group: FormGroup, name: str) -> str | RequestRefused:
        """Return the text after adding a key to a section whose keys a person can choose."""
        return self._put(path_of((group.key, name)), "null")

    def move(self, item: FormGroup, by: int) -> str | RequestRefused:
        """Return the text after an item is moved one place down (`by` 1) or up (-1)."""
        return moved(self.text, item.key, by, self.tree)

    def remove(self, item: FormGroup) -> str | RequestRefused:
        """Return the text without an item of a section of items."""
        return without(self.text, item.key, self.tree)

    def _put(self, place: str, value: str) -> str | RequestRefused:
        return with_value(self.text, place, value, self._order, self.tree)

    def _order(self, key: str) -> tuple[str, ...]:
        group = self.groups().get(key)
        return () if group is None else group.order

    def differences(self, saved: str) -> tuple[str, ...]:
        """Return the differences from the text on disk, in the form of `diff -u`."""
        return differences(saved, self.text)


def draft_of(path: Path, text: str) -> StudyDraft:
    """Read and check a text as `thbridge study check` does. The check takes about 0.1 s."""
    try:
        tree = parse(path, text)
    except BadFile as fault:
        empty = Section(1, [])
        return StudyDraft(path, text, None, form_of("", empty, StudyFile.of(Study())), None, (fault,), ())
    try:
        start = study_before(path, tree)
    except BadFile:
        # `load_study_tree` reports this fault below.
        start = StudyFile.of(Study())
    form = form_of(text, tree, start)
    draft = StudyDraft(path, text, tree, form, None, (), ())
    try:
        loaded = load_study_tree(path, tree)
        read_setting(loaded.value, path.parent, written=loaded)
    except BadFiles as faults:
        return dataclasses.replace(draft, faults=faults.faults)
    except BadFile as fault:
        return dataclasses.replace(draft, faults=(fault,))
    return dataclasses.replace(draft, study=loaded.value, notices=loaded.notices)


def search_fields(fields: Iterable[FormField], words: str) -> tuple[FormField, ...]:
    """Return the fields for a search: each word occurs in the key, the name, an old name or the help of the field.

    Fields whose name equals the search come first.
    """
    wanted = [word.replace(" ", "_") for word in words.lower().split()]
    if not wanted:
        return ()

    def searchable(field: FormField) -> str:
        return f"{field.key} {' '.join(field.places)} {field.label} {field.help} {' '.join(field.choices)}".lower()

    def rank(field: FormField) -> tuple[bool, bool, bool]:
        name, query = field.key.rpartition(".")[2].lower(), "_".join(wanted)
        return name != query, query not in name, field.key.startswith("each.")

    return tuple(sorted((f for f in fields if all(word in searchable(f) for word in wanted)), key=rank))


def keys_like(words: str, keys: Mapping[str, FormField]) -> tuple[FormField, ...]:
    """Return the keys for a search, the most likely keys first; without words, return all keys.

    A key fits if each word occurs in its name, its meaning or its choices. If no key fits, the keys with the most
    similar names are returned, so that the search tolerates typing errors.
    """
    if not words.strip():
        return tuple(keys.values())
    if found := search_fields(keys.values(), words):
        return found
    last: dict[str, str] = {}
    for key in keys:
        last.setdefault(key.rpartition(".")[2], key)
    wanted = "_".join(words.lower().split())
    close = get_close_matches(wanted.rpartition(".")[2], last, n=5) or get_close_matches(wanted, keys, n=5)
    return tuple(keys[last.get(name, name)] for name in close)


@dataclass(frozen=True, slots=True)
class UndoHistory:
    """Texts for undo and redo.

    Attributes:
        text: the present text.
        past: earlier texts; the latest text is the last.
        future: undone texts; the text of the next redo is the first.
        key: key of the last changed field; further changes of this field belong to the same step of undo.
    """

    text: str
    past: tuple[str, ...] = ()
    future: tuple[str, ...] = ()
    key: str = ""

    def changed(self, text: str, key: str = "") -> "UndoHistory":
        """Return the history after a change of the text; successive changes of one field are a single step."""
        if text == self.text:
            return self
        past = self.past if key and key == self.key and self.past else (*self.past, self.text)[-MAX_UNDO_STEPS:]
        return UndoHistory(text, past, (), key)

    def undone(self) -> "UndoHistory":
        """Return the history after an undo; unchanged if there is nothing to undo."""
        if not self.past:
            return self
        return UndoHistory(self.past[-1], self.past[:-1], (self.text, *self.future))

    def redone(self) -> "UndoHistory":
        """Return the history after a redo; unchanged if there is nothing to redo."""
        if not self.future:
            return self
        return UndoHistory(self.future[0], (*self.past, self.text), self.future[1:])

    def settled(self) -> "UndoHistory":
        """Return the history with the last step closed, so that the next change begins a new step."""
        return dataclasses.replace(self, key="")


MAX_UNDO_STEPS = 200
"""Number of steps kept for undo."""
