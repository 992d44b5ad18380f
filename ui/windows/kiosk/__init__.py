"""Window of the kiosk. It shows one page at a time on the full screen; people can use mouse or keyboard alone."""
