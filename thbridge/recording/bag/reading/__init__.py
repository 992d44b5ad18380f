"""Reading of recordings: messages in order, random access by topic and time, and the rest of damaged recordings."""
