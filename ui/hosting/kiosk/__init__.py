"""Kiosk: people go through a study at one computer, page after page. Its only state is the log of the study."""
