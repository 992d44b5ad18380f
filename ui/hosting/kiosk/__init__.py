"""The kiosk: people go through a study with people at one computer, page after page, by the study's log alone."""
