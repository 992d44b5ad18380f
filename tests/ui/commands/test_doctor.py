"""`thbridge doctor`: what a computer lacks, with the remedy."""

import json
import os
import re
import socket
import subprocess
import sys
import time
from pathlib import Path

import pytest
from packaging.requirements import Requirement

from tests.support.programs.commands import invoke
from tests.support.project import ROOT
from ui.commands.doctor.packages import lacking
from ui.commands.doctor.places import check_folder
from ui.commands.doctor.ports import check_ports
from ui.commands.doctor.qt_libraries import QT_LIBRARIES, remedy_for
from ui.commands.doctor.result import HealthState
from ui.commands.doctor.screen import failed_window, try_window
from ui.commands.doctor.surroundings import check_clock, check_libraries, check_locale


def test_a_line_for_each_check_and_all_of_it_as_json(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    done = invoke("doctor")
    told = json.loads(invoke("doctor", "--json").stdout)
    names = [check["name"] for check in told["checks"]]
    assert (done.exit_code, told["ok"]) == (0, True), done.stdout
    assert len(done.stdout.splitlines()) == len(names)
    for line, check in zip(done.stdout.splitlines(), told["checks"], strict=True):
        assert line.startswith(check["state"])
        assert bool(check["remedy"]) is (check["state"] != "ok")
    expected = {"python", "extra gui", "Qt's libraries", "screen", "port 6009", "compiled code", "clock", "locale"}
    assert expected <= set(names)
    assert not list(tmp_path.iterdir())


def test_a_folder_that_cannot_be_written_is_a_fault_and_the_exit_code_says_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "bags").touch()
    monkeypatch.chdir(tmp_path)
    done = invoke("doctor", "--json")
    told = json.loads(done.stdout)
    assert (done.exit_code, told["ok"]) == (1, False)
    (fault,) = [check for check in told["checks"] if check["state"] == "fault"]
    assert (fault["name"], "is not writable" in fault["message"]) == ("recordings", True)
    assert check_folder("x", Path("/proc/none")).state is HealthState.FAULT


def test_a_port_that_is_held_is_named_with_its_program() -> None:
    with socket.create_server(("127.0.0.1", 0)) as held:
        port = held.getsockname()[1]
        (check,) = check_ports({port: "--port"})
        assert check.state is HealthState.WARNING
        assert re.search(rf"used by .+ \(process {os.getpid()}\)", check.message)
        assert "--port" in check.remedy
    (check,) = check_ports({port: "--port"})
    assert check.message == "free"


def test_missing_libraries_are_named_by_their_packages() -> None:
    def load(name: str) -> None:
        if "xcb" in name:
            raise OSError

    check = check_libraries(load)
    assert check.state is HealthState.WARNING
    assert "libxcb-cursor0 libxcb-icccm4 libxcb-keysyms1 libxcb-shape0" in check.remedy
    assert "libgl1" not in check.remedy


def test_packages_of_other_libraries_are_named_by_debians_policy() -> None:
    remedy = remedy_for(["libxcb-render-util.so.0", "libX11-xcb.so.1", "libxkbcommon-x11.so.0"])
    assert "libxcb-render-util0 libx11-xcb1 libxkbcommon-x11-0" in remedy


def test_a_window_is_opened_by_qt() -> None:
    check = try_window({**os.environ, "QT_QPA_PLATFORM": "offscreen"})
    assert (check.state, "(Qt's platform offscreen)" in check.message) == (HealthState.OK, True), check


def test_libraries_that_qt_cannot_load_are_named_with_their_packages() -> None:
    said = """qt.core.library: "/x/plugins/platforms/libqxcb.so" cannot load: Cannot load library /x/libqxcb.so: \
libxcb-cursor.so.0: cannot open shared object file: No such file or directory
qt.qpa.plugin: From 6.5.0, xcb-cursor0 or libxcb-cursor0 is needed to load the Qt xcb platform plugin.
qt.qpa.plugin: Could not load the Qt platform plugin "xcb" in "" even though it was found.
"""
    check = failed_window("DISPLAY=:0", said, "")
    assert check.message == "no window opens on DISPLAY=:0: Qt cannot load libxcb-cursor.so.0"
    assert check.remedy.endswith(" libxcb-cursor0")


def test_a_display_that_is_not_there_is_named_in_qts_words() -> None:
    check = try_window({**os.environ, "QT_QPA_PLATFORM": "xcb", "DISPLAY": ":987"})
    assert check.state is HealthState.WARNING
    assert check.message.endswith("could not connect to display :987"), check


def test_a_display_that_does_not_answer_ends_by_a_timeout() -> None:
    with socket.create_server(("127.0.0.1", 6987)) as silent:
        assert silent
        check = try_window({**os.environ, "QT_QPA_PLATFORM": "xcb", "DISPLAY": "127.0.0.1:987"}, 0.5)
    assert "within 0.5 s" in check.message, check


def test_ports_of_a_study(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    with socket.create_server(("127.0.0.1", 0)) as held:
        port = held.getsockname()[1]
        Path("study.yaml").write_text(
            f"server: {{port: 0}}\nwatch: {{port: {port}}}\nmavlink: {{on: true, tcp: 127.0.0.1:5761}}\n"
        )
        told = json.loads(invoke("doctor", "study.yaml", "--json").stdout)
    ports = {check["name"]: check for check in told["checks"] if check["name"].startswith("port ")}
    assert ports.keys() == {f"port {port}", "port 5761", "port 8765", "port 11311"}
    assert ports[f"port {port}"]["remedy"].endswith("choose another port with watch.port")


def test_set_up_installs_the_packages_that_are_checked() -> None:
    text = (ROOT / "scripts" / "set_up.sh").read_text()
    listed = re.search(r"for package in (lib.*?); do", text, re.DOTALL)
    assert listed
    asked = {*listed[1].replace("\\\n", " ").split(), "libglib2.0-0"} - {"fonts-inter"}
    assert asked == set(QT_LIBRARIES.values())


def test_packages_that_are_missing_or_of_another_version_are_named() -> None:
    wanted = ["numpy>=999", "nonsense-of-nobody", "typer>=0.1", 'no-such-extra>=1; extra == "x"']
    requirements = [Requirement(line) for line in wanted]
    first, second = lacking(requirements, "")
    assert re.fullmatch(r"numpy has version [\d.]+, but >=999 is required", first)
    assert second == "nonsense-of-nobody is not installed"
    assert list(lacking(requirements, "x")) == ["no-such-extra is not installed"]


def test_a_clock_before_the_installation_and_one_that_goes_back(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TZ", "Nowhere/Land")
    clock, zone = check_clock(0.0)
    assert (clock.state, zone.state) == (HealthState.WARNING, HealthState.WARNING)
    now = 4e9
    steps = iter(range(1000, 0, -1))
    assert next(check_clock(now, lambda: float(next(steps)))).state is HealthState.FAULT
    monkeypatch.delenv("TZ")
    assert [check.state for check in check_clock(now, time.monotonic)] == [HealthState.OK] * 2


def test_a_locale_that_is_not_installed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("LC_ALL", "xx_YY.UTF-8")
    assert "is not installed" in check_locale().message


def test_it_needs_no_extra(tmp_path: Path) -> None:
    absent = "import sys; sys.modules.update(dict.fromkeys(('PySide6', 'pyqtgraph', 'clingo', 'pylsl', 'foxglove')))\n"
    program = absent + "from ui.cli import main; sys.argv = ['thbridge', 'doctor']; main()"
    done = subprocess.run(
        [sys.executable, "-c", program], cwd=tmp_path, env={**os.environ, "PYTHONPATH": str(ROOT)},
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert (done.returncode, done.stderr) == (0, ""), done.stderr
