"""The page of MAVLink's names."""

import subprocess
import sys
from pathlib import Path

from tests.support.project import ROOT

SCRIPT = ROOT / "scripts" / "write_mavlink_parameters.py"


def test_the_page_is_up_to_date(tmp_path: Path) -> None:
    subprocess.run([sys.executable, SCRIPT, tmp_path / "page.md"], check=True, cwd=ROOT, env={"PYTHONPATH": str(ROOT)})
    assert (tmp_path / "page.md").read_text() == (ROOT / "docs" / "reference" / "mavlink-parameters.md").read_text(), (
        "run scripts/write_mavlink_parameters.py"
    )
