"""Pages of docs whose scripts a reader copies: each block runs as it stands, one after the other in a new folder."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from tests.support.project import ROOT

PAGES = sorted(
    {f"how-to/{page.name}" for page in (ROOT / "docs" / "how-to").glob("your-own-*.md")}
    | {"how-to/languages.md", "how-to/sweeps.md", "reference/protocol.md"}
)
"""Pages that take from ten seconds to two minutes; tests/peers runs that of recordings, too."""
SHORTENED = {"how-to/sweeps.md": ("replicates: 5", "replicates: 2")}
"""What a page says, and what is enough to see that it runs."""
_SCRIPT = re.compile(r"^```sh\n(.*?)^```$", re.MULTILINE | re.DOTALL)


@pytest.mark.slow
@pytest.mark.parametrize("name", PAGES)
def test_a_page_runs_as_it_stands(name: str, tmp_path: Path) -> None:
    text = (ROOT / "docs" / name).read_text(encoding="utf-8")
    said, enough = SHORTENED.get(name, ("", ""))
    assert said in text
    scripts = _SCRIPT.findall(text.replace(said, enough) if said else text)
    assert scripts
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    surroundings = {**os.environ, "PATH": path, "PYTHONPATH": str(ROOT)}
    surroundings.pop("DISPLAY", None)
    for script in scripts:
        ran = subprocess.run(
            ["bash", "-euo", "pipefail", "-c", script],
            cwd=tmp_path,
            env=surroundings,
            capture_output=True,
            text=True,
            timeout=900,
            check=False,
        )
        assert ran.returncode == 0, f"{script}\n{ran.stdout}\n{ran.stderr}"
