"""Only their owner reads what programs write, unless the study says otherwise."""

import stat
import subprocess
from pathlib import Path

import pytest

from tests.support.programs.processes import THBRIDGE

GAME = ("play", "--headless", "--rate", "0", "--max-seconds", "3", "--bag", "bags/a.bag", "--port", "0", "--report")


def modes(folder: Path) -> dict[str, set[int]]:
    written = [path for path in folder.rglob("*") if path.name != "study.yaml"]
    return {
        "folders": {stat.S_IMODE(path.stat().st_mode) for path in written if path.is_dir()},
        "files": {stat.S_IMODE(path.stat().st_mode) for path in written if path.is_file()},
    }


@pytest.mark.parametrize(
    ("readers", "folder", "file"),
    [
        ("owner", 0o700, 0o600),
        pytest.param("group", 0o750, 0o640, marks=pytest.mark.slow),
        pytest.param("everyone", 0o755, 0o644, marks=pytest.mark.slow),
    ],
)
def test_who_may_read_recording_journal_and_page(tmp_path: Path, readers: str, folder: int, file: int) -> None:
    (tmp_path / "study.yaml").write_text("" if readers == "owner" else f"recording: {{readers: {readers}}}\n")
    command = [*THBRIDGE, GAME[0], "study.yaml", *GAME[1:]]
    subprocess.run(command, cwd=tmp_path, capture_output=True, check=False, umask=0)
    assert (tmp_path / "bags" / "a.html").exists()
    assert list((tmp_path / "bags" / "a.journal").iterdir())
    assert modes(tmp_path) == {"folders": {folder}, "files": {file}}
