"""The warehouse with room for fifty robots."""

import re
import shutil
from pathlib import Path

from thbridge.files.resources import shipped


def hall_for_fifty(folder: Path) -> Path:
    """The warehouse with starts for fifty, in a folder below this one."""
    hall = folder / "warehouse"
    shutil.copytree(shipped().find("maps", "warehouse12", Path()), hall)
    rooms = hall / "rooms.yaml"
    ends = [(2.4, 5.6, 2.0), (2.4, 5.6, 2.9), (2.4, 3.2, 3.8), (9.0, 12.2, 1.9), (9.0, 12.2, 2.9), (9.0, 12.2, 4.6)]
    rows = "".join(f"\n    - [[{first}, {y}], [{last}, {y}]]" for first, last, y in ends)
    text = rooms.read_text().replace("\n  rows:", f"\n  rows:{rows}")
    rooms.write_text(re.sub(r"spacing: .*", "spacing: 0.8", text))
    return hall
