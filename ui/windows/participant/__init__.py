"""The participant's window."""

from ui.windows.participant.pages.start import StartPage
from ui.windows.participant.window import ParticipantModel, ParticipantWindow

__all__ = ["ParticipantModel", "ParticipantWindow", "StartPage"]
