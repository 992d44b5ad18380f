"""Sounds of the participant's window. Each of the five sounds is a short sequence of tones.

A separate program of the system plays them, so the window needs no library for sound. Without sound hardware, this
program fails without blocking the window.
"""

import io
import shutil
import wave
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QObject, QProcess, QTemporaryDir

from thbridge.files.disk.whole import write_whole
from thbridge.files.errors import BadFile
from ui.model.playing.screen import GameSound

RATE = 44_100
"""Samples per second."""
LOUDNESS = 0.25
"""Largest amplitude, as a share of full scale."""
ATTACK = 0.008
"""Rise time of a tone, seconds. Without this time, the tone would begin with a click."""
TONES: Mapping[GameSound, tuple[tuple[float, float, float], ...]] = {
    GameSound.ARRIVAL: ((587.3, 0.0, 0.22),),
    GameSound.FIND: ((784.0, 0.0, 0.16), (1046.5, 0.1, 0.3)),
    GameSound.QUESTION: ((880.0, 0.0, 0.12), (880.0, 0.13, 0.12), (1174.7, 0.26, 0.24)),
    GameSound.WON: ((523.3, 0.0, 0.16), (659.3, 0.08, 0.18), (784.0, 0.16, 0.2), (1046.5, 0.24, 0.26)),
    GameSound.LOST: ((392.0, 0.0, 0.22), (311.1, 0.17, 0.33)),
}
"""Tones of each sound: frequency, hertz; start and length, seconds.

The tones of a win rise, the tones of a loss fall, and the last tone of a question rises.
"""
KILL_TIMEOUT = 1000
"""Milliseconds to wait for the end of a killed program."""
PLAYERS = (("pw-play",), ("paplay",), ("aplay", "-q"), ("afplay",))
"""Programs of Linux and macOS that play a file. The first installed program is used."""


def samples_of(sound: GameSound) -> NDArray[np.int16]:
    """Return a sound as 16-bit samples, `RATE` per second."""
    tones = TONES[sound]
    total = np.zeros(round(max(begin + length for _, begin, length in tones) * RATE))
    for frequency, begin, length in tones:
        time = np.arange(round(length * RATE)) / RATE
        wave_form = np.sin(2 * np.pi * frequency * time) + 0.2 * np.sin(4 * np.pi * frequency * time)
        envelope = np.minimum(time / ATTACK, 1.0) * np.exp(-4.0 * time / length) * (1.0 - time / length)
        first = round(begin * RATE)
        total[first : first + len(time)] += wave_form * envelope
    samples: NDArray[np.int16] = np.round(total / np.abs(total).max() * LOUDNESS * 32767).astype(np.int16)
    return samples


def wav_of(sound: GameSound) -> bytes:
    """Return a sound as a WAV file."""
    file = io.BytesIO()
    with wave.open(file, "wb") as out:
        out.setnchannels(1)
        out.setsampwidth(2)
        out.setframerate(RATE)
        out.writeframes(samples_of(sound).astype("<i2").tobytes())
    return file.getvalue()


def system_player() -> tuple[str, ...] | None:
    """Return the command that plays a file on this computer, without the file's name; None if there is no command."""
    return next((player for player in PLAYERS if shutil.which(player[0])), None)


class SoundPlayer(QObject):
    """Player that plays one sound at a time.

    If several sounds are requested during a sound, only the most important sound is played next.

    Args:
        parent: owner of the player. If the owner is deleted, the sound ends.
        command: command that plays the file whose path is appended. If None, no sound is played.
    """

    def __init__(self, parent: QObject, command: tuple[str, ...] | None) -> None:
        super().__init__(parent)
        self._command = command
        self._next: GameSound | None = None
        self._folder = QTemporaryDir()
        self._process = QProcess(self)
        self._process.setStandardOutputFile(QProcess.nullDevice())
        self._process.setStandardErrorFile(QProcess.nullDevice())
        self._process.finished.connect(self._go_on)

    @property
    def is_playing(self) -> bool:
        """True while a sound is playing."""
        return self._process.state() is not QProcess.ProcessState.NotRunning

    def play(self, sound: GameSound) -> None:
        """Play a sound now, or after the current sound. Do nothing if sound is not possible."""
        if self._command is None or not self._folder.isValid():
            return
        if self.is_playing:
            self._next = sound if self._next is None else max(sound, self._next)
            return
        file = Path(self._folder.filePath(f"{sound.name.lower()}.wav"))
        if not file.exists():
            try:
                write_whole(file, wav_of(sound))
            except BadFile:
                return
        program, *arguments = self._command
        self._process.start(program, [*arguments, str(file)])

    def stop(self) -> None:
        """Stop the current sound at once, and drop waiting sounds."""
        self._next = None
        self._process.kill()
        self._process.waitForFinished(KILL_TIMEOUT)

    def _go_on(self) -> None:
        sound, self._next = self._next, None
        if sound is not None:
            self.play(sound)
