"""Who gets which conditions, in which order: Latin squares, blocks dealt by a seed, quotas of valid runs."""
