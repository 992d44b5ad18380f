"""Hosting of participants: at a window of their own, at the keyboard in the terminal, or simulated."""
