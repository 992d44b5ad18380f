"""What travels: bytes to frames and back, their checksums and signatures. No frame is read any further here."""
