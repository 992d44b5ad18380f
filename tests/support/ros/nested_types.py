"""Message types that contain each other."""

PART = "=" * 80 + "\nMSG: "


def nested(deepest: int, fields: str = "T{0} a\nT{0} b\n") -> str:
    """Return the definition of a type T0 with two fields of type T1, each with two fields of type T2, and so on."""
    parts = [fields.format(index) for index in range(1, deepest + 1)] + ["int8 a\n"]
    return parts[0] + "".join(f"{PART}a/T{index}\n{text}" for index, text in enumerate(parts[1:], 1))
