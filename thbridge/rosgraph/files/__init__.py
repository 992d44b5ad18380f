"""Files of the graph: bags of sessions with real robots."""
