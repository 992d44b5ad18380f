"""Recorded hunts."""

import dataclasses
from pathlib import Path

import pytest

from tests.ui.sources.scanned_bags import STUDY, TICKS, record
from thbridge.recording.bag.options import Compression
from thbridge.study.study_file import RecordingSection


@pytest.fixture(scope="session")
def hunt(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Thirteen seconds of three robots: a crate is put, robot 2 dies and revives, robot 3 is carried away."""
    bag = tmp_path_factory.mktemp("hunt") / "hunt.bag"
    record(bag, STUDY, TICKS)
    return bag


@pytest.fixture(scope="session")
def split(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The hunt in parts, compressed."""
    bag = tmp_path_factory.mktemp("split") / "hunt.bag"
    recording = RecordingSection(Compression.LZ4, split_duration=2.0)
    record(bag, dataclasses.replace(STUDY, recording=recording), TICKS // 2)
    return bag
