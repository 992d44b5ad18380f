"""One robot's own software, from sensor messages to motor commands; it never sees the truth."""
