"""What a person gets who installs the wheel, far from any checkout."""

import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]

LOAD = """
from pathlib import Path
import thbridge
from thbridge.files.map_files import read_map
from thbridge.files.resources import shipped
print(Path(thbridge.__file__).parent)
print(Path(thbridge.__file__).with_name("analysis").joinpath("report", "page.html").is_file())
print(len(read_map(shipped().find("maps", "arena8", Path())).rooms), *shipped().names("templates"))
"""


def pip(*arguments: str | Path) -> None:
    subprocess.run([sys.executable, "-m", "pip", "--quiet", "--disable-pip-version-check", *arguments], check=True)


def test_the_wheel_carries_maps_templates_and_the_page_of_reports(tmp_path: Path) -> None:
    pip("wheel", "--no-deps", "--no-build-isolation", "--wheel-dir", tmp_path, ROOT)
    (wheel,) = tmp_path.glob("*.whl")
    installed = tmp_path / "installed"
    pip("install", "--no-deps", "--target", installed, wheel)
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    loaded = subprocess.run(
        [sys.executable, "-c", LOAD],
        cwd=elsewhere,
        env={**os.environ, "PYTHONPATH": str(installed)},
        check=True,
        capture_output=True,
        text=True,
    )
    sets = "four-properties original-2016 practice sklar-azhar-2015"
    assert loaded.stdout.splitlines() == [str(installed / "thbridge"), "True", f"8 {sets}"]
