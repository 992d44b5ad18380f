"""Checks of Qt's system libraries, the clock and the locale."""

import ctypes
import locale
import os
import sys
import time
from collections.abc import Callable, Iterator
from datetime import UTC, datetime
from pathlib import Path
from zoneinfo import ZoneInfo

from ui.commands.doctor.qt_libraries import QT_LIBRARIES, remedy_for
from ui.commands.doctor.result import HealthCheck, fault, ok, warning


def check_libraries(load: Callable[[str], object] = ctypes.CDLL) -> HealthCheck:
    """Check that Qt's system libraries can be loaded."""
    if sys.platform != "linux":
        return ok("Qt's libraries", "Qt includes all its libraries on this system")
    missing = []
    for library in QT_LIBRARIES:
        try:
            load(library)
        except OSError:
            missing.append(library)
    if not missing:
        return ok("Qt's libraries", f"all {len(QT_LIBRARIES)} libraries are installed")
    return warning("Qt's libraries", f"windows cannot open without {', '.join(missing)}", remedy_for(missing))


def check_clock(now: float, monotonic: Callable[[], float] = time.monotonic) -> Iterator[HealthCheck]:
    """Check that the clock is not earlier than thbridge's files, that time never goes back, and that the time zone is
    set.

    Args:
        now: time of the computer's clock, seconds since 1970.
        monotonic: function that returns the monotonic clock, seconds.
    """
    date = datetime.fromtimestamp(now, UTC).strftime("%Y-%m-%d %H:%M UTC")
    readings = [monotonic() for _ in range(1000)]
    if now < Path(__file__).stat().st_mtime - 86400:
        yield warning("clock", f"{date} is before thbridge was installed", "Set the clock: timedatectl set-ntp true")
    elif readings != sorted(readings):
        yield fault("clock", "the monotonic clock goes back", "Check the clock source of the computer or its host")
    else:
        yield ok("clock", date)
    zone = os.environ.get("TZ", "").removeprefix(":")
    try:
        if zone and not zone.startswith("/"):
            ZoneInfo(zone)
    except (KeyError, ValueError, OSError):
        yield warning("time zone", f"TZ={zone} is not a time zone", "Unset TZ, or set it, for example to Europe/London")
    else:
        yield ok("time zone", time.strftime("%Z (UTC%z)", time.localtime(now)))


def check_locale() -> HealthCheck:
    """Check that texts are read and written as UTF-8."""
    remedy = "Set LC_ALL=C.UTF-8, or install the locale: sudo locale-gen"
    try:
        locale.setlocale(locale.LC_CTYPE, "")
    except locale.Error:
        named = next((os.environ[name] for name in ("LC_ALL", "LC_CTYPE", "LANG") if os.environ.get(name)), "")
        return warning("locale", f"the locale {named!r} is not installed", remedy)
    encodings = {locale.getencoding().lower(), sys.getfilesystemencoding().lower()}
    others = sorted(encodings - {"utf-8", "utf8"})
    if others:
        return warning("locale", f"characters that {others[0]} does not have are shown as escapes", remedy)
    return ok("locale", "UTF-8")
