"""What the commands of `thbridge maps` do."""
