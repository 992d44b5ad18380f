"""Files of the graph: bags of sessions on real robots."""
