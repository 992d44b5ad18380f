from pathlib import Path

import pytest

from tests.support.programs.commands import invoke


@pytest.mark.parametrize("platform", ["", "offscreen"])
def test_without_a_display_the_command_says_so(tmp_path: Path, platform: str) -> None:
    shown = {"DISPLAY": None, "WAYLAND_DISPLAY": None, "QT_QPA_PLATFORM": platform}
    result = invoke("study", "edit", tmp_path / "a.yaml", env=shown)
    assert result.exit_code == 2
    assert "study check" in " ".join(result.stderr.split())
    assert list(tmp_path.iterdir()) == []


def test_a_folder_without_a_study_is_told(tmp_path: Path) -> None:
    result = invoke("study", "edit", tmp_path, env={"QT_QPA_PLATFORM": "offscreen"})
    assert result.exit_code == 2
