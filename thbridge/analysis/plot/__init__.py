"""Figures of recordings, for pages and for print."""
