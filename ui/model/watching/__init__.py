"""View model of the researcher's window, for sessions and recordings; no Qt, clock or thread."""
