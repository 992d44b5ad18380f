"""Pages that fill the participant's window when no game is played: start, connecting, consent, help, the end."""
