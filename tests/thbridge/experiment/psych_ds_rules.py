"""What Psych-DS 1 demands of a dataset (its errors, and those warnings that do not ask for more folders), in our words.

Its validator comes from no package registry. Source: the rules of the schema, versions 1.0 to 1.5, https://psych-ds.github.io.
"""

import csv
import json
import re
from collections.abc import Iterator
from pathlib import Path

NAME = re.compile(r"[a-z]+-[A-Za-z0-9]+(_[a-z]+-[A-Za-z0-9]+)*_data\.(csv|tsv)")
REQUIRED = ("name", "description", "schemaVersion", "variableMeasured")
TYPES = {
    "Dataset": {*REQUIRED, "keywords", "author", "citation", "license", "funder", "url", "identifier"},
    "PropertyValue": {"name", "description", "unitText", "minValue", "maxValue", "valueReference"},
}
"""Types of schema.org that we write, and those of their properties that we may."""


def problems(root: Path) -> list[str]:
    """Return sentences on what is not as it must be."""
    found, described = [*_object(root / "dataset_description.json")], _read(root / "dataset_description.json")
    if described is None:
        return found
    found += [f"dataset_description.json lacks {key}" for key in REQUIRED if not described.get(key)]
    for name in ("README", "CHANGES"):
        if not any((root / f"{name}{ending}").is_file() for ending in (".md", ".txt")):
            found.append(f"there is no {name}")
    files = [path for path in (root / "data").rglob("*") if path.suffix in {".csv", ".tsv"}]
    if not files:
        found.append("there are no data files")
    seen: set[str] = set()
    for path in files:
        found += _data_file(path, _names(described), seen)
    found += [f"{name} is no column of any file" for name in sorted(_names(described) - seen)]
    return found


def _data_file(path: Path, known: set[str], seen: set[str]) -> Iterator[str]:
    if not NAME.fullmatch(path.name):
        yield f"{path.name} is no name of keywords and values"
    try:
        with path.open(encoding="utf-8", newline="") as file:
            rows = list(csv.reader(file, strict=True))
    except (csv.Error, UnicodeDecodeError) as error:
        yield f"{path.name} is no CSV: {error}"
        return
    if not rows or not all(rows[0]):
        yield f"{path.name} has no header"
        return
    header, *rest = rows
    seen |= set(header)
    if len(set(header)) < len(header):
        yield f"{path.name} has a column twice"
    for number, row in enumerate(rest, start=2):
        if len(row) != len(header):
            yield f"{path.name}, line {number}, has {len(row)} values for {len(header)} columns"
    if "row_id" in header and len({row[header.index("row_id")] for row in rest}) < len(rest):
        yield f"{path.name} has a row_id twice"
    beside, own = path.with_suffix(".json"), set[str]()
    if beside.exists():
        yield from _object(beside)
        own = _names(_read(beside) or {})
        yield from (f"{beside.name} tells of {name}, which is no column" for name in sorted(own - set(header)))
    # What a file beside it says takes the place of what the dataset says.
    yield from (f"{path.name} has a column {name} that nothing describes" for name in header if name not in own | known)
    yield from (f"{beside.name} leaves out {name}" for name in header if beside.exists() and name not in own)


def _object(path: Path) -> Iterator[str]:
    """JSON-LD of schema.org that is a Dataset, in which every object has a type, and of it only what the type has."""
    described = _read(path)
    if described is None:
        yield f"{path.name} is missing, or no JSON"
        return
    if str(described.get("@context")).rstrip("/") not in {"https://schema.org", "http://schema.org"}:
        yield f"{path.name} is not of schema.org"
    if described.get("@type") != "Dataset":
        yield f"{path.name} is no Dataset"
    waiting: list[object] = [described]
    while waiting:
        each = waiting.pop()
        if isinstance(each, list):
            waiting += each
        elif isinstance(each, dict):
            waiting += each.values()
            unknown = each.keys() - TYPES.get(str(each.get("@type")), set()) - {"@context", "@type"}
            yield from (f"{path.name}: {key} is nothing of a {each.get('@type')}" for key in sorted(unknown))


def _read(path: Path) -> dict | None:
    try:
        read = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    return read if isinstance(read, dict) else None


def _names(described: dict) -> set[str]:
    variables = described.get("variableMeasured", [])
    return {each["name"] if isinstance(each, dict) else each for each in variables}
