"""Studies, which are read from a file or from keys, and checked with all files that they name."""

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TypeAlias

from thbridge.api.errors import HuntError, HuntWarning, as_hunt_errors
from thbridge.app.compose.setting import StudySetting, read_setting
from thbridge.files.yaml.load import Loaded
from thbridge.files.yaml.tree import quoted
from thbridge.study.built_in import study_at
from thbridge.study.external_nodes import ExternalNodes
from thbridge.study.overrides import StudyChange, with_changes
from thbridge.study.study_file import Study
from thbridge.study.text import as_yaml, resolved

StudyValue: TypeAlias = bool | int | float | str | Path | Sequence["StudyValue"] | Mapping[str, "StudyValue"] | None
"""Value of a key of a study, as in YAML. A mapping changes the given keys of a section, and no other keys."""

Simulated: TypeAlias = str
"""Name of a simulated participant: `suggestion`, `nearest`, `random`, or the name of an installed participant."""

CHANGES = Path("changes")
"""Name that errors show in place of a file if a key was given as an argument."""


class HuntStudy:
    """Immutable study with all files that it names, read and checked.

    Args:
        file: a study file, or the name of a built-in study: `standard` (the study of `thbridge play`) or
            `original-2016`. If None, every key has its default value, as in `original-2016`.
        changes: other values by dotted key, such as `{"robot.amcl.max_particles": 500}`.
        keys: other values of top-level keys, such as `robots=4`, `map="office"`, `game={"energy": 50}`.

    Raises:
        HuntError: the file cannot be read, a key is unknown, a value is out of range, or a file that the study names is
            missing or has errors.
    """

    def __init__(
        self,
        file: str | Path | None = None,
        changes: Mapping[str, StudyValue] | None = None,
        **keys: StudyValue,
    ) -> None:
        path = None if file is None else Path(file)
        with as_hunt_errors():
            study, written = study_at(path)
            beside = Path() if path is None else path.parent
            self._read(_changed(study, {**keys, **(changes or {})}), beside, written)

    @classmethod
    def _of(cls, study: Study, beside: Path) -> "HuntStudy":
        """Return a study whose keys are already checked."""
        made = cls.__new__(cls)
        with as_hunt_errors():
            made._read(study, beside, None)
        return made

    def _read(self, study: Study, beside: Path, written: Loaded[Study] | None) -> None:
        if study.robots_from.is_real:
            problem = "this study is for real robots, but `HuntStudy` is for simulated robots"
            raise HuntError(f"robots_from: {problem}. Write sim, or run `thbridge simr`.", key="robots_from")
        if study.external_nodes is not ExternalNodes.NONE:
            problem = "other ROS nodes drive these robots, but `HuntStudy` drives robots itself"
            raise HuntError(f"external_nodes: {problem}. Write none, or run `thbridge simr`.", key="external_nodes")
        self._beside = beside
        self._setting = read_setting(study, beside, written=written)
        for doubt in self._setting.doubts:
            warnings.warn(str(doubt), HuntWarning, stacklevel=3)

    def changed(self, changes: Mapping[str, StudyValue] | None = None, **keys: StudyValue) -> "HuntStudy":
        """Return a study with other values for some keys; see `HuntStudy`. A change of only the seed is fast.

        Raises:
            HuntError: for the same reasons as `HuntStudy`.
        """
        given = {**keys, **(changes or {})}
        with as_hunt_errors():
            study = _changed(self._setting.study, given)
        if set(given) == {"seed"}:
            return self._with_study(study)
        return HuntStudy._of(study, self._beside)

    def _with_study(self, study: Study) -> "HuntStudy":
        """Return a study with the values of `study`, which names the same files as this study."""
        made = HuntStudy.__new__(HuntStudy)
        made._beside = self._beside
        made._setting = replace(self._setting, study=study)
        return made

    @property
    def robots(self) -> int:
        """Number of robots."""
        return self._setting.study.robots

    @property
    def seed(self) -> int:
        """Random seed."""
        return self._setting.study.seed

    @property
    def map(self) -> str:
        """Name of the map."""
        return self._setting.map.name

    @property
    def rooms(self) -> Mapping[int, str]:
        """Names of the map's rooms by number, from 1; empty for rooms without a name."""
        return {entry.room.people: entry.name for entry in self._setting.map.rooms}

    @property
    def treasures(self) -> tuple[str, ...]:
        """Names of all treasures of the study, in alphabetical order."""
        return tuple(sorted({kind.name for kind in self._setting.templates.kinds}, key=str.casefold))

    def yaml(self) -> str:
        """Return the whole study as YAML, including defaults; recordings contain the same text."""
        return resolved(self._setting.study)

    def __repr__(self) -> str:
        return f"<HuntStudy {self.map}, {self.robots} robots, seed {self.seed}>"


def setting_of(study: HuntStudy) -> StudySetting:
    """Return the study and its files, in the form from which sessions are built."""
    return study._setting


def seeded(study: HuntStudy, seed: int) -> HuntStudy:
    """Return the study with another seed, without a check of the study."""
    setting = setting_of(study)
    return study._with_study(replace(setting.study, seed=seed))


def _changed(study: Study, values: Mapping[str, StudyValue]) -> Study:
    if not values:
        return study
    return with_changes(study, (), [StudyChange(key, _yaml(value)) for key, value in values.items()], source=CHANGES)


def _yaml(value: StudyValue) -> str:
    """Return a value as YAML in one line."""
    match value:
        case Mapping():
            return f"{{{', '.join(f'{key}: {_yaml(inner)}' for key, inner in value.items())}}}"
        case Path():
            return quoted(str(value))
        case str() | None | bool() | int() | float():
            return as_yaml(value)
        case _:
            return f"[{', '.join(map(_yaml, value))}]"
