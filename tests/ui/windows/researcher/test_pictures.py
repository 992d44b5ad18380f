"""Pictures and sections saved from the researcher's window."""

import shutil
from pathlib import Path

import pytest
from PySide6.QtGui import QGuiApplication, QImage
from PySide6.QtSvg import QSvgRenderer
from pytestqt.qtbot import QtBot

from tests.ui.windows.researcher.recording_times import go_to
from thbridge.recording.bag.reading.reader import info
from ui.windows.researcher.pictures import FRAMES_PER_SECOND, NO_FFMPEG, copy_picture, image_of, save_picture
from ui.windows.researcher.window import ResearcherWindow


@pytest.mark.parametrize("part", ["map", "plots"])
def test_map_and_plots_are_copied_and_saved_as_they_are_shown(
    window: ResearcherWindow, tmp_path: Path, part: str
) -> None:
    go_to(window, 8.0)
    shown = window.canvas if part == "map" else window.plots.canvas
    copy_picture(shown)
    assert QGuiApplication.clipboard().image().size() == image_of(shown).size()
    png, svg = tmp_path / "a.png", tmp_path / "a.svg"
    assert (save_picture(shown, png), save_picture(shown, svg)) == ("", "")
    assert QImage(str(png)).size() == image_of(shown).size()
    assert QSvgRenderer(str(svg)).isValid() and svg.stat().st_size > 10_000
    for name in ("a.png", "a.svg"):
        assert "Cannot write" in save_picture(shown, tmp_path / "none" / name)


def test_without_ffmpeg_a_video_is_refused_in_words(window: ResearcherWindow, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", "")
    window.video_wanted.emit()
    assert window.statusBar().currentMessage() == NO_FFMPEG


def test_a_video_has_the_frames_of_its_section_and_the_time_stays(
    window: ResearcherWindow, tmp_path: Path, qtbot: QtBot
) -> None:
    recorder = tmp_path / "recorder"
    recorder.write_text('#!/bin/sh\nfor last; do :; done\ncat > "$last"\n')
    recorder.chmod(0o755)
    go_to(window, 3.0)
    writer = window.save_video(tmp_path / "a.mp4", (8.0, 8.2), str(recorder))
    with qtbot.waitSignal(writer.ended) as ended:
        pass
    assert ended.args == [""]
    frame = image_of(window.canvas)
    assert (tmp_path / "a.mp4").stat().st_size == 5 * frame.width() * frame.height() * 4
    window.refresh()
    assert window.playback.timeline.value() == 3000
    writer = window.save_video(tmp_path / "b.mp4", (8.0, 8.2), shutil.which("false") or "false")
    with qtbot.waitSignal(writer.ended) as ended:
        pass
    assert "Cannot save" in ended.args[0] and "b.mp4: ffmpeg" in ended.args[0]
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.mp4", "recorder"]
    assert FRAMES_PER_SECOND == 25


def test_a_section_is_saved_as_a_bag(window: ResearcherWindow, tmp_path: Path, qtbot: QtBot) -> None:
    assert window._feed.save_section(tmp_path / "piece.bag", 5.0, 6.0) == ""
    qtbot.waitUntil(lambda: "piece.bag" in window.statusBar().currentMessage())
    assert info(tmp_path / "piece.bag").duration == pytest.approx(1.0, abs=0.1)
