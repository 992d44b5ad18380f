import errno
from pathlib import Path

import pytest
import typer
from rich.table import Table

from tests.support.programs.commands import invoke
from thbridge.files.errors import BadFile, visible
from ui.command_line.terminal import err, fail, faults_of_files, note, out, say

HOSTILE = "/\x1b[2J\x1b]0;title\x07\u202e\x9b31m\x00\r"
SHOWN = r"/\x1b[2J\x1b]0;title\x07\u202e\x9b31m\x00\r"


def test_names_of_others_neither_clear_the_screen_nor_forge_lines(capsys: pytest.CaptureFixture[str]) -> None:
    say(HOSTILE)
    note(HOSTILE)
    with pytest.raises(typer.Exit):
        fail(2, HOSTILE)
    told = capsys.readouterr()
    assert (told.out, told.err) == (SHOWN + "\n", 2 * (SHOWN + "\n"))


def test_a_table_shows_them_as_they_are_and_takes_no_markup(capsys: pytest.CaptureFixture[str]) -> None:
    table = Table("a column with room for escapes")
    table.add_row("[/red] :bomb: \x1b[2J")
    out.print(table)
    assert r"[/red] :bomb: \x1b[2J" in capsys.readouterr().out


def test_lines_of_several_faults_stay_lines(capsys: pytest.CaptureFixture[str]) -> None:
    err.print("one\ntwo")
    assert capsys.readouterr().err == "one\ntwo\n"


def test_bytes_of_a_name_that_are_no_utf_8_can_be_printed(capsys: pytest.CaptureFixture[str]) -> None:
    say("a\udcff")
    assert capsys.readouterr().out == "a\\udcff\n"


def test_a_fault_is_one_line_whatever_the_name_at_fault() -> None:
    fault = BadFile(Path("a\nforged: all is well"), "a\x1b[2Jb", "c")
    assert str(fault) == r"a\nforged: all is well: a\x1b[2Jb. C."


def test_letters_of_all_writings_stay() -> None:
    text = "Größe Пример مثال 例 é 👩‍🚀"
    assert visible(text) == text


@pytest.mark.parametrize(
    ("error", "told"),
    [
        (OSError(errno.ENAMETOOLONG, "File name too long", "x" * 5000), f"{'x' * 200}...: file name too long."),
        (PermissionError(errno.EACCES, "Permission denied", "a"), "a: permission denied."),
        (OSError(errno.ENOSPC, "No space left on device"), "the disk: no space left on device."),
        (MemoryError(), "Not enough memory."),
    ],
)
def test_what_the_system_says_of_a_file_ends_a_command_in_a_message(
    error: Exception, told: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(typer.Exit) as ended, faults_of_files():
        raise error
    assert ended.value.exit_code == 2
    assert told in capsys.readouterr().err


def test_errors_of_the_program_and_of_sockets_are_not_hidden() -> None:
    for error in (ConnectionRefusedError(errno.ECONNREFUSED, "Connection refused"), KeyError("a"), RecursionError()):
        with pytest.raises(type(error)), faults_of_files():
            raise error


def test_every_command_ends_so() -> None:
    done = invoke("bag", "info", "x" * 300)
    assert (done.exit_code, done.stderr.count("\n")) == (2, 1)
    assert "file name too long" in done.stderr
