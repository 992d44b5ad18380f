"""Sounds as files, and the program that plays them one after the other."""

import io
import sys
import wave
from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import QObject
from pytestqt.qtbot import QtBot

from ui.model.playing.screen import GameSound
from ui.windows.sounds import RATE, TONES, SoundPlayer, samples_of, system_player, wav_of


@pytest.mark.parametrize("sound", GameSound)
def test_a_sound_is_short_quiet_begins_and_ends_in_silence_and_has_its_tones(sound: GameSound) -> None:
    with wave.open(io.BytesIO(wav_of(sound))) as file:
        assert (file.getnchannels(), file.getsampwidth(), file.getframerate()) == (1, 2, RATE)
        samples = np.frombuffer(file.readframes(file.getnframes()), "<i2")
    assert np.array_equal(samples, samples_of(sound))
    assert len(samples) / RATE < 0.55
    assert 0.2 < np.abs(samples).max() / 32767 < 0.3
    assert max(abs(int(samples[0])), abs(int(samples[-1]))) < 100
    spectrum = np.abs(np.fft.rfft(samples, 4 * RATE))
    loud = spectrum > spectrum.max() / 4
    for frequency, _, _ in TONES[sound]:
        assert loud[round(4 * frequency) - 20 : round(4 * frequency) + 20].any(), frequency


def test_no_two_sounds_are_alike() -> None:
    assert len({wav_of(sound) for sound in GameSound}) == len(GameSound)


def test_points_won_rise_points_lost_fall_and_a_question_ends_upward() -> None:
    pitch = {sound: [frequency for frequency, _, _ in TONES[sound]] for sound in GameSound}
    assert pitch[GameSound.WON] == sorted(set(pitch[GameSound.WON]))
    assert pitch[GameSound.LOST] == sorted(set(pitch[GameSound.LOST]), reverse=True)
    assert pitch[GameSound.QUESTION][-1] > max(pitch[GameSound.QUESTION][:-1])


def test_the_player_is_the_first_program_of_the_system_that_is_there(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    assert system_player() is None
    for name in ("aplay", "paplay"):
        (tmp_path / name).write_text("#!/bin/sh\n")
        (tmp_path / name).chmod(0o755)
    assert system_player() == ("paplay",)


RECORDER = "import sys, shutil; shutil.copy(sys.argv[2], sys.argv[1] + '/' + sys.argv[2].rpartition('/')[2])"


def recorder(folder: Path) -> tuple[str, ...]:
    """A program that keeps each file that it is to play."""
    return sys.executable, "-c", RECORDER, str(folder)


def test_files_are_played_one_at_a_time_and_the_most_important_one_next(tmp_path: Path, qtbot: QtBot) -> None:
    owner = QObject()
    player = SoundPlayer(owner, recorder(tmp_path))
    player.play(GameSound.ARRIVAL)
    player.play(GameSound.WON)
    player.play(GameSound.QUESTION)
    qtbot.waitUntil((tmp_path / "won.wav").exists)
    qtbot.waitUntil(lambda: not player.is_playing)
    assert {file.name for file in tmp_path.iterdir()} == {"arrival.wav", "won.wav"}
    assert (tmp_path / "won.wav").read_bytes() == wav_of(GameSound.WON)


def test_what_waits_is_dropped_when_it_is_silenced(tmp_path: Path, qtbot: QtBot) -> None:
    owner = QObject()
    player = SoundPlayer(owner, (sys.executable, "-c", "import time; time.sleep(60)"))
    player.play(GameSound.ARRIVAL)
    player.play(GameSound.WON)
    player.stop()
    assert not player.is_playing


@pytest.mark.parametrize("command", [None, ("no-such-program",), (sys.executable, "-c", "raise SystemExit(1)")])
def test_a_player_that_is_missing_or_fails_holds_nothing_up(
    command: tuple[str, ...] | None, qtbot: QtBot, capfd: pytest.CaptureFixture[str]
) -> None:
    owner = QObject()
    player = SoundPlayer(owner, command)
    for _ in range(3):
        player.play(GameSound.FIND)
        qtbot.waitUntil(lambda: not player.is_playing)
    assert capfd.readouterr() == ("", "")
