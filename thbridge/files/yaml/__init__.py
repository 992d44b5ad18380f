"""YAML files that people write: read into dataclasses with all faults and their lines, and edited in place."""
