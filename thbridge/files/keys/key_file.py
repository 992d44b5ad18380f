"""File with one key for a person: the secret, and the fingerprint of the session."""

import re
from dataclasses import dataclass
from pathlib import Path

from thbridge.files.disk.text_files import read_text
from thbridge.files.errors import BadFile
from thbridge.files.keys.private_file import check_private

_FINGERPRINT = re.compile(r"sha256:([0-9a-f]{64})")


@dataclass(frozen=True, slots=True)
class ClientKey:
    """Key of a client.

    Attributes:
        secret: secret that the client presents.
        fingerprint: SHA-256 of the session's certificate, hexadecimal. If None, a public certificate authority must
            have signed the certificate.
    """

    secret: str
    fingerprint: str | None = None

    def __repr__(self) -> str:
        return "ClientKey(...)"  # This text may be logged.


def key_text(secret: str, fingerprint: str) -> str:
    """Return the text of a key file."""
    return f"{secret}\nsha256:{fingerprint}\n"


def read_key(path: Path) -> ClientKey:
    """Read a file with a key: the secret in the first line, and a fingerprint in the second line, which may be missing.

    Raises:
        BadFile: the file cannot be read or has no key, or other accounts may read it.
    """
    check_private(path)
    lines = [line.strip() for line in read_text(path).splitlines()]
    if not lines or not lines[0]:
        raise BadFile(path, "there is no key in this line", "write a key of random letters into this line", line=1)
    if len(lines) < 2 or not lines[1]:
        return ClientKey(lines[0])
    found = _FINGERPRINT.fullmatch(lines[1].lower())
    if found is None:
        remedy = "write sha256: and 64 hexadecimal digits, or nothing"
        raise BadFile(path, "this line is not a fingerprint of a certificate", remedy, line=2)
    return ClientKey(lines[0], found[1])
