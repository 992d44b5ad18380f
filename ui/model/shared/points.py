"""Points as text, with the typographer's minus."""


def scored(score: int) -> str:
    """Return a score: `20`, `−20`."""
    return f"{score}".replace("-", "−")


def gained(points: int) -> str:
    """Return points won or lost: `+20`, `−20`."""
    return f"{points:+d}".replace("-", "−")
