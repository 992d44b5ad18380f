"""Set-up on other systems: programs of the system are replaced by small ones in PATH."""

import shutil
import subprocess
from pathlib import Path

import pytest

SCRIPTS = Path(__file__).parents[2] / "scripts"
TOOLS = ("bash", "cat", "dirname", "dpkg", "grep", "id", "mkdir", "sed", "sha256sum", "tr")
WITHOUT_ROOT = {"id": "echo 1000"}
REMEDIES = ("uv python install 3.11", "ppa:deadsnakes/ppa", "python3.11-venv", "make setup PYTHON=")


def run(folder: Path, script: str, programs: dict[str, str]) -> str:
    """Run a script of set-up where only these programs are, besides tools; return what it says on standard error."""
    places = folder / "bin", folder / "scripts"
    for place in places:
        place.mkdir(exist_ok=True)
    for tool in TOOLS:
        (places[0] / tool).unlink(missing_ok=True)
        (places[0] / tool).symlink_to(shutil.which(tool) or pytest.skip(f"there is no {tool}"))
    for name, text in programs.items():
        (places[0] / name).unlink(missing_ok=True)
        (places[0] / name).write_text(f"#!/bin/bash\n{text}\n")
        (places[0] / name).chmod(0o755)
    for name in ("requirements.lock", "pyproject.toml"):
        (folder / name).touch()
    for name in (script, "packages.sh"):
        shutil.copy(SCRIPTS / name, places[1])
    done = subprocess.run(
        [places[1] / script], env={"PATH": str(places[0]), "HOME": str(folder)}, capture_output=True, text=True,
        check=False, stdin=subprocess.DEVNULL,
    )  # fmt: skip
    return done.stderr


def offering(version: str) -> dict[str, str]:
    """Return programs of a system with an old Python, whose packages have this version."""
    policy = f"echo 'python3:'; echo '  Candidate: {version}'"
    return {"python3": "exit 1", "apt-get": "exit 0", "apt-cache": policy, **WITHOUT_ROOT}


@pytest.mark.parametrize("version", ["3.10.6-1~22.04.1", "3.9.2-3", "(none)"])
@pytest.mark.parametrize("user", [0, 1000])
def test_packages_that_are_too_old_are_no_remedy(tmp_path: Path, version: str, user: int) -> None:
    told = run(tmp_path, "set_up.sh", offering(version) | {"id": f"echo {user}"})
    assert all(remedy in told for remedy in REMEDIES), told
    assert "apt-get install python3 python3-venv" not in told
    assert f"have {version.replace('(none)', 'none')}." in told


def test_where_there_is_no_apt_only_what_works_there_is_offered(tmp_path: Path) -> None:
    assert "uv python install 3.11" in run(tmp_path, "set_up.sh", {"python3": "exit 1", **WITHOUT_ROOT})


def test_packages_that_are_new_enough_are_the_remedy(tmp_path: Path) -> None:
    told = run(tmp_path, "set_up.sh", offering("3.11.2-1+b1"))
    assert "Install them with: sudo apt-get install python3 python3-venv" in told
    assert "deadsnakes" not in told


def test_a_python_that_uv_installed_is_found(tmp_path: Path) -> None:
    place = tmp_path / ".local" / "bin"
    place.mkdir(parents=True)
    (place / "python3.11").write_text("#!/bin/bash\necho used >>$HOME/used\n")
    (place / "python3.11").chmod(0o755)
    told = run(tmp_path, "set_up.sh", offering("3.10.6"))
    assert "needs Python 3.11" not in told
    assert (tmp_path / "used").exists()


@pytest.mark.parametrize(
    ("state", "is_installed"),
    [
        ("installed", True),
        ("triggers-pending", True),
        ("triggers-awaited", True),
        ("installed\ninstalled", True),  # for two architectures
        ("not-installed\ninstalled", True),
        ("half-configured", False),
        ("config-files", False),
        ("unpacked", False),
        ("", False),
    ],
)
@pytest.mark.parametrize("script", ["set_up.sh", "install_peers.sh"])
def test_a_package_is_installed_while_triggers_of_it_are_to_run(
    tmp_path: Path, script: str, state: str, is_installed: bool
) -> None:
    query = f"echo -e '{state}'".replace("\n", "\\n") if state else "exit 1"
    programs = {"dpkg-query": query, "apt-get": "exit 0", "python3.11": "exit 0", **WITHOUT_ROOT}
    told = run(tmp_path, script, programs)
    assert ("sudo apt-get install" in told) is not is_installed, told


def test_each_script_asks_by_the_same_function() -> None:
    asking = [path.name for path in SCRIPTS.rglob("*") if path.is_file() and b"dpkg-query -W" in path.read_bytes()]
    assert asking == ["packages.sh"]
