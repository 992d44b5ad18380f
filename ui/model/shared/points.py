"""Numbers of points as text, with a typographic minus sign."""


def scored(score: int) -> str:
    """Return a score: `20`, `−20`."""
    return f"{score}".replace("-", "−")


def gained(points: int) -> str:
    """Return points won or lost: `+20`, `−20`."""
    return f"{points:+d}".replace("-", "−")
