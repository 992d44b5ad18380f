"""Text protocol of 2016: lines, messages, router and client, and the notices between our own programs."""
