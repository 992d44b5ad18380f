import os
import pickle
import random
import shutil
import subprocess
import sys
import time
from pathlib import Path

import pytest

from sim.numerics.compiled_files import write
from tests.support.disks.damaged_files import damaged
from tests.support.project import ROOT

CALLER = """\
from sim.callee import doubled
from sim.numerics.kernels import njit

@njit(cache=True)
def kernel(x):
    return doubled(x) + 1
"""
CALLEE = """\
from sim.numerics.kernels import njit

@njit(cache=True)
def doubled(x):
    return 2 * x
"""
PROGRAM = """\
import sys
from sim.caller import kernel
print(*(kernel(eval(argument)) for argument in sys.argv[1:]), sum(kernel.stats.cache_hits.values()))
"""


@pytest.fixture
def checkout(tmp_path: Path) -> Path:
    """A checkout of the compiler's module, with a kernel that calls another module's."""
    checkout = tmp_path / "checkout"
    shutil.copytree(
        ROOT / "sim" / "numerics", checkout / "sim" / "numerics", ignore=shutil.ignore_patterns("__pycache__")
    )
    (checkout / "sim" / "__init__.py").touch()
    (checkout / "sim" / "caller.py").write_text(CALLER)
    (checkout / "sim" / "callee.py").write_text(CALLEE)
    return checkout


def start(checkout: Path, *arguments: str, umask: int = -1) -> subprocess.Popen[str]:
    environment = {
        **os.environ,
        "PYTHONPATH": str(checkout),
        "NUMBA_CACHE_DIR": str(checkout.parent / "cache"),
        "PYTHONDONTWRITEBYTECODE": "1",
        "TMPDIR": str(checkout.parent),
    }
    command = [sys.executable, "-c", PROGRAM, *arguments]
    return subprocess.Popen(
        command, cwd=checkout, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, umask=umask
    )


def run(checkout: Path, *arguments: str, notice: str = "", umask: int = -1) -> list[str]:
    """What the kernel makes of the arguments, and how many signatures were compiled already; it prints a notice."""
    process = start(checkout, *arguments, umask=umask)
    said, told = process.communicate()
    assert process.returncode == 0, told
    assert notice in told if notice else not told, told
    return said.split()


def code_of(checkout: Path) -> Path:
    """The one file of the kernel's code."""
    (kept,) = (checkout.parent / "cache" / "kernels").glob("sim.caller-*/*")
    return kept


class Planted:
    """What another account would have us unpickle: it prints a word."""

    def __reduce__(self) -> tuple[object, ...]:
        return print, ("planted",)


def plant(file: Path) -> None:
    """Put a pickle there with the right checksum, which is no secret."""
    write(file, pickle.dumps(Planted()))


def replace(file: Path, old: str, new: str) -> None:
    text = file.read_text()
    assert old in text
    file.write_text(text.replace(old, new))


def test_a_kernel_is_compiled_once(checkout: Path) -> None:
    assert run(checkout, "3") == ["7", "0"]
    assert run(checkout, "3", "0.5") == ["7", "2.0", "1"]
    assert run(checkout, "3", "0.5") == ["7", "2.0", "2"]


def test_a_kernel_is_compiled_anew_when_a_module_that_it_calls_has_changed(checkout: Path) -> None:
    run(checkout, "3")
    replace(checkout / "sim/callee.py", "2 * x", "3 * x")
    assert run(checkout, "3") == ["10", "0"]


def test_a_change_in_what_a_kernel_does_not_import_leaves_it_compiled(checkout: Path) -> None:
    run(checkout, "3")
    replace(checkout / "sim/numerics/noise.py", '"""', '"""Changed. ')
    assert run(checkout, "3") == ["7", "1"]


@pytest.mark.slow
def test_checkouts_share_what_is_the_same_and_nothing_else(checkout: Path) -> None:
    run(checkout, "3")
    other = checkout.with_name("other")
    shutil.copytree(checkout, other)
    assert run(other, "3") == ["7", "1"]
    replace(other / "sim/callee.py", "2 * x", "3 * x")
    assert run(other, "3") == ["10", "0"]
    assert run(checkout, "3") == ["7", "1"]
    assert run(other, "3") == ["10", "1"]


@pytest.mark.slow
def test_processes_that_compile_at_once_keep_what_each_compiled(checkout: Path) -> None:
    arguments = ("3", "0.5", "True", "2j")
    for process in [start(checkout, argument) for argument in arguments]:
        process.communicate()
    assert run(checkout, *arguments)[-1] == "4"


def test_what_one_process_compiles_another_waits_for(checkout: Path) -> None:
    said = [process.communicate()[0].split() for process in [start(checkout, "3") for _ in range(2)]]
    assert sorted(said) == [["7", "0"], ["7", "1"]]


@pytest.mark.slow
def test_a_process_that_was_killed_while_it_compiled_holds_nobody_up(checkout: Path) -> None:
    run(checkout, "3")
    kept = code_of(checkout)
    kept.unlink()
    claim = "import fcntl, os, sys; fcntl.flock(open(sys.argv[1], 'w'), fcntl.LOCK_EX); os.kill(os.getpid(), 9)"
    subprocess.run([sys.executable, "-c", claim, f"{kept}.claim"], check=False)
    assert run(checkout, "3") == ["7", "0"]
    assert list(kept.parent.iterdir()) == [kept]


def test_a_number_in_a_kernels_text_asks_for_no_code_of_its_own(checkout: Path) -> None:
    replace(checkout / "sim/caller.py", "doubled(x) + 1", "doubled(x) + doubled(2)")
    assert run(checkout, "3") == ["10", "0"]
    assert len(list((checkout.parent / "cache" / "kernels").glob("sim.callee-*/*"))) == 1


@pytest.mark.parametrize("starts", [1, pytest.param(50, marks=pytest.mark.slow)])
def test_damaged_code_is_compiled_again_with_a_notice_that_names_the_cache(checkout: Path, starts: int) -> None:
    run(checkout, "3")
    cache = checkout.parent / "cache" / "kernels"
    draws = random.Random(starts)
    for _ in range(starts):
        for file in cache.glob("*/*"):
            file.write_bytes(damaged(file.read_bytes(), draws))
        assert run(checkout, "3", notice=f"Compiled code in {cache} is damaged. It is compiled again.") == ["7", "0"]
    assert run(checkout, "3") == ["7", "1"]


@pytest.mark.slow
def test_where_a_folder_cannot_be_written_code_is_kept_in_the_next_or_not_at_all(checkout: Path) -> None:
    (checkout.parent / "cache").touch()
    run(checkout, "3")
    assert run(checkout, "3") == ["7", "1"]
    shutil.rmtree(checkout / "sim" / "__pycache__")
    (checkout / "sim" / "__pycache__").touch()
    assert run(checkout, "3") == ["7", "0"]
    assert run(checkout, "3") == ["7", "1"]
    temporary = checkout.parent / f"thbridge-{os.getuid()}"
    shutil.rmtree(temporary)
    temporary.touch()
    run(checkout, "3")
    assert run(checkout, "3") == ["7", "0"]


@pytest.mark.parametrize("umask", [0o002, pytest.param(0o000, marks=pytest.mark.slow)])
def test_a_program_of_any_umask_keeps_its_code_to_itself(checkout: Path, umask: int) -> None:
    assert run(checkout, "3", umask=umask) == ["7", "0"]
    kept = [checkout.parent / "cache", *(checkout.parent / "cache").rglob("*")]
    assert {path.stat().st_mode & 0o077 for path in kept} == {0}
    assert run(checkout, "3", umask=umask) == ["7", "1"]


def test_a_pickle_that_a_member_of_the_group_could_put_there_does_not_run(checkout: Path) -> None:
    run(checkout, "3")
    kernels = checkout.parent / "cache" / "kernels"
    plant(code_of(checkout))
    kernels.chmod(0o775)
    refused = f"Compiled code is not kept in {kernels}: other accounts can write to {kernels} (chmod go-w {kernels})."
    assert run(checkout, "3", notice=refused) == ["7", "0"]
    assert run(checkout, "3", notice=refused) == ["7", "1"], "it is kept beside the sources"
    kernels.chmod(0o755)
    code_of(checkout).parent.chmod(0o775)
    assert run(checkout, "3", notice="could be changed by other accounts") == ["7", "0"]
    assert run(checkout, "3") == ["7", "1"]


def test_old_code_goes_when_new_code_comes(checkout: Path) -> None:
    folder = checkout.parent / "cache" / "kernels"
    now = time.time()
    # What other programs used an hour ago, and what nobody used for two months.
    versions = [f"sim.caller-{number:016x}" for number in range(20)]
    for number, name in enumerate(versions):
        (folder / name).mkdir(parents=True)
        os.utime(folder / name, (now - 3600 - number,) * 2)
    forgotten = folder / f"sim.forgotten-{0:016x}"
    forgotten.mkdir()
    os.utime(forgotten, (now - 60 * 86400,) * 2)
    run(checkout, "3")
    left = {path.name for path in folder.iterdir()}
    assert left & set(versions) == set(versions[:15])
    assert forgotten.name not in left
