"""Check the pinned versions in requirements.lock for known vulnerabilities: advisories in OSV's format (PyPA, GitHub).

Run this script from the project's folder: `.venv/bin/python scripts/audit_lock.py [FOLDER]`. Without a folder, it
fetches PyPA's database with git, and keeps the database for later runs. No data about the pins leave the machine. The
script prints a line for each advisory about a pinned version, and the date of the database's newest advisory. The exit
code is 1 if a pinned version is affected, and 2 if there is no database or no pin to check.
"""

import argparse
import json
import os
import re
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import msgspec
from packaging.utils import canonicalize_name
from packaging.version import InvalidVersion, Version
from rich.console import Console
from rich.table import Table
from ruamel.yaml import YAML
from ruamel.yaml.error import YAMLError

ROOT = Path(__file__).parents[1]
DATABASE = "https://github.com/pypa/advisory-database"
PIN = re.compile(r"^([A-Za-z0-9._-]+)==([^\s;\\]+)", re.MULTILINE)
SUFFIXES = {".yaml", ".yml", ".json"}
EVERY = Version("0.dev0")
"""Version that OSV writes as 0, which is earlier than all other versions."""


class AdvisoryPackage(msgspec.Struct):
    """Package of an advisory; the structures of advisories have the names of OSV's format."""

    name: str = ""
    ecosystem: str = ""


class AffectedRange(msgspec.Struct):
    """Range of affected versions. The events start or end affected parts."""

    type: str
    events: list[dict[str, object]]


class AffectedPackage(msgspec.Struct):
    """Affected versions of a package."""

    package: AdvisoryPackage | None = None
    ranges: list[AffectedRange] | None = None
    versions: list[object] | None = None


class Advisory(msgspec.Struct):
    """Advisory about a vulnerability."""

    id: str
    aliases: list[str] | None = None
    summary: str | None = None
    details: str | None = None
    withdrawn: object = None
    affected: list[AffectedPackage] | None = None


@dataclass(frozen=True)
class Concern:
    """Advisory about a pinned version.

    Attributes:
        name: name of the package.
        version: pinned version.
        names: names of the advisory: its id, then its aliases.
        summary: first line of the advisory's text.
        fixed: versions in which the vulnerability is fixed.
    """

    name: str
    version: str
    names: tuple[str, ...]
    summary: str
    fixed: tuple[str, ...]


@dataclass(frozen=True)
class Audit:
    """Result of checking a lock against a database.

    Attributes:
        concerns: advisories about pinned versions, sorted by package.
        read: number of advisories that name a pinned package.
        unreadable: files that are not advisories.
        newest: date of the latest change to an advisory in the database, ISO 8601; "" if there are no advisories.
    """

    concerns: tuple[Concern, ...]
    read: int
    unreadable: tuple[Path, ...]
    newest: str


def pins_of(lock: str) -> dict[str, str]:
    """Return the pinned versions of a lock, by the packages' normalized names."""
    return {canonicalize_name(name): version for name, version in PIN.findall(lock)}


def audit(pins: Mapping[str, str], database: Path) -> Audit:
    """Check pins against all advisories in a folder and its subfolders."""
    wanted = re.compile("|".join(rf"(?<![a-z0-9]){name}(?![a-z0-9])" for name in sorted(pins)) or r"(?!)")
    concerns: list[Concern] = []
    unreadable: list[Path] = []
    read, newest = 0, ""
    for file in sorted(path for path in database.rglob("*") if path.suffix in SUFFIXES and path.is_file()):
        text = file.read_text(encoding="utf-8", errors="replace")
        modified = re.search(r"\bmodified\"?: *['\"]?(\d{4}-\d\d-\d\d)", text)
        newest = max(newest, modified[1] if modified else "")
        if not wanted.search(re.sub(r"[-_.]+", "-", text.lower())):
            continue  # most advisories concern other packages, and parsing YAML is slow
        try:
            content = json.loads(text) if file.suffix == ".json" else YAML(typ="safe", pure=True).load(text)
            found = list(_concerns(msgspec.convert(content, Advisory), pins))
        except (ValueError, YAMLError):
            unreadable.append(file)
            continue
        read += 1
        concerns += found
    return Audit(tuple(sorted(concerns, key=lambda it: (it.name, it.names))), read, tuple(unreadable), newest)


def _concerns(advisory: Advisory, pins: Mapping[str, str]) -> Iterator[Concern]:
    if advisory.withdrawn:
        return
    names = (advisory.id, *(advisory.aliases or ()))
    text = (advisory.summary or advisory.details or "").strip()
    for affected in advisory.affected or ():
        package = affected.package or AdvisoryPackage()
        name = canonicalize_name(package.name)
        if package.ecosystem != "PyPI" or name not in pins:
            continue
        version = pins[name]
        ranges = [found.events for found in affected.ranges or () if found.type in {"ECOSYSTEM", "SEMVER"}]
        # A version is affected if it is listed or if it is in a range.
        if version in map(str, affected.versions or ()) or any(within(version, events) for events in ranges):
            ends = (str(event["fixed"]) for events in ranges for event in events if "fixed" in event)
            yield Concern(name, version, names, (text.splitlines() or [""])[0], tuple(dict.fromkeys(ends)))


def within(version: str, events: Sequence[Mapping[str, object]]) -> bool:
    """Return True if a version is in a range of OSV, which is a list of events.

    When the events are sorted by version, each event starts or ends an affected part.
    """
    at, affected = Version(version), False
    for turn, event in sorted((_turn(event) for event in events), key=lambda it: it[0]):
        if turn > at or (turn == at and event == "last_affected"):
            break
        affected = event == "introduced"
    return affected


def _turn(event: Mapping[str, object]) -> tuple[Version, str]:
    ((kind, text),) = ((kind, str(text)) for kind, text in event.items() if kind != "limit")
    try:
        return (EVERY if text == "0" else Version(text)), kind
    except InvalidVersion as error:
        raise ValueError(text) from error


def fetched(kept: Path) -> Path:
    """Fetch PyPA's database, or its updates; return its folder. End the program if fetching fails."""
    if (kept / ".git").is_dir():
        command = ["git", "-C", str(kept), "pull", "--quiet", "--ff-only", "--depth", "1"]
    else:
        command = ["git", "clone", "--quiet", "--depth", "1", DATABASE, str(kept)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        print(f"The database cannot be fetched: {done.stderr.strip()}", file=sys.stderr)
        print("Write the folder of a copy of the database: make audit DB=FOLDER", file=sys.stderr)
        sys.exit(2)
    return kept / "vulns"


def main() -> None:
    """Read the command line, check, and print the result."""
    parser = argparse.ArgumentParser(description="Check the pins of requirements.lock against known vulnerabilities.")
    parser.add_argument("database", nargs="?", type=Path, help="folder of advisories (default: fetch PyPA's)")
    parser.add_argument("--lock", type=Path, default=ROOT / "requirements.lock")
    options = parser.parse_args()
    cache = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    database = options.database or fetched(cache / "thbridge" / "advisory-database")
    pins = pins_of(options.lock.read_text(encoding="utf-8"))
    result = audit(pins, database)
    if not pins or not result.newest:
        what = f"{options.lock} has no pins" if not pins else f"there are no advisories in {database}"
        print(f"Nothing was checked: {what}.", file=sys.stderr)
        sys.exit(2)
    for file in result.unreadable:
        print(f"{file} is ignored, because it is not an OSV advisory.", file=sys.stderr)
    if result.concerns:
        table = Table("pin", "advisory", "fixed in", "summary")
        for found in result.concerns:
            names, fixed = ", ".join(found.names), ", ".join(found.fixed) or "none"
            table.add_row(f"{found.name}=={found.version}", names, fixed, found.summary[:200])
        Console(markup=False).print(table)
    print(
        f"{len(pins)} pins; {result.read} advisories name their packages; {len(result.concerns)} concern a pinned "
        "version. "
        f"The database's newest advisory is from {result.newest}."
    )
    sys.exit(1 if result.concerns else 0)


if __name__ == "__main__":
    main()
