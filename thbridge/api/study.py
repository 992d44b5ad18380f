"""Studies: from a file, from keys, checked with everything they name."""

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TypeAlias

from thbridge.api.errors import HuntError, HuntWarning, told
from thbridge.app.compose.setting import StudySetting, read_setting
from thbridge.files.yaml.load import Loaded
from thbridge.files.yaml.tree import quoted
from thbridge.study.built_in import study_at
from thbridge.study.overrides import StudyChange, with_changes
from thbridge.study.robots_from import RobotsFrom
from thbridge.study.study_file import Study
from thbridge.study.text import as_yaml, resolved

StudyValue: TypeAlias = bool | int | float | str | Path | Sequence["StudyValue"] | Mapping[str, "StudyValue"] | None
"""Value of a key of a study: as YAML has it; a mapping is a section, of which the other keys stay."""

Simulated: TypeAlias = str
"""Name of a simulated participant: `suggestion`, `nearest`, `random`, or one that is installed."""

CHANGES = Path("changes")
"""Name of the source in faults of keys that are given as arguments."""


class HuntStudy:
    """A study with all that it names, read and checked; immutable.

    Args:
        file: a study file, or the name of a built-in study: `standard`, which `thbridge play` plays, or
            `original-2016`. None: every key has its default, which is that of `original-2016`.
        changes: other values by dotted key, such as `{"robot.amcl.max_particles": 500}`.
        keys: the same for keys of the first level: `robots=4`, `map="office"`, `game={"energy": 50}`.

    Raises:
        HuntError: the file cannot be read, a key is unknown, a value is out of its bounds, or what the study names is
            missing or does not fit.
    """

    def __init__(
        self,
        file: str | Path | None = None,
        changes: Mapping[str, StudyValue] | None = None,
        **keys: StudyValue,
    ) -> None:
        path = None if file is None else Path(file)
        with told():
            study, written = study_at(path)
            beside = Path() if path is None else path.parent
            self._read(_changed(study, {**keys, **(changes or {})}), beside, written)

    @classmethod
    def _of(cls, study: Study, beside: Path) -> "HuntStudy":
        """Return a study whose keys are checked already."""
        made = cls.__new__(cls)
        with told():
            made._read(study, beside, None)
        return made

    def _read(self, study: Study, beside: Path, written: Loaded[Study] | None) -> None:
        if study.robots_from is RobotsFrom.ROS:
            problem = "this study is for real robots, and sessions here simulate"
            raise HuntError(f"robots_from: {problem}. Write sim, or start `thbridge simr`.", key="robots_from")
        self._beside = beside
        self._setting = read_setting(study, beside, written=written)
        for doubt in self._setting.doubts:
            warnings.warn(str(doubt), HuntWarning, stacklevel=3)

    def changed(self, changes: Mapping[str, StudyValue] | None = None, **keys: StudyValue) -> "HuntStudy":
        """Return a study with other values for some keys; see `HuntStudy`. Another seed alone takes no time.

        Raises:
            HuntError: as `HuntStudy`.
        """
        given = {**keys, **(changes or {})}
        with told():
            study = _changed(self._setting.study, given)
        if set(given) == {"seed"}:
            return self._with_study(study)
        return HuntStudy._of(study, self._beside)

    def _with_study(self, study: Study) -> "HuntStudy":
        """Return this setting with a study that names the same files."""
        made = HuntStudy.__new__(HuntStudy)
        made._beside = self._beside
        made._setting = replace(self._setting, study=study)
        return made

    @property
    def robots(self) -> int:
        """Size of the team."""
        return self._setting.study.robots

    @property
    def seed(self) -> int:
        """The seed of all chance."""
        return self._setting.study.seed

    @property
    def map(self) -> str:
        """Name of the map."""
        return self._setting.map.name

    @property
    def rooms(self) -> Mapping[int, str]:
        """Names of the map's rooms by number, from 1; empty names where rooms have none."""
        return {entry.room.people: entry.name for entry in self._setting.map.rooms}

    @property
    def treasures(self) -> tuple[str, ...]:
        """Names of the treasures that there are, in alphabetical order."""
        return tuple(sorted({kind.name for kind in self._setting.templates.kinds}, key=str.casefold))

    def yaml(self) -> str:
        """Return the whole study as a file, defaults included; recordings hold the same."""
        return resolved(self._setting.study)

    def __repr__(self) -> str:
        return f"<HuntStudy {self.map}, {self.robots} robots, seed {self.seed}>"


def setting_of(study: HuntStudy) -> StudySetting:
    """Return what sessions are built from."""
    return study._setting


def seeded(study: HuntStudy, seed: int) -> HuntStudy:
    """Return the study with another seed, which is not checked."""
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
