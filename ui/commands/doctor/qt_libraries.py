"""System libraries that Qt loads, and their Debian packages."""

import re
import shutil
from collections.abc import Mapping, Sequence

QT_LIBRARIES: Mapping[str, str] = {
    "libGL.so.1": "libgl1",
    "libEGL.so.1": "libegl1",
    "libxkbcommon.so.0": "libxkbcommon0",
    "libdbus-1.so.3": "libdbus-1-3",
    "libfontconfig.so.1": "libfontconfig1",
    "libxkbcommon-x11.so.0": "libxkbcommon-x11-0",
    "libxcb-cursor.so.0": "libxcb-cursor0",
    "libxcb-icccm.so.4": "libxcb-icccm4",
    "libxcb-keysyms.so.1": "libxcb-keysyms1",
    "libxcb-shape.so.0": "libxcb-shape0",
    "libglib-2.0.so.0": "libglib2.0-0",
}
"""Libraries that Qt loads, and their Debian packages; `scripts/set_up.sh` installs the same packages."""


def remedy_for(libraries: Sequence[str]) -> str:
    """Return the command that installs libraries, as a sentence without its full stop."""
    packages = " ".join(dict.fromkeys(QT_LIBRARIES.get(library) or _package(library) for library in libraries))
    if shutil.which("apt-get") is None:
        return f"Install these libraries; their Debian packages are {packages}"
    return f"Run: sudo apt-get install {packages}"


def _package(library: str) -> str:
    """Return the package name of a library by Debian's naming policy: `libxcb-image0` for `libxcb-image.so.0`."""
    name, _, version = library.lower().replace("_", "-").partition(".so.")
    return f"{name}-{version}" if re.search(r"\d$", name) else f"{name}{version}"
