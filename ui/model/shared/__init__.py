"""Modules that several windows share: marks on the map, colors, points, messages of windows, and edited texts."""
