"""Check of an experiment before people take part. It finds faults that would stop later commands or spoil data."""

from collections.abc import Mapping

from thbridge.experiment.design.experiment_file import ExperimentDesign
from thbridge.experiment.design.recruiting import link_codes
from thbridge.experiment.design.soundness import faults_of
from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.freeze import fingerprint_of
from thbridge.experiment.rehearsal.people import read_people
from thbridge.files.errors import BadFile, FaultCollection


def read_for_people(folder: ExperimentFolder) -> ExperimentDesign:
    """Read an experiment for a run with people, with all files that its games need.

    If people have already taken part, the study must continue. Then faults that `soundness` finds are accepted.

    Raises:
        BadFile: the experiment has faults. BadFiles reports all faults at once.
    """
    design = folder.read(with_files=True)
    if not is_under_way(folder):
        _faults(design).raise_any()
    return design


def check_experiment(
    folder: ExperimentFolder, versions: Mapping[str, str]
) -> tuple[ExperimentDesign, tuple[BadFile, ...]]:
    """Read an experiment, with all files for its games, its fingerprint, rehearsals and power estimates.

    Args:
        folder: folder of the experiment.
        versions: versions of the programs that run the experiment.

    Returns:
        The experiment, and the faults that are accepted because people have already taken part.

    Raises:
        BadFile: the experiment has faults. BadFiles reports all faults at once.
    """
    design = folder.read(with_files=True)
    found = _faults(design)
    faults = FaultCollection() if is_under_way(folder) else found
    with faults.kept():
        read_people(folder.people, design)
    with faults.kept():
        fingerprint_of(folder, versions)
    with faults.kept():
        link_codes(design.file.recruiting, folder.root)
    faults.raise_any()
    return design, tuple(found.found)


def is_under_way(folder: ExperimentFolder) -> bool:
    """Return True if the log of an experiment has an entry.

    Raises:
        BadFile: the log is damaged.
    """
    return folder.log.exists() and bool(folder.entries())


def _faults(design: ExperimentDesign) -> FaultCollection:
    faults = FaultCollection()
    with faults.kept():
        faults.found += faults_of(design)
    return faults
