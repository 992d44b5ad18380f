"""The kiosk's window: one page after the other, full screen, by mouse and by keyboard alone."""
