import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]


def test_the_maps_are_what_the_script_draws(tmp_path: Path) -> None:
    subprocess.run([sys.executable, ROOT / "scripts" / "draw_maps.py", "--into", tmp_path], check=True, cwd="/")
    for name in ("arena8", "office", "practice", "warehouse12"):
        drawn = {file.name: file.read_bytes() for file in (tmp_path / name).iterdir()}
        assert drawn == {file.name: file.read_bytes() for file in (ROOT / "maps" / name).iterdir()}
