"""The participant's window."""

from ui.windows.participant.pages.start import StartPage
from ui.windows.participant.window import Model, ParticipantWindow

__all__ = ["Model", "ParticipantWindow", "StartPage"]
