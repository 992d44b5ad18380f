"""Kiosk: people go through a study at one computer, page after page. The kiosk's only state is the study's log."""
