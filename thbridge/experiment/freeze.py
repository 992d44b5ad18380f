"""The fingerprint of an experiment for a preregistration, and later changes of the experiment."""

import hashlib
import json
import os
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import msgspec

from thbridge.experiment.folder import EXPORTS, FREEZE, RECORDINGS, STORE, ExperimentFolder
from thbridge.files.disk.text_files import read_text
from thbridge.files.disk.whole import write_whole
from thbridge.files.errors import BadFile, reason_of
from thbridge.files.plugins import package_of
from thbridge.study.plugins import plugins_of

_DATA = {STORE, RECORDINGS, EXPORTS, FREEZE}
"""Files and folders that the commands write into an experiment's folder. All other files are planned files."""


def data_of(folder: str, names: list[str]) -> set[str]:
    """Return the names of data in an experiment's folder, which `shutil.copytree` must ignore.

    The result also includes broken links and links to a folder above, because copying such a folder would never end.
    """
    data = {name for name in names if name in _DATA - {FREEZE} and Path(folder, "experiment.yaml").exists()}
    links = [link for name in names if (link := Path(folder, name)).is_symlink()]
    here = Path(os.path.realpath(folder))
    return data | {link.name for link in links if not link.exists() or here.is_relative_to(os.path.realpath(link))}


@dataclass(frozen=True, slots=True)
class Fingerprint:
    """Contents of an experiment: its planned files, and the programs that run it.

    Attributes:
        files: SHA-256 of each planned file, by its path in the folder.
        versions: versions of the programs that run the experiment.
    """

    files: Mapping[str, str]
    versions: Mapping[str, str]

    @property
    def digest(self) -> str:
        """Hash of all files and versions, for a preregistration."""
        whole = json.dumps([sorted(self.files.items()), sorted(self.versions.items())])
        return hashlib.sha256(whole.encode()).hexdigest()


_LARGEST = 1 << 26


class _FreezeFile(msgspec.Struct):
    """Contents of the file with the fingerprint."""

    digest: str
    files: dict[str, str]
    versions: dict[str, str]


def fingerprint_of(folder: ExperimentFolder, versions: Mapping[str, str]) -> Fingerprint:
    """Return the fingerprint of an experiment's present files, with the packages of the plug-ins that its studies name.

    Raises:
        BadFile: a file cannot be read.
    """
    files = {}
    for path in sorted(folder.root.rglob("*")):
        name = path.relative_to(folder.root)
        if path.is_file() and name.parts[0] not in _DATA and not any(part.startswith(".") for part in name.parts):
            try:
                with path.open("rb") as file:
                    files[name.as_posix()] = hashlib.file_digest(file, "sha256").hexdigest()
            except OSError as error:
                remedy = "Give your account the right to read it"
                raise BadFile(path, f"the file cannot be read ({reason_of(error)})", remedy) from None
    with suppress(BadFile):  # Other code reports faults of the experiment.
        design = folder.read()
        if (codes := design.file.recruiting.codes) is not None:
            files.pop(codes.as_posix(), None)  # Codes are added while a study runs, and do not change its plan.
        studies = [study for cell in design.cells for study in cell.studies]
        plugins = {key: package for key in plugins_of(*studies) if (package := package_of(key)) is not None}
        return Fingerprint(files, {**versions, **plugins})
    return Fingerprint(files, versions)


def freeze(folder: ExperimentFolder, versions: Mapping[str, str], wall: str) -> Fingerprint:
    """Write the fingerprint of an experiment. Never replace an existing fingerprint.

    Raises:
        BadFile: the experiment is already frozen, or the folder cannot be written.
    """
    if folder.freeze.exists():
        remedy = "To register a changed experiment, first move this file away and state this in the registration"
        raise BadFile(folder.freeze, "the experiment is already frozen", remedy)
    found = fingerprint_of(folder, versions)
    contents = {"when": wall, "digest": found.digest, "files": dict(found.files), "versions": dict(found.versions)}
    write_whole(folder.freeze, (json.dumps(contents, indent=1) + "\n").encode())
    return found


def deviations(folder: ExperimentFolder, versions: Mapping[str, str]) -> tuple[str, ...] | None:
    """Return sentences about changes since the experiment was frozen, or None if there is no fingerprint.

    Raises:
        BadFile: the file with the fingerprint cannot be read or was changed.
    """
    if not folder.freeze.exists():
        return None
    try:
        contents = msgspec.json.decode(read_text(folder.freeze, _LARGEST), type=_FreezeFile)
        frozen = Fingerprint(contents.files, contents.versions)
        if frozen.digest != contents.digest:
            raise ValueError
    except (BadFile, ValueError, RecursionError):
        raise BadFile(folder.freeze, "the file is damaged or was changed", "Restore the registered file") from None
    now = fingerprint_of(folder, versions)
    said = [
        f"{name} was {'added' if name not in frozen.files else 'removed' if name not in now.files else 'changed'}"
        for name in sorted({*frozen.files, *now.files})
        if frozen.files.get(name) != now.files.get(name)
    ]
    said += [
        f"{name}: now {now.versions.get(name, 'not installed')}, when frozen "
        f"{frozen.versions.get(name, 'not installed')}"
        for name in sorted({*frozen.versions, *now.versions})
        if frozen.versions.get(name) != now.versions.get(name)
    ]
    return tuple(said)
