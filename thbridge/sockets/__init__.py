"""TCP and UDP: carries out what `thbridge.wire` decides; nothing is decided here."""
