"""The check of an experiment before people take part, which refuses what later commands would and what spoils data."""

from collections.abc import Mapping

from thbridge.experiment.design.experiment_file import ExperimentDesign
from thbridge.experiment.design.soundness import faults_of
from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.freeze import fingerprint_of
from thbridge.experiment.rehearsal.people import read_people
from thbridge.files.errors import FaultCollection


def read_for_people(folder: ExperimentFolder) -> ExperimentDesign:
    """Read an experiment that people are to take part in, with all that its games need.

    Once people have taken part, a study must go on as it is, so it is read with its faults.

    Raises:
        BadFile: it is faulty; as BadFiles, all faults at once.
    """
    design = folder.read(with_files=True)
    if not (folder.log.exists() and folder.entries()):
        _faults(design).raise_any()
    return design


def check_experiment(folder: ExperimentFolder, versions: Mapping[str, str]) -> ExperimentDesign:
    """Read an experiment with all that its games, freezing, rehearsals and power need.

    Args:
        folder: of the experiment.
        versions: of the programs that run it.

    Raises:
        BadFile: it is faulty; as BadFiles, all faults at once.
    """
    design = folder.read(with_files=True)
    faults = _faults(design)
    with faults.kept():
        read_people(folder.people, design)
    with faults.kept():
        fingerprint_of(folder, versions)
    faults.raise_any()
    return design


def _faults(design: ExperimentDesign) -> FaultCollection:
    faults = FaultCollection()
    with faults.kept():
        faults.found += faults_of(design)
    return faults
