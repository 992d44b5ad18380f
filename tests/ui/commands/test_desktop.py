"""`thbridge desktop` makes bags open in the researcher's window, and undoes it."""

import shutil
import subprocess
from pathlib import Path

import pytest

from tests.support.programs.commands import invoke
from ui.commands.desktop.files import desktop_entry


def files(home: Path) -> set[str]:
    return {str(path.relative_to(home)) for path in home.rglob("thbridge.*")}


def test_what_is_installed_is_known_to_the_desktop_and_can_be_removed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    done = invoke("desktop", "install")
    assert done.exit_code == 0
    entry = "applications/thbridge.desktop"
    assert files(tmp_path) == {entry, "mime/packages/thbridge.xml", "icons/hicolor/scalable/apps/thbridge.svg"}
    assert str(tmp_path / entry) in done.stdout
    if shutil.which("update-mime-database"):
        globs = (tmp_path / "mime" / "globs2").read_text()
        assert "application/x-rosbag:*.bag" in globs and "application/x-mcap:*.mcap" in globs
    assert invoke("desktop", "remove").exit_code == 0
    assert files(tmp_path) == set()
    assert "nothing is installed" in invoke("desktop", "remove").stderr


def test_the_entry_starts_a_program_whatever_its_path() -> None:
    program = '/opt/50 % "of" $HOME\\bin/thbridge'
    (line,) = (line for line in desktop_entry(program).splitlines() if line.startswith("Exec="))
    # A desktop unescapes the value, unquotes it as a shell does, and then replaces field codes.
    value = line.removeprefix("Exec=").replace("\\\\", "\\")
    words = subprocess.run(["sh", "-c", f"printf '%s\\n' {value}"], check=True, capture_output=True, text=True).stdout
    assert [word.replace("%%", "%") for word in words.splitlines()] == [program, "watch", "%f"]
