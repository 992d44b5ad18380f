"""Pages of the kiosk: texts and forms."""
