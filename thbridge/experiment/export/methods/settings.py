"""Settings of an experiment's games that are not the program's defaults."""

import dataclasses
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, cast

from thbridge.experiment.design.experiment_file import ExperimentDesign
from thbridge.study.noise import value_at
from thbridge.study.study_file import Study, StudyFile
from thbridge.study.text import SHOWN_ELSEWHERE, as_yaml

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

_NO_SETTINGS = ("seed", "server.", "watch.", "open_to", "keys")
"""Prefixes of keys that have no effect on participants.

Seeds have their own sentence in the text. The other prefixes concern the network.
"""


def settings_that_differ(design: ExperimentDesign) -> Iterator[tuple[str, str, str]]:
    """Yield the key, default and value of each setting that differs from the default. If values vary, list them all."""
    default = _flat(Study())
    found = [_flat(study) for cell in design.cells for study in cell.studies]
    for key in dict.fromkeys(key for settings in (default, *found) for key in settings):
        values = list(dict.fromkeys(settings.get(key, "not set") for settings in found))
        usual = default.get(key, "not set")
        if values != [usual] and not key.startswith(_NO_SETTINGS):
            yield key, usual, values[0] if len(values) == 1 else f"varied: {'; '.join(values)}"


def practice_settings(design: ExperimentDesign, index: int) -> Iterator[tuple[str, str]]:
    """Yield the key and value of each setting that differs between a practice game and the participant's game."""
    found: dict[str, dict[str, None]] = {}
    for cell, practices in zip(design.cells, design.practices.get(index, ()), strict=False):
        for study, practice in zip(cell.studies, practices, strict=True):
            usual = _flat(study)
            for key, value in _flat(practice).items():
                if usual.get(key) != value:
                    found.setdefault(key, {})[value] = None
    yield from ((key, " or ".join(values)) for key, values in found.items())


def same_in_all(design: ExperimentDesign, key: str) -> str:
    """Return the value of a setting in all games, or a list of all values if it varies."""
    values = (value_at(study, key) for cell in design.cells for study in cell.studies)
    return " or ".join(dict.fromkeys(_plain(as_yaml(value)) for value in values))


def _plain(value: str) -> str:
    """Return a number without a final `.0`. Return any other text unchanged."""
    return value.removesuffix(".0")


def meaning_of(key: str, levels: Sequence[str]) -> str:
    """Return the meaning of a study key. List only the values that are levels.

    For a factor that sets several keys, return a gap for the author.
    """
    section: object = StudyFile()
    meaning = ""
    for name in key.split("."):
        fields = (
            {field.name: field for field in dataclasses.fields(section)} if dataclasses.is_dataclass(section) else {}
        )
        if name not in fields:
            return "[settings of each level]"
        meaning = str(fields[name].metadata.get("help", ""))
        section = cast(object, getattr(section, name))
    what, _, values = meaning.partition(": ")
    own = [value for value in values.split("; ") if value.partition(" (")[0] in levels]
    return f"{what}: {'; '.join(own)}" if len(own) == len(levels) else meaning


def _flat(study: Study) -> Mapping[str, str]:
    """Return the settings of a study, by key, with the values as in study files."""
    return dict(_values(StudyFile.of(study), ""))


def _values(section: object, path: str) -> Iterator[tuple[str, str]]:
    for field in dataclasses.fields(cast("DataclassInstance", section)):
        key, value = f"{path}{field.name}", cast(object, getattr(section, field.name))
        if key in SHOWN_ELSEWHERE:
            continue
        if isinstance(value, Mapping):
            like = dict(_values(getattr(section, field.metadata["like"]), ""))
            for number, entry in value.items():
                # For a robot with its own settings, list only settings that differ from the other robots.
                own = ((name, text) for name, text in _values(entry, "") if like.get(name) != text)
                yield from ((f"{key}.{number}.{name}", text) for name, text in own)
        elif dataclasses.is_dataclass(value):
            yield from _values(value, f"{key}.")
        else:
            yield key, as_yaml(value)
