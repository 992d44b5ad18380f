"""A crash of another program skips a test; an exit status of it fails the test."""

import subprocess
from collections.abc import Iterator

import pytest

from tests.support.programs.peer_programs import ATTEMPTS, RestartedPeer, skip_if_crashed, skipping_if_crashed


def started(script: str) -> subprocess.Popen[bytes]:
    return subprocess.Popen(["sh", "-c", script])


def peer(*scripts: str) -> tuple[RestartedPeer, Iterator[str]]:
    """A program that does each of these at one start after the other, and what it has not done yet."""
    left = iter(scripts)

    def start() -> subprocess.Popen[bytes]:
        process = started(next(left))
        process.wait()
        return process

    return RestartedPeer("peer", start, lambda: "first\nmunmap_chunk(): invalid pointer\n"), left


@pytest.mark.parametrize("number", ["ABRT", "SEGV", "BUS", "KILL"])
def test_a_program_that_crashes_is_started_again(number: str) -> None:
    crash = f"kill -{number} $$"
    running, left = peer(crash, crash, crash, "exit 3", "never")
    for _ in range(ATTEMPTS - 1):
        running.keep_running()
    with pytest.raises(AssertionError, match=r"exit status 3\n\s*first"):
        running.keep_running()
    assert list(left) == ["never"]


def test_a_program_that_crashes_at_every_start_skips_the_test_and_the_reason_is_shown() -> None:
    running, _ = peer(*["kill -ABRT $$"] * ATTEMPTS)
    for _ in range(ATTEMPTS - 1):
        running.keep_running()
    with pytest.raises(pytest.skip.Exception, match=r"peer, started 4 times, crashed: SIGABRT \(munmap_chunk"):
        running.keep_running()


def test_an_exit_status_is_no_crash() -> None:
    for status in (None, 0, 1, 134):
        skip_if_crashed("peer", status)


@pytest.mark.parametrize(("script", "raised"), [("kill -SEGV $$", pytest.skip.Exception), ("exit 1", AssertionError)])
def test_a_test_that_fails_is_skipped_only_if_the_program_crashed(script: str, raised: type[BaseException]) -> None:
    with pytest.raises(raised), skipping_if_crashed("peer", started(script)):
        raise AssertionError
