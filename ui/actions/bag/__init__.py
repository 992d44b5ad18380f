"""What the commands of `thbridge bag` do."""
