"""The page of Nav2's names of parameters."""

import subprocess
import sys
from pathlib import Path

from tests.support.project import ROOT

SCRIPT = ROOT / "scripts" / "write_nav2_parameters.py"


def test_the_page_is_up_to_date(tmp_path: Path) -> None:
    subprocess.run([sys.executable, SCRIPT, tmp_path / "page.md"], check=True, cwd=ROOT, env={"PYTHONPATH": str(ROOT)})
    assert (tmp_path / "page.md").read_text() == (ROOT / "docs" / "reference" / "nav2-parameters.md").read_text(), (
        "run scripts/write_nav2_parameters.py"
    )
