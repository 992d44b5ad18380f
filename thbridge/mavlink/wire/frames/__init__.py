"""Frames on the wire: bytes to frames and back, checksums and signatures. Payloads are not decoded here."""
