"""Programs of the environment of Selenium, which drive Chromium and print what they have seen."""

import json
import subprocess
from pathlib import Path
from typing import Any

import pytest

from tests.support.project import ROOT

SELENIUM = ROOT / ".peers" / "selenium" / "bin" / "python"
NEEDS_SELENIUM = pytest.mark.skipif(
    not (SELENIUM.exists() and Path("/usr/bin/chromium").exists() and Path("/usr/bin/chromedriver").exists()),
    reason="Chromium or selenium is not installed (make peers, as root)",
)
"""Mark of tests that run such a program."""


def seen_in_chromium(program: Path, *arguments: object, timeout: float = 280.0) -> dict[str, Any]:
    """Run a program to its end, and return the JSON object in its last line."""
    done = subprocess.run(
        [SELENIUM, program, *map(str, arguments)], capture_output=True, text=True, timeout=timeout, check=False
    )
    assert done.returncode == 0, done.stderr
    seen: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
    return seen
