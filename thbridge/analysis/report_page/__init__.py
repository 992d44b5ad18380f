"""HTML page of a report, with embedded figures."""
