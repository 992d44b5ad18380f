"""Window of the kiosk: one page after the other, full screen, usable by mouse or by keyboard alone."""
