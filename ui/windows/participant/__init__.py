"""Participant's window."""

from ui.windows.participant.pages.start import StartPage
from ui.windows.participant.window import ParticipantWindow

__all__ = ["ParticipantWindow", "StartPage"]
