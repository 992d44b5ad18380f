"""Links on the path of an output: only links of this account or of root are followed.

Linux refuses links of other accounts in folders such as /tmp (fs.protected_symlinks). This does not help if a program
resolves the links itself and then writes to the result. The rule of this module applies in every folder.
"""

import os
import stat
from pathlib import Path

from thbridge.files.errors import BadFile, reason_of

MOST_LINKS = 40
"""Maximum number of links on one path, as in Linux."""


def own_target(path: Path) -> Path:
    """Return the path of an output with its links resolved; parts that do not exist yet are unchanged.

    Raises:
        BadFile: a link on the path belongs to another account, there are too many links, or the path contains a NUL
            character.
    """
    trusted = {0, os.geteuid()}
    real, left, links = Path("/"), _reversed_parts(path.absolute()), 0
    while left:
        name = left.pop()
        if name == "..":
            real = real.parent
            continue
        link = real / name
        try:
            found = link.lstat()
            if not stat.S_ISLNK(found.st_mode):
                real = link
                continue
            target = link.readlink()
        except ValueError:
            raise BadFile(path, "the name of a file cannot contain a NUL character", "Check the name") from None
        except OSError as error:
            if isinstance(error, FileNotFoundError | NotADirectoryError | PermissionError):
                real = link  # opening the file will report the error
                continue
            raise BadFile(path, f"it cannot be written ({reason_of(error)})", "Choose another name") from None
        if found.st_uid not in trusted:
            problem = f"the link {link} belongs to another account (user id {found.st_uid})"
            raise BadFile(path, problem, f"If you trust it, name its target: {target}")
        links += 1
        if links > MOST_LINKS:
            raise BadFile(path, "the links of this path lead in a circle", "Choose another name")
        real = Path("/") if target.is_absolute() else real
        left += _reversed_parts(target)
    return real


def _reversed_parts(path: Path) -> list[str]:
    return [*reversed(path.parts[1:] if path.is_absolute() else path.parts)]
