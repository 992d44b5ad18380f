"""Colors of the page as a style sheet, from the same palettes as the Qt windows."""

from dataclasses import fields

from ui.model.shared.theme import DARK, LIGHT, Palette


def _colors(palette: Palette) -> str:
    named = {field.name: getattr(palette, field.name) for field in fields(palette) if field.name != "robots"}
    named |= {f"robot{index}": color for index, color in enumerate(palette.robots)}
    return "".join(f"--{name.replace('_', '-')}:{color};" for name, color in named.items())


THEME_CSS = (
    f":root{{color-scheme:light;{_colors(LIGHT)}}}\n"
    f"@media (prefers-color-scheme:dark){{:root:not([data-look=light]){{color-scheme:dark;{_colors(DARK)}}}}}\n"
    f":root[data-look=dark]{{color-scheme:dark;{_colors(DARK)}}}\n"
)
"""The style sheet: the person's choice, otherwise the choice of their system."""
