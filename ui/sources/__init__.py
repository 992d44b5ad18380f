"""Where windows get what they show from: files that are read in pieces, so that no window waits for them; no Qt."""
