"""Figures of recordings, for HTML pages and for print."""
