"""A clock of day that jumps under running programs, by libfaketime."""

import os
from pathlib import Path

LIBRARY = next(iter(sorted(Path("/usr/lib").glob("*/faketime/libfaketime.so.1"))), None)

JUMPS = ("+3600", "-3600", "+0")
"""Seconds by which the clock is wrong, one after the other."""


class Clock:
    """The clock of day of programs; the one that only goes on, by which they wait, is left alone, as NTP does."""

    def __init__(self, folder: Path) -> None:
        self._file = folder / "offset"
        self.jump("+0")
        self.environment = {
            **os.environ,
            "LD_PRELOAD": str(LIBRARY),
            "FAKETIME_TIMESTAMP_FILE": str(self._file),
            "FAKETIME_CACHE_DURATION": "1",
            "FAKETIME_DONT_FAKE_MONOTONIC": "1",
        }

    def jump(self, offset: str) -> None:
        self._file.write_text(f"{offset}\n")
