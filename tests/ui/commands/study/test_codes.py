"""`thbridge study codes`, and what the other commands say about codes."""

from pathlib import Path

import pytest

from tests.support.programs.commands import output_of, refusal_of
from thbridge.experiment.design.recruiting import read_codes
from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.freeze import fingerprint_of

STUDY = """\
title: With codes
base: {map: practice, templates: practice, robots: 1, server.port: 0}
recruiting: {codes: codes.txt}
consent_elsewhere: Participants agreed on paper.
steps:
  - {step: trial}
"""


@pytest.fixture
def study(tmp_path: Path) -> Path:
    (tmp_path / "experiment.yaml").write_text(STUDY)
    return tmp_path


def test_codes_are_added_and_printed_as_links_and_do_not_change_the_plan(study: Path) -> None:
    before = fingerprint_of(ExperimentFolder(study), {})
    said = output_of("study", "codes", study, "--number", 2, "--address", "https://study.example.org/")
    links = [line for line in said.splitlines() if line.startswith("https://")]
    assert links == [f"https://study.example.org/?code={code}" for code in read_codes(study / "codes.txt")]
    output_of("study", "codes", study)
    assert len(read_codes(study / "codes.txt")) == 3
    assert "no faults" in output_of("study", "check", study)
    assert fingerprint_of(ExperimentFolder(study), {}) == before


def test_missing_codes_are_refused_with_the_remedy(study: Path) -> None:
    for command in (("study", "check", study), ("serve", study, "--port", 0)):
        said = refusal_of(*command)
        assert "codes.txt" in said and "thbridge study codes" in said
    (study / "experiment.yaml").write_text(STUDY.replace("recruiting: {codes: codes.txt}\n", ""))
    assert "recruiting: {codes: codes.txt}" in refusal_of("study", "codes", study)
    assert "--address" in refusal_of("study", "codes", study, "--address", "study.example.org")
