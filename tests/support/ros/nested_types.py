"""Message types within each other."""

PART = "=" * 80 + "\nMSG: "


def nested(deepest: int, fields: str = "T{0} a\nT{0} b\n") -> str:
    """A type T0 with two T1, each with two T2, and so on."""
    parts = [fields.format(index) for index in range(1, deepest + 1)] + ["int8 a\n"]
    return parts[0] + "".join(f"{PART}a/T{index}\n{text}" for index, text in enumerate(parts[1:], 1))
