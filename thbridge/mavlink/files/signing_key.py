"""The file with the key for signing MAVLink frames."""

from pathlib import Path

from thbridge.files.disk.regular_files import open_regular
from thbridge.files.errors import BadFile, reason_of
from thbridge.files.keys.private_file import check_private
from thbridge.mavlink.wire.frames.signing import InvalidKey, SigningKey, parse_key

_REMEDY = "put a passphrase, 32 bytes or 64 hexadecimal digits in this file"
_LARGEST = 4096


def read_signing_key(path: Path) -> SigningKey:
    """Read the key in a file. See `parse_key` for its formats.

    Raises:
        BadFile: the file cannot be read, other accounts may read it, or it contains no key.
    """
    # A key is as safe as its file, so a file that other accounts may read is refused.
    check_private(path)
    try:
        with open_regular(path) as file:
            content = file.read(_LARGEST)
    except OSError as error:
        raise BadFile(path, f"the signing key cannot be read ({reason_of(error)})", _REMEDY) from None
    key = parse_key(content)
    if isinstance(key, InvalidKey):
        raise BadFile(path, f"this file contains no signing key: {key.problem}", _REMEDY)
    return key
