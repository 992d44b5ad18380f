"""The folder of an experiment: its file, the files that it names, the store, recordings and exports."""

import shutil
from dataclasses import dataclass
from pathlib import Path

from thbridge.experiment.design.experiment_file import ExperimentDesign, read_experiment
from thbridge.experiment.store.browser_tickets import BrowserTickets
from thbridge.experiment.store.event_log import read_log
from thbridge.experiment.store.events import LogEntry
from thbridge.experiment.store.head import restore_remedy
from thbridge.experiment.store.known_folders import KnownFolders
from thbridge.experiment.store.pending_withdrawals import PendingWithdrawals, WithdrawnDigests
from thbridge.files.disk.inside import path_inside, relative_inside
from thbridge.files.errors import BadFile
from thbridge.recording.recordings import BAG

EXPERIMENT = "experiment.yaml"
STORE, RECORDINGS, EXPORTS, FREEZE = "store", "recordings", "exports", "freeze.json"
REPLACED = "replaced-"
"""Prefix of the names of folders in the store. These folders contain files that a restore replaced."""
EXAMPLE = Path(__file__).parent / "example"
"""Folder of the example experiment. A new experiment is a copy of the example."""
_EXAMPLE_IN = Path(__file__).parent / "example_languages"
"""Folder with one subfolder per further language. Each has translations of the example's texts for participants."""
_LANGUAGE = "dialogue.language: "


def example_languages() -> tuple[str, ...]:
    """Return the languages of the example, English first."""
    return ("en", *sorted(path.name for path in _EXAMPLE_IN.iterdir()))


def write_example(folder: Path, language: str) -> None:
    """Write the example into an existing folder; `language` is one of `example_languages`."""
    shutil.copytree(EXAMPLE, folder, dirs_exist_ok=True)
    if language != "en":
        shutil.copytree(_EXAMPLE_IN / language, folder, dirs_exist_ok=True)
        text = (EXAMPLE / EXPERIMENT).read_text(encoding="utf-8").replace(f"{_LANGUAGE}en", f"{_LANGUAGE}{language}")
        (folder / EXPERIMENT).write_text(text, encoding="utf-8")


@dataclass(frozen=True, slots=True)
class ExperimentFolder:
    """Paths within the folder of an experiment."""

    root: Path

    @property
    def file(self) -> Path:
        """The experiment's file."""
        return self.root / EXPERIMENT

    @property
    def people(self) -> Path:
        """Optional file that describes the simulated people of rehearsals."""
        return self.root / "rehearsal.yaml"

    @property
    def log(self) -> Path:
        """The log of all events."""
        return self.root / STORE / "log"

    @property
    def freeze(self) -> Path:
        """File with the fingerprint of the registered experiment."""
        return self.root / FREEZE

    @property
    def exports_known(self) -> KnownFolders:
        """The list of folders where exports were written."""
        return KnownFolders(self.root / STORE / "exports.json", self.root, "exports")

    @property
    def backups_known(self) -> KnownFolders:
        """The list of folders where backups were written."""
        return KnownFolders(self.root / STORE / "backups.json", self.root, "backups")

    @property
    def origins(self) -> KnownFolders:
        """The list of folders of a backup's study, the most recent folder last. Only a backup has this list."""
        return KnownFolders(self.root / STORE / "origins.json", self.root, "studies")

    @property
    def pending_withdrawals(self) -> PendingWithdrawals:
        """The list of unfinished withdrawals."""
        return PendingWithdrawals(self.root / STORE / "withdrawal.json")

    @property
    def withdrawn_events(self) -> WithdrawnDigests:
        """The list of events that withdrawals deleted."""
        return WithdrawnDigests(self.root / STORE / "withdrawn.json")

    @property
    def withdrawn_links(self) -> WithdrawnDigests:
        """The list of the link codes of people who withdrew."""
        return WithdrawnDigests(self.root / STORE / "withdrawn-links.json")

    def add_withdrawn_to(self, other: "ExperimentFolder") -> None:
        """Add the lists of what withdrawals deleted to the lists of another folder.

        Raises:
            BadFile: a list cannot be read or written.
        """
        other.withdrawn_events.add(self.withdrawn_events.read())
        other.withdrawn_links.add(self.withdrawn_links.read())

    @property
    def tickets(self) -> BrowserTickets:
        """The record of browsers and their participants.

        Raises:
            BadFile: the record is damaged.
        """
        return BrowserTickets(self.root / STORE / "browsers.json")

    @property
    def restoring(self) -> Path:
        """The folder in which a restore prepares its files."""
        return self.root / STORE / "restoring"

    def replaced(self) -> list["ExperimentFolder"]:
        """Return the study folders with files that `study restore` has replaced, ordered by number."""
        return [
            ExperimentFolder(path) for path in sorted((self.root / STORE).glob(f"{REPLACED}[0-9]*")) if path.is_dir()
        ]

    @property
    def recordings(self) -> Path:
        """The folder of recordings, with one subfolder per person."""
        return self.root / RECORDINGS

    def recordings_of(self, participant: str) -> Path:
        """Return the folder of a participant's recordings.

        Raises:
            BadFile: the id is not a valid name of a folder; see `path_inside`.
        """
        return path_inside(self.recordings, participant)

    def bag(self, participant: str, step: int, ending: str = BAG) -> Path:
        """Return the recording of a trial.

        Args:
            participant: id of the person or group.
            step: number of the step.
            ending: ending of the recording's name, see `RecordingSection.ending`.

        Raises:
            BadFile: the id is not a valid name of a folder; see `path_inside`.
        """
        return path_inside(self.recordings, participant, f"step-{step}{ending}")

    def bag_named(self, name: object) -> Path:
        """Return a recording by its path in an event of the log, relative to the study's folder.

        Raises:
            BadFile: the name is not the path of a recording; see `relative_inside`.
        """
        # The folder of the recordings may be a link to another disk.
        folder, slash, path = name.partition("/") if isinstance(name, str) else ("", "", "")
        if folder != RECORDINGS or not slash:
            problem = "an event names a recording that is not in the folder of recordings"
            raise BadFile(self.log, problem, restore_remedy(self.log), key=repr(name))
        return relative_inside(self.recordings, path)

    def export(self, name: str) -> Path:
        """Return the folder of an export.

        Raises:
            BadFile: the name is not a valid name of a folder; see `path_inside`.
        """
        return path_inside(self.root / EXPORTS, name)

    def read(self, *, with_files: bool = False) -> ExperimentDesign:
        """Read the experiment; `with_files` as for `read_experiment`.

        Raises:
            BadFile: the folder has no experiment, or the experiment is faulty.
        """
        if not self.file.is_file():
            remedy = "Name the folder of an experiment, or create an experiment: thbridge study new FOLDER"
            raise BadFile(self.root, f"the folder has no {EXPERIMENT}", remedy)
        return read_experiment(self.file, with_files=with_files)

    def entries(self) -> list[LogEntry]:
        """Read the log.

        Raises:
            BadFile: the log is damaged or does not exist.
        """
        if not self.log.exists() and not self.log.parent.exists():
            remedy = f"Run `thbridge study run {self.root}`, or rehearse the study and name the rehearsal's folder"
            raise BadFile(self.root, "no one has taken part in this study yet", remedy)
        return read_log(self.log)
