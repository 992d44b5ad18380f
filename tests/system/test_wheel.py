"""What a person gets who installs the wheel, far from any checkout."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest

from tests.support.project import ROOT

LOAD = """
from pathlib import Path
import thbridge
from thbridge.files.map_files import read_map
from thbridge.files.resources import shipped
print(Path(thbridge.__file__).parent)
print(Path(thbridge.__file__).with_name("analysis").joinpath("report_page", "page.html").is_file())
print(len([*(shipped().root / "docs").rglob("*.md")]), any((shipped().root / "docs" / "pictures").glob("*")))
print(len(read_map(shipped().find("maps", "arena8", Path())).rooms), *shipped().names("templates"))
"""


USER = """
import numpy as np
from thbridge import api

study = api.HuntStudy(robots=2, changes={"game.energy": 30, "robot.amcl.max_particles": 500})
with api.HuntSession(study, participant="nearest") as session:
    session.run_until(lambda now: now.snapshot.score > 0, at_most=60.0)
    poses: np.ndarray[tuple[int, ...], np.dtype[np.float64]] = session.snapshot.poses
    for event in session.events:
        robot: int | None = event.robot
session.step("1")
api.HuntSession(study, participant=2)
"""
"""A program of a user; its last two statements are wrong."""


def pip(*arguments: str | Path) -> None:
    subprocess.run([sys.executable, "-m", "pip", "--quiet", "--disable-pip-version-check", *arguments], check=True)


def install(tmp_path: Path) -> Path:
    """Build the wheel and return the folder that it is installed in."""
    pip("wheel", "--no-deps", "--no-build-isolation", "--wheel-dir", tmp_path, ROOT)
    (wheel,) = tmp_path.glob("*.whl")
    installed = tmp_path / "installed"
    pip("install", "--no-deps", "--target", installed, wheel)
    return installed


def run(*command: str, cwd: Path, **environment: str) -> subprocess.CompletedProcess[str]:
    cwd.mkdir(exist_ok=True)
    environment = {**os.environ, **environment}
    return subprocess.run(command, cwd=cwd, env=environment, check=False, capture_output=True, text=True)


def examples_of(page: str) -> str:
    """The examples of a page as one program, which says in the end where the interface is from."""
    text = (ROOT / "docs" / page).read_text()
    return "\n".join([*re.findall(r"^```python\n(.*?)^```$", text, re.MULTILINE | re.DOTALL), "print(api.__file__)"])


def test_the_wheel_carries_maps_templates_and_the_page_of_reports(tmp_path: Path) -> None:
    installed = install(tmp_path)
    loaded = run(sys.executable, "-c", LOAD, cwd=tmp_path / "elsewhere", PYTHONPATH=str(installed))
    assert loaded.returncode == 0, loaded.stderr
    sets = "everyday-things four-properties original-2016 practice sklar-azhar-2015"
    pages = len([*(ROOT / "docs").rglob("*.md")])
    assert loaded.stdout.splitlines() == [str(installed / "thbridge"), "True", f"{pages} False", f"8 {sets}"]


@pytest.mark.slow
@pytest.mark.parametrize("page", ["reference/api.md", "how-to/learning.md"])
def test_the_examples_of_the_documentation_run_from_the_wheel(tmp_path: Path, page: str) -> None:
    installed = install(tmp_path)
    done = run(sys.executable, "-c", examples_of(page), cwd=tmp_path / "elsewhere", PYTHONPATH=str(installed))
    assert done.returncode == 0, done.stderr
    assert Path(done.stdout.splitlines()[-1]).is_relative_to(installed)


@pytest.mark.slow
def test_the_examples_run_where_nothing_is_but_the_wheel_and_what_it_names(tmp_path: Path) -> None:
    """A dependency that only the project's own environment has is missing here; versions are those of the lock."""
    uv = Path(sys.executable).with_name("uv")
    python = tmp_path / "empty" / "bin" / "python"
    for command in (
        (uv, "build", "--quiet", "--wheel", "--no-build-isolation", "--out-dir", tmp_path, ROOT),
        (uv, "venv", "--quiet", "--python", sys.executable, tmp_path / "empty"),
    ):
        subprocess.run(command, check=True)
    (wheel,) = tmp_path.glob("*.whl")
    lock = ("--constraint", ROOT / "requirements.lock")
    subprocess.run([uv, "pip", "install", "--quiet", "--python", python, *lock, wheel], check=True)
    done = run(str(python), "-I", "-c", examples_of("api.md"), cwd=tmp_path / "elsewhere")
    assert done.returncode == 0, done.stderr
    assert Path(done.stdout.splitlines()[-1]).is_relative_to(tmp_path / "empty")


ORDINARY = 65534
"""User ID of nobody."""
FIRST_DAY = (
    "doctor",
    "docs sweeps",
    "play --headless --map practice --robots 1 --rate 0 --max-seconds 120 --bag a.bag",
    "report a.bag",
    "study init study.yaml",
    "study check study.yaml",
    "study new lab",
    "study check lab",
    "sweep run short.yaml",
    "sweep collect short --to games.csv",
)


@pytest.mark.slow
def test_an_ordinary_user_with_the_wheel_alone_checks_plays_studies_and_sweeps() -> None:
    uv = Path(sys.executable).with_name("uv")
    system = shutil.which("python3", path="/usr/bin")
    as_user = {"user": ORDINARY, "group": ORDINARY, "extra_groups": []} if os.getuid() == 0 and system else {}
    with TemporaryDirectory() as folder:
        place = Path(folder)
        place.chmod(0o755)
        home = place / "home"
        home.mkdir()
        if as_user:
            os.chown(home, ORDINARY, ORDINARY)
        (home / "short.yaml").write_text("base: {map: practice, robots: 1}\nreplicates: 2\nmax_seconds: 5\n")
        python = place / "empty" / "bin" / "python"
        lock = ("--constraint", ROOT / "requirements.lock", "--link-mode", "copy")
        base = system if as_user else sys.executable
        build = (uv, "build", "--quiet", "--wheel", "--no-build-isolation", "--out-dir", place, ROOT)
        subprocess.run(build, check=True)
        subprocess.run((uv, "venv", "--quiet", "--python", base, place / "empty"), check=True)
        (wheel,) = place.glob("*.whl")
        subprocess.run((uv, "pip", "install", "--quiet", "--python", python, *lock, wheel), check=True)
        bare = {"PATH": os.environ["PATH"], "HOME": str(home), "LC_ALL": "C.UTF-8"}
        for line in FIRST_DAY:
            command = [python.with_name("thbridge"), *line.split()]
            done = subprocess.run(
                command, cwd=home, env=bare, check=False, capture_output=True, text=True, timeout=300, **as_user
            )
            assert done.returncode == 0, f"{line}\n{done.stdout}{done.stderr}"
            assert "Traceback" not in done.stderr, done.stderr
        assert "home" in str(next((home / ".cache" / "thbridge").iterdir()))


@pytest.mark.slow
def test_programs_of_users_are_checked_by_the_types_of_the_wheel(tmp_path: Path) -> None:
    installed = install(tmp_path)
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    (elsewhere / "user.py").write_text(USER)
    command = [sys.executable, "-m", "mypy", "--strict", "--follow-imports=silent", "--no-incremental", "user.py"]
    checked = run(*command, cwd=elsewhere, MYPYPATH=str(installed))
    lines = USER.splitlines()
    wrong = [lines.index('session.step("1")') + 1, lines.index("api.HuntSession(study, participant=2)") + 1]
    told = checked.stdout.splitlines()
    assert [int(line.split(":")[1]) for line in told if ": error:" in line] == wrong, checked.stdout
