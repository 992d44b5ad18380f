"""Cache for the settings of studies with common files. For example, each map is read only once."""

import dataclasses
from pathlib import Path

from sim.parameters import RobotParameters, WorldParameters
from thbridge.app.compose.setting import StudySetting, read_setting
from thbridge.files.errors import BadFile
from thbridge.files.yaml.load import Loaded
from thbridge.study.plugins import plugins_of
from thbridge.study.study_file import ParticipantSection, RecordingSection, Study


class SettingCache:
    """Cache of settings. Studies that differ only in seed, software or noise use the files of the same setting.

    Args:
        `beside`: the folder for relative paths in studies.
    """

    def __init__(self, beside: Path) -> None:
        self._beside = beside
        self._settings: dict[str, StudySetting] = {}

    def of(self, study: Study, written: Loaded[Study] | None = None) -> StudySetting:
        """Return the setting of a study. For `written` and exceptions, see `read_setting`."""
        key = repr((_naming(study), plugins_of(study)))
        if key not in self._settings:
            self._settings[key] = read_setting(study, self._beside, written=written)
        return dataclasses.replace(self._settings[key], study=study)

    @property
    def doubts(self) -> tuple[BadFile, ...]:
        """Possible mistakes in the files of all cached studies, without repetitions."""
        found = {str(doubt): doubt for setting in self._settings.values() for doubt in setting.doubts}
        return tuple(found.values())


def _naming(study: Study) -> Study:
    """Return the study with default values for all keys that do not affect its files."""
    standard = ParticipantSection()
    return dataclasses.replace(
        study,
        seed=0,
        robot=RobotParameters(),
        each={},
        world=WorldParameters(footprint=study.world.footprint),
        recording=RecordingSection(),
        participant=dataclasses.replace(study.participant, strategy=standard.strategy, attitude=standard.attitude),
    )
