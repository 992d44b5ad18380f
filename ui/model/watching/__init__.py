"""View model of the researcher's window for sessions and recordings; it uses no Qt, no clock and no threads."""
