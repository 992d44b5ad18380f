"""Codes, parameters and endings of a study with people who come by a link."""

import secrets
from pathlib import Path

import pytest

from thbridge.experiment.design.experiment_file import read_experiment
from thbridge.experiment.design.recruiting import LinkCodes, add_codes, read_codes
from thbridge.files.errors import BadFile

STUDY = """\
title: By a link
base: {map: practice, templates: practice, robots: 1}
recruiting: {RECRUITING}
steps:
  - {step: trial}
"""


def read(folder: Path, recruiting: str) -> None:
    (folder / "experiment.yaml").write_text(STUDY.replace("{RECRUITING}", recruiting))
    read_experiment(folder / "experiment.yaml")


@pytest.mark.parametrize(
    ("recruiting", "key", "remedy"),
    [
        ("{endings: {complete: 'http://service.example/'}}", "recruiting.endings.complete", "such an address"),
        ("{endings: {full: 'https://service.example/a b'}}", "recruiting.endings.full", "such an address"),
        ("{endings: {declined: 'javascript:alert(1)'}}", "recruiting.endings.declined", "such an address"),
        ("{endings: {timed_out: 'https://service.example/?p={PID}'}}", "recruiting.endings.timed_out", "PROLIFIC_PID"),
        ("{parameters: [code]}", "recruiting.parameters[0]", "a name of letters"),
        ("{parameters: [PID, PID]}", "recruiting.parameters[1]", "a name of letters"),
        ("{parameters: [a, b, c, d, e, f, g, h, i]}", "recruiting.parameters", "at most 8"),
    ],
)
def test_faulty_keys_are_reported_with_line_and_remedy(tmp_path: Path, recruiting: str, key: str, remedy: str) -> None:
    with pytest.raises(BadFile) as fault:
        read(tmp_path, recruiting)
    assert fault.value.key == key
    assert fault.value.line == 3
    assert remedy in str(fault.value)


def test_endings_with_placeholders_and_codes_are_accepted(tmp_path: Path) -> None:
    read(tmp_path, "{endings: {complete: 'https://service.example/done?p={PROLIFIC_PID}', declined: NO-1}}")


@pytest.mark.parametrize(
    ("text", "line"), [("short\n", 1), ("a-code-of-12\n\na-code-of-12\n", 3), ("with blanks inside\n", 1), ("\n", None)]
)
def test_faulty_codes_are_reported_with_their_line(tmp_path: Path, text: str, line: int | None) -> None:
    (tmp_path / "codes.txt").write_text(text)
    with pytest.raises(BadFile) as fault:
        read_codes(tmp_path / "codes.txt")
    assert fault.value.line == line


def test_new_codes_are_added_and_cannot_be_guessed(tmp_path: Path) -> None:
    path = tmp_path / "codes.txt"
    first, second = add_codes(path, 3, secrets.randbelow), add_codes(path, 2, secrets.randbelow)
    assert read_codes(path) == [*first, *second]
    assert {len(code) for code in first} == {16} and len({*first, *second}) == 5
    codes = LinkCodes(first)
    assert first[0] in codes and second[0] not in codes and first[0].lower() not in codes
