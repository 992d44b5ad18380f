"""Desktop entry, MIME types and icon of the researcher's window, installed for one user (freedesktop.org)."""

import os
import shutil
import subprocess
import sysconfig
from collections.abc import Iterator, Mapping
from pathlib import Path

from thbridge.files.disk.whole import whole_file

NAME = "thbridge"
"""Name of the desktop entry, the icon and the MIME package."""
ICON = Path(__file__).parents[2] / "windows" / f"{NAME}.svg"
_UPDATES = (("update-mime-database", "mime"), ("update-desktop-database", "applications"))
"""Programs that rebuild the desktop's caches, each with the folder that it updates."""

MIME_TYPES = """\
<?xml version="1.0" encoding="UTF-8"?>
<mime-info xmlns="http://www.freedesktop.org/standards/shared-mime-info">
  <mime-type type="application/x-rosbag">
    <comment>ROS 1 bag</comment>
    <magic priority="80"><match type="string" value="#ROSBAG V" offset="0"/></magic>
    <glob pattern="*.bag"/>
  </mime-type>
  <mime-type type="application/x-mcap">
    <comment>MCAP recording</comment>
    <magic priority="80"><match type="string" value="\\x89MCAP" offset="0"/></magic>
    <glob pattern="*.mcap"/>
  </mime-type>
</mime-info>
"""


def desktop_entry(program: str) -> str:
    """Return the text of the desktop entry.

    Args:
        program: absolute path of the program `thbridge`.
    """
    quoted = "".join(f"\\{letter}" if letter in '"`$\\' else letter for letter in program).replace("%", "%%")
    # The desktop removes escapes twice: first the escapes of strings, then the escapes within the quotes.
    command = f'"{quoted}" watch %f'.replace("\\", "\\\\")
    return (
        "[Desktop Entry]\nType=Application\nVersion=1.0\nName=thbridge watch\n"
        "GenericName=Viewer of robot recordings\nComment=Watch recordings and running sessions of teams of robots\n"
        f"Exec={command}\nIcon={NAME}\nTerminal=false\nStartupNotify=true\nCategories=Science;Robotics;\n"
        "MimeType=application/x-rosbag;application/x-mcap;\n"
    )


def installed_program() -> str:
    """Return the absolute path of the program `thbridge` of this installation."""
    own = Path(sysconfig.get_path("scripts")) / "thbridge"
    return str(own) if own.exists() else shutil.which("thbridge") or "thbridge"


def data_home() -> Path:
    """Return the folder of the user's data (XDG Base Directory Specification)."""
    return Path(os.environ.get("XDG_DATA_HOME") or Path.home() / ".local" / "share")


def install(home: Path, program: str) -> Iterator[Path]:
    """Write the files and yield their paths; then rebuild the desktop's caches.

    Raises:
        BadFile: a file cannot be written.
    """
    for path, text in _files(home, program).items():
        with whole_file(path, folders=True) as file:
            file.write(text.encode())
        yield path
    _rebuild_caches(home)


def remove(home: Path) -> Iterator[Path]:
    """Remove the files and yield their paths; then rebuild the desktop's caches."""
    for path in _files(home, ""):
        if path.exists():
            path.unlink()
            yield path
    _rebuild_caches(home)


def _files(home: Path, program: str) -> Mapping[Path, str]:
    return {
        home / "icons" / "hicolor" / "scalable" / "apps" / f"{NAME}.svg": ICON.read_text(),
        home / "mime" / "packages" / f"{NAME}.xml": MIME_TYPES,
        home / "applications" / f"{NAME}.desktop": desktop_entry(program),
    }


def _rebuild_caches(home: Path) -> None:
    for program, folder in _UPDATES:
        path = shutil.which(program)
        if path is not None and (home / folder).is_dir():
            subprocess.run([path, str(home / folder)], check=False, capture_output=True)
