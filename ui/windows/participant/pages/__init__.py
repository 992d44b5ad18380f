"""Pages that fill the participant's window while nothing is played: start, connecting, consent, help, the end."""
