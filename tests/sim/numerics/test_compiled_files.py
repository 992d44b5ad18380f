"""Nobody else can put compiled code where it is run, and no damaged file is run."""

import logging
import os
import random
import stat
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim.numerics import compiled_files
from sim.numerics.compiled_files import private_folder, read, write
from tests.support.disks.damaged_files import damaged

OTHER = 12345
"""An account that has no files."""
as_root = pytest.mark.skipif(os.getuid() != 0, reason="only root gives files to other accounts")


@pytest.fixture(autouse=True)
def notices(caplog: pytest.LogCaptureFixture) -> Iterator[pytest.LogCaptureFixture]:
    """What is logged; each test starts as a program that has logged nothing."""
    compiled_files._notify.cache_clear()
    with caplog.at_level(logging.WARNING):
        yield caplog


def mode(path: Path) -> int:
    return stat.S_IMODE(path.stat().st_mode)


@pytest.mark.parametrize("umask", [0o000, 0o002, 0o022, 0o077])
def test_folders_are_their_owners_alone_whatever_the_umask(tmp_path: Path, umask: int) -> None:
    os.umask(umask)  # The next test has its own again.
    kernels = private_folder([tmp_path / "cache" / "thbridge" / "kernels"])
    assert kernels == tmp_path / "cache" / "thbridge" / "kernels"
    file = kernels / f"sim.one-{0:016x}" / "code"
    write(file, b"code")
    assert {mode(folder) for folder in file.parents if tmp_path in folder.parents} == {0o700}
    assert mode(file) == 0o600


@pytest.mark.parametrize("shared", [0o720, 0o702, 0o770, 0o775, 0o777])
@pytest.mark.parametrize("level", ["a", "a/b", "a/b/kernels"])
def test_a_folder_that_others_may_write_at_any_level_is_refused(
    tmp_path: Path, notices: pytest.LogCaptureFixture, level: str, shared: int
) -> None:
    asked = tmp_path / "a" / "b" / "kernels"
    asked.mkdir(parents=True)
    (tmp_path / level).chmod(shared)
    assert private_folder([asked, tmp_path / "kernels"]) == tmp_path / "kernels"
    assert f"not kept in {asked}: other accounts can write to {tmp_path / level} (chmod go-w" in notices.text


def test_a_sticky_folder_may_be_above_but_is_no_place_for_code(tmp_path: Path) -> None:
    tmp_path.chmod(0o1777)
    assert private_folder([tmp_path / "kernels"]) == tmp_path / "kernels"
    (tmp_path / "kernels").chmod(0o1777)
    assert private_folder([tmp_path / "kernels", tmp_path / "own"]) == tmp_path / "own"


@as_root
@pytest.mark.parametrize("level", ["a", "a/kernels"])
def test_a_folder_of_another_account_is_refused(tmp_path: Path, notices: pytest.LogCaptureFixture, level: str) -> None:
    (tmp_path / "a" / "kernels").mkdir(parents=True)
    os.chown(tmp_path / level, OTHER, -1)
    assert private_folder([tmp_path / "a" / "kernels", tmp_path / "own"]) == tmp_path / "own"
    assert f"{tmp_path / level} belongs to another account" in notices.text


@as_root
def test_a_link_of_another_account_is_refused(tmp_path: Path) -> None:
    (tmp_path / "mine").mkdir()
    (tmp_path / "kernels").symlink_to("mine")
    assert private_folder([tmp_path / "kernels"]) == tmp_path / "mine"
    os.chown(tmp_path / "kernels", OTHER, -1, follow_symlinks=False)
    assert private_folder([tmp_path / "kernels", tmp_path / "own"]) == tmp_path / "own"


def test_what_a_link_leads_to_is_checked_as_well(tmp_path: Path) -> None:
    (tmp_path / "shared" / "mine").mkdir(parents=True)
    (tmp_path / "shared").chmod(0o777)
    (tmp_path / "kernels").symlink_to("shared/mine")
    assert private_folder([tmp_path / "kernels", tmp_path / "own"]) == tmp_path / "own"


def test_without_any_such_folder_code_is_kept_for_the_account_among_temporary_files(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    tmp_path.chmod(0o1777)
    monkeypatch.setattr(compiled_files, "gettempdir", lambda: str(tmp_path))
    kept = private_folder([Path("/proc/none/kernels")])
    assert kept == private_folder([]) == tmp_path / f"thbridge-{os.getuid()}" / "kernels"
    assert mode(kept) == 0o700


def file_in(folder: Path) -> Path:
    return folder / f"sim.one-{0:016x}" / "code"


@given(st.binary(), st.randoms(use_true_random=False))
def test_a_damaged_file_is_never_read(
    tmp_path_factory: pytest.TempPathFactory, content: bytes, draws: random.Random
) -> None:
    file = file_in(tmp_path_factory.mktemp("kernels"))
    write(file, content)
    assert read(file) == content
    file.write_bytes(damaged(file.read_bytes(), draws))
    assert read(file) is None
    assert not file.exists()


def test_a_notice_names_the_cache_once(tmp_path: Path, notices: pytest.LogCaptureFixture) -> None:
    for name in ("one", "two"):
        write(tmp_path / "sim.one-0" / name, b"code")
        (tmp_path / "sim.one-0" / name).write_bytes(b"")
        assert read(tmp_path / "sim.one-0" / name) is None
    assert notices.messages == [f"Compiled code in {tmp_path} is damaged. It is compiled again."]


def test_code_of_another_kernel_is_not_read(tmp_path: Path) -> None:
    write(tmp_path / "one" / "code", b"code")
    (tmp_path / "one" / "code").rename(tmp_path / "one" / "other")
    assert read(tmp_path / "one" / "other") is None


SHARED: list[Callable[[Path], None]] = [
    lambda file: file.chmod(0o620),
    lambda file: file.chmod(0o602),
    lambda file: file.parent.chmod(0o775),
    pytest.param(lambda file: os.chown(file, OTHER, -1), marks=as_root),
    pytest.param(lambda file: os.chown(file.parent, OTHER, -1), marks=as_root),
]


@pytest.mark.parametrize("share", SHARED)
def test_an_intact_file_that_others_could_change_is_not_read(
    tmp_path: Path, notices: pytest.LogCaptureFixture, share: Callable[[Path], None]
) -> None:
    file = file_in(tmp_path)
    write(file, b"code")
    share(file)
    assert read(file) is None
    assert notices.messages == [
        f"Compiled code in {tmp_path} could be changed by other accounts. It is compiled again."
    ]
    write(file, b"again")
    assert read(file) == b"again"


def test_neither_a_link_nor_a_pipe_is_read(tmp_path: Path) -> None:
    write(file_in(tmp_path), b"code")
    file_in(tmp_path).rename(tmp_path / "code")
    file_in(tmp_path).symlink_to(tmp_path / "code")
    assert read(file_in(tmp_path)) is None
    file_in(tmp_path).unlink()
    os.mkfifo(file_in(tmp_path))
    assert read(file_in(tmp_path)) is None


def test_what_is_not_compiled_code_is_not_deleted_for_its_age(tmp_path: Path) -> None:
    (tmp_path / "mine").mkdir()
    os.utime(tmp_path / "mine", (0, 0))
    write(file_in(tmp_path), b"code")
    assert (tmp_path / "mine").exists()
