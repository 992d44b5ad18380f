import os
import subprocess
import sys
from pathlib import Path

from tests.support.project import ROOT

PROGRAM = """\
import sys
from dataclasses import dataclass
from pathlib import Path
from ui.first_start import generated_code

compiled = []
generated_code.compile = lambda text, *other: compiled.append(text) or compile(text, *other)
generated_code.keep_generated_code(Path(sys.argv[1]))

@dataclass(frozen=True, slots=True)
class Point:
    x: int
    y: int = 2

try:
    Point(1).x = 2
except AttributeError:
    print(Point(1), Point(1) == Point(1, 2), hash(Point(1)) == hash(Point(1, 3)), len(compiled) > 0)
"""


def run(file: Path, notice: str = "") -> str:
    command = [sys.executable, "-c", PROGRAM, file]
    ended = subprocess.run(
        command, env={**os.environ, "PYTHONPATH": str(ROOT)}, check=True, capture_output=True, text=True
    )
    assert notice in ended.stderr
    assert bool(notice) == bool(ended.stderr)
    return ended.stdout


def test_methods_of_dataclasses_are_compiled_once_and_again_if_their_file_is_damaged(tmp_path: Path) -> None:
    file = tmp_path / "kernels" / "dataclasses-0" / "code"
    assert run(file) == "Point(x=1, y=2) True False True\n"
    assert run(file) == "Point(x=1, y=2) True False False\n"
    file.write_bytes(file.read_bytes()[:-1])
    assert run(file, "is damaged") == "Point(x=1, y=2) True False True\n"
    assert run(file) == "Point(x=1, y=2) True False False\n"
