"""What a researcher's window shows of a session or a recording: messages in, values out; no Qt, clock or thread."""
