import json
import runpy
import subprocess
import sys
from pathlib import Path

import pytest

SCRIPT = Path(__file__).parents[2] / "scripts" / "audit_lock.py"
LOCK = "first-package==1.4 \\\n    --hash=sha256:00\nsecond==2.0\n    # via first-package\n"
EVENTS = [{"introduced": "0"}, {"fixed": "1.2"}, {"introduced": "1.3"}, {"last_affected": "1.5"}, {"introduced": "2a1"}]

script = runpy.run_path(str(SCRIPT))


def advisory(name: str, **affected: object) -> dict[str, object]:
    package = {"name": name, "ecosystem": "PyPI"}
    return {
        "id": "PYSEC-1",
        "aliases": ["CVE-1"],
        "modified": "2026-01-02T00:00:00Z",
        "details": "It fails.\nBadly.",
        "affected": [{"package": package, **affected}],
    }


def ecosystem(*events: dict[str, str]) -> dict[str, object]:
    return {"ranges": [{"type": "GIT", "events": [{"introduced": "0"}]}, {"type": "ECOSYSTEM", "events": [*events]}]}


def run(tmp_path: Path, *advisories: dict[str, object]) -> subprocess.CompletedProcess[str]:
    (tmp_path / "requirements.lock").write_text(LOCK)
    database = tmp_path / "database" / "vulns"
    database.mkdir(parents=True)
    for number, content in enumerate(advisories):
        (database / f"{number}.{'json' if number % 2 else 'yaml'}").write_text(json.dumps(content))
    command = [sys.executable, SCRIPT, "--lock", tmp_path / "requirements.lock", database.parent]
    return subprocess.run(command, capture_output=True, text=True, check=False)


@pytest.mark.parametrize(
    ("version", "affected"),
    [("1.1", True), ("1.2", False), ("1.3rc1", False), ("1.4", True), ("1.5", True), ("1.5.1", False), ("2.0", True)],
)
def test_a_version_is_affected_between_the_events_of_a_range(version: str, affected: bool) -> None:
    assert script["within"](version, EVENTS[::-1]) is affected


def test_affected_pins_are_told_and_end_with_1(tmp_path: Path) -> None:
    by_range = advisory("First.Package", **ecosystem({"introduced": "1.0"}, {"fixed": "1.4.1"}))
    by_list = {**advisory("second", versions=["2.0"]), "id": "GHSA-2"}
    done = run(tmp_path, by_range, by_list)
    assert done.returncode == 1
    for told in ("first-package==1.4", "PYSEC-1", "1.4.1", "second==2.0", "GHSA-2", "It fails."):
        assert told in done.stdout
    assert "2 pins; 2 advisories name their packages; 2 concern a pinned version" in done.stdout
    assert "2026-01-02" in done.stdout


def test_mended_withdrawn_and_other_packages_end_with_0(tmp_path: Path) -> None:
    open_range = ecosystem({"introduced": "0"})
    foreign = advisory("second", **open_range)
    foreign["affected"][0]["package"]["ecosystem"] = "npm"  # type: ignore[index]
    done = run(
        tmp_path,
        advisory("first-package", **ecosystem({"introduced": "0"}, {"fixed": "1.4"})),
        {**advisory("second", **open_range), "withdrawn": "2026-01-01T00:00:00Z"},
        advisory("second-other", **open_range),
        foreign,
    )
    assert (done.returncode, done.stderr) == (0, "")


def test_no_advisories_are_no_verdict(tmp_path: Path) -> None:
    done = run(tmp_path)
    assert done.returncode == 2
    assert "Nothing was checked" in done.stderr


def test_what_is_no_advisory_is_named(tmp_path: Path) -> None:
    done = run(tmp_path, {"first-package": "modified: 2026-01-01"}, advisory("other"))
    assert done.returncode == 0
    assert "0.yaml" in done.stderr
