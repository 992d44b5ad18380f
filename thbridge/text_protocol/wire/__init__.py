"""Text protocol of 2016: lines, its messages, the router and the client, and the notices between our own programs."""
