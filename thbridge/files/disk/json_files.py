"""Reading of JSON files that this program wrote, and that people or other programs may have changed since."""

from pathlib import Path
from typing import TypeVar

import msgspec

from thbridge.files.disk.regular_files import content_of
from thbridge.files.errors import BadFile, reason_of

LARGEST_JSON = 1 << 20
"""Largest size of a file, bytes, unless the caller sets another size."""

T = TypeVar("T")


def read_json(path: Path, type_: type[T], damage: str, remedy: str, largest: int = LARGEST_JSON) -> T | None:
    """Return the content of a JSON file, or None if the file does not exist.

    Args:
        path: the file.
        type_: type of the content; msgspec checks the content.
        damage: problem to report for content of another type, as a clause.
        remedy: remedy for every problem, as a clause.
        largest: largest size in bytes.

    Raises:
        BadFile: the path is no file, or the file cannot be read, is too large, or has content of another type.
    """
    try:
        return msgspec.json.decode(content_of(path, largest), type=type_)
    except FileNotFoundError:
        return None
    except OSError as error:
        raise BadFile(path, f"cannot be read ({reason_of(error)})", remedy) from None
    except BadFile as fault:
        raise BadFile(path, fault.problem, remedy) from None
    except (ValueError, RecursionError):
        raise BadFile(path, damage, remedy) from None
