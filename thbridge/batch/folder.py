"""The folder of a sweep: its design, and files of results. Many programs may write to the folder at the same time."""

import hashlib
import json
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, cast

import msgspec
from msgspec import Meta

from thbridge.app.compose.machine import machine, versions
from thbridge.batch.chunks import GameChunk, chunks_of
from thbridge.batch.design import MOST_CONDITIONS, SweepDesign
from thbridge.files.disk.text_files import read_text
from thbridge.files.disk.whole import PART, whole_file
from thbridge.files.errors import BadFile
from thbridge.files.resources import shipped
from thbridge.json_text import json_of
from thbridge.study.plugins import plugins_of
from thbridge.study.study_file import Study
from thbridge.study.text import resolved

LAYOUT = 1
"""Number of the folder's layout. Other releases may use other numbers."""
LARGEST_MANIFEST = 1 << 28
MOST_CHUNKS = 10_000_000
"""Maximum number of chunks of a readable manifest."""


@dataclass(frozen=True, slots=True)
class SweepFolder:
    """Paths within the folder of a sweep."""

    root: Path

    @property
    def manifest(self) -> Path:
        """Path of the file with the resolved design, and the versions and machine that started the sweep."""
        return self.root / "sweep.json"

    def study(self, condition: int) -> Path:
        """Return the path of a condition's resolved study. `thbridge play` can play it with the seed of a game."""
        return self.root / "conditions" / f"{condition}.yaml"

    def games(self, chunk: GameChunk) -> Path:
        """Return the path of a chunk's results."""
        return self._of("games", chunk) / f"chunk-{chunk.number}.parquet"

    def verified(self, chunk: GameChunk) -> Path:
        """Return the path of the results of a chunk's repeated games."""
        return self._of("verified", chunk) / f"chunk-{chunk.number}.parquet"

    def attempts(self, chunk: GameChunk) -> Path:
        """Return the path of the journal of a chunk's started games. It is deleted when the chunk has results."""
        return self.root / "attempts" / f"chunk-{chunk.number}"

    def ended(self, chunk: GameChunk) -> Path:
        """Return the path of the list of a chunk's ended games. It is deleted when the chunk has results."""
        return self.root / "ended" / f"chunk-{chunk.number}"

    def bag(self, condition: int, seed: int, ending: str) -> Path:
        """Return the path of a game's recording. For `ending`, see `RecordingSection`."""
        return self.root / "bags" / f"condition={condition}" / f"seed-{seed}{ending}"

    def _of(self, kind: str, chunk: GameChunk) -> Path:
        return self.root / kind / f"condition={chunk.condition}"

    def clear(self, chunk: GameChunk) -> None:
        """Delete files of a chunk that an interrupted program left, except the list of ended games."""
        self.attempts(chunk).unlink(missing_ok=True)
        for path in (self.games(chunk), self.verified(chunk)):
            for part in path.parent.glob(f".{path.name}.*{PART}"):
                part.unlink(missing_ok=True)


@dataclass(frozen=True, slots=True)
class SweepManifest:
    """Record of a sweep in its folder. For the other attributes, see `SweepDesign`.

    Attributes:
        levels: the level of each factor, by condition.
        versions: versions of the programs that started the sweep.
    """

    factors: tuple[str, ...]
    levels: Mapping[int, Mapping[str, str]]
    seeds: tuple[int, ...]
    measures: tuple[str, ...]
    one_verified_in: int
    chunk: int
    versions: Mapping[str, str]

    @property
    def chunks(self) -> tuple[GameChunk, ...]:
        """All chunks."""
        return chunks_of(len(self.levels), self.seeds, self.chunk)

    @property
    def games(self) -> int:
        """Number of games."""
        return len(self.levels) * len(self.seeds)


def open_folder(design: SweepDesign, root: Path) -> SweepFolder:
    """Start or continue a sweep in a folder.

    Raises:
        BadFile: the folder belongs to another design, or cannot be written.
    """
    folder, here = SweepFolder(root), _described(design)
    if not folder.manifest.exists():
        for condition in design.conditions:
            with whole_file(folder.study(condition.number), folders=True) as file:
                file.write(resolved(condition.study).encode())
        contents = {
            "layout": LAYOUT,
            "digest": _digest_of(here),
            "versions": versions(plugins_of(*(condition.study for condition in design.conditions))),
            "machine": machine(),
            "design": here,
        }
        # If several programs start at the same time, only one of them writes the manifest.
        with suppress(FileExistsError), whole_file(folder.manifest, folders=True, exclusive=True) as file:
            file.write((json.dumps(contents, indent=1) + "\n").encode())
    _, there = _read(folder)
    if there != here:
        problem = f"{root} has the games of another design: {_difference(folder, design, there, here)}"
        raise BadFile(design.path, problem, "Name another folder with --out, or undo the change")
    return folder


def read_manifest(root: Path) -> tuple[SweepFolder, SweepManifest]:
    """Read the manifest of a sweep's folder. Raises BadFile."""
    folder = SweepFolder(root)
    read, _ = _read(folder)
    design = read.design
    return folder, SweepManifest(
        factors=tuple(design.factors),
        levels=design.levels,
        seeds=tuple(design.seeds),
        measures=tuple(design.measures),
        one_verified_in=design.one_verified_in,
        chunk=design.chunk,
        versions=read.versions,
    )


def _described(design: SweepDesign) -> object:
    """Return all properties of a design that affect its results, as JSON values."""
    studies = {each.number: hashlib.sha256(resolved(each.study).encode()).hexdigest() for each in design.conditions}
    contents = {
        "factors": design.factors,
        "levels": {each.number: each.levels for each in design.conditions},
        "seeds": design.seeds,
        "max_seconds": design.max_seconds,
        "measures": design.measures,
        "one_bag_in": design.one_bag_in,
        "one_verified_in": design.one_verified_in,
        "chunk": design.chunk,
        "files": _digests(design),
        "studies": studies,
    }
    return cast(object, json.loads(json.dumps(contents)))


def _digest_of(described: object) -> str:
    return hashlib.sha256(json.dumps(described, sort_keys=True).encode()).hexdigest()


def _digests(design: SweepDesign) -> dict[str, str]:
    """Return a digest of each file and folder that the studies name."""
    named = dict.fromkeys(
        (f"{key} {name}", path)
        for condition in design.conditions
        for key, name, path in _named_paths(condition.study, design.beside)
    )
    return {what: _digest(path) for what, path in named}


def _named_paths(study: Study, beside: Path) -> Iterator[tuple[str, str, Path]]:
    """Yield the key, value and path of each file or folder that a study names."""
    yield "map", study.map, shipped().find("maps", study.map, beside)
    yield "templates", study.templates, shipped().find("templates", study.templates, beside)
    for key, path in (
        ("game.costs", study.game.costs),
        ("dialogue.games", study.dialogue.games),
        ("dialogue.words", study.dialogue.words),
    ):
        if path is not None and (beside / path).exists():
            yield key, str(path), beside / path


def _digest(path: Path) -> str:
    """Return a digest of a file, or of all files in a folder."""
    digest = hashlib.sha256()
    for file in sorted(each for each in path.rglob("*") if each.is_file()) if path.is_dir() else [path]:
        for part in (file.relative_to(path).as_posix().encode(), file.read_bytes()):
            digest.update(len(part).to_bytes(8, "little"))
            digest.update(part)
    return digest.hexdigest()


class _ManifestDesign(msgspec.Struct):
    """Fields of a manifest's design that readers use. All other fields are only for comparisons with a new design."""

    factors: list[str]
    levels: dict[Annotated[int, Meta(ge=1, le=MOST_CONDITIONS)], dict[str, str]]
    seeds: list[Annotated[int, Meta(ge=0, le=2**63 - 1)]]
    measures: list[str]
    one_verified_in: Annotated[int, Meta(ge=0, le=2**63 - 1)]
    chunk: Annotated[int, Meta(ge=1, le=2**31)]


class _ManifestFile(msgspec.Struct):
    """Contents of a manifest's file."""

    layout: int
    design: _ManifestDesign
    versions: dict[str, str]


def _read(folder: SweepFolder) -> tuple[_ManifestFile, Mapping[str, object]]:
    """Return the contents of a manifest, and its design as JSON values. Raises BadFile."""
    path, remedy = folder.manifest, "name the folder of a sweep, or restore this file"
    try:
        text = read_text(path, LARGEST_MANIFEST)
        contents: object = json_of(text)
    except json.JSONDecodeError as error:
        raise BadFile(path, f"the file is not JSON ({error.msg})", remedy, line=error.lineno) from None
    except ValueError as error:
        raise BadFile(path, str(error), remedy) from None
    except BadFile as fault:
        raise BadFile(path, fault.problem, remedy) from None
    if not isinstance(contents, dict) or contents.get("layout") != LAYOUT:
        raise BadFile(path, "another release of thbridge started this sweep", "use that release to continue")
    try:
        read = msgspec.json.decode(text, type=_ManifestFile)
    except (msgspec.MsgspecError, RecursionError) as error:
        raise BadFile(path, f"this is not the file of a sweep ({error})", remedy) from None
    if sorted(read.design.levels) != list(range(1, len(read.design.levels) + 1)):
        raise BadFile(path, "its conditions are not numbered from 1 without gaps", remedy, key="levels")
    if len(read.design.levels) * -(-len(read.design.seeds) // read.design.chunk) > MOST_CHUNKS:
        raise BadFile(path, f"it has more than {MOST_CHUNKS} chunks of games", remedy, key="seeds")
    return read, cast(Mapping[str, object], contents["design"])


def _difference(folder: SweepFolder, design: SweepDesign, there: object, here: object) -> str:
    """Return a clause with the first difference between two designs."""
    place, was, now = next(_differences(there, here, ""))
    if place.startswith("studies."):
        number = int(place.removeprefix("studies."))
        before = read_text(folder.study(number), LARGEST_MANIFEST).splitlines()
        after = resolved(design.conditions[number - 1].study).splitlines()
        was, now = next((a.strip(), b.strip()) for a, b in zip(before, after, strict=False) if a != b)
        place = f"the study of condition {number}"
    elif place.startswith("files."):
        return f"the files of {place.removeprefix('files.')} were changed"
    return f"{place} was {_shortened(was)} and is now {_shortened(now)}"


def _differences(was: object, now: object, place: str) -> Iterator[tuple[str, object, object]]:
    """Yield the path of each difference between two values, with both values."""
    if isinstance(was, dict) and isinstance(now, dict):
        for name in dict.fromkeys((*was, *now)):
            inner = f"{place}.{name}" if place else str(name)
            yield from _differences(was.get(name), now.get(name), inner)
    elif was != now:
        yield place, was, now


def _shortened(value: object) -> str:
    text = "nothing" if value is None else str(value)
    return text if len(text) <= LONGEST_TOLD else f"{text[: LONGEST_TOLD - 3]}..."


LONGEST_TOLD = 60
"""Maximum number of characters of a value in a message about the difference between two designs."""
