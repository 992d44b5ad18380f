"""Settings of studies that share their files: each map is read once for all studies that use it."""

import dataclasses
from pathlib import Path

from sim.parameters import RobotParameters, WorldParameters
from thbridge.app.compose.setting import StudySetting, read_setting
from thbridge.files.errors import BadFile
from thbridge.files.yaml.load import Loaded
from thbridge.study.plugins import plugins_of
from thbridge.study.study_file import ParticipantSection, RecordingSection, Study


class SettingCache:
    """Settings that were read. Studies that differ only in seed, software or noise share the files of one setting.

    Args:
        `beside`: the folder that paths in studies are relative to.
    """

    def __init__(self, beside: Path) -> None:
        self._beside = beside
        self._settings: dict[str, StudySetting] = {}

    def of(self, study: Study, written: Loaded[Study] | None = None) -> StudySetting:
        """Return the setting of a study; `written` and faults as for `read_setting`."""
        key = repr((_naming(study), plugins_of(study)))
        if key not in self._settings:
            self._settings[key] = read_setting(study, self._beside, written=written)
        return dataclasses.replace(self._settings[key], study=study)

    @property
    def doubts(self) -> tuple[BadFile, ...]:
        """Possible mistakes in the files of all studies so far, each listed once."""
        found = {str(doubt): doubt for setting in self._settings.values() for doubt in setting.doubts}
        return tuple(found.values())


def _naming(study: Study) -> Study:
    """Return the study without the values that no file depends on."""
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
