"""Certificate by which clients identify a session. The certificate is created on first use, or supplied by the lab."""

import datetime
import hashlib
import ssl
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from thbridge.files.disk.regular_files import content_of
from thbridge.files.disk.whole import whole_file
from thbridge.files.errors import BadFile, reason_of
from thbridge.files.keys.private_file import check_private

CERTIFICATE = "certificate.pem"
"""File of the certificate and its private key, in the folder of keys. A lab's own file may also contain the
certificates of its authorities."""

_YEARS = 20
"""Years for which our certificates are valid. Clients do not check this, but only the fingerprint."""
_END = b"-----END CERTIFICATE-----"
_LARGEST = 1 << 20


@dataclass(frozen=True, slots=True)
class Certificate:
    """A certificate with its private key.

    Attributes:
        path: path of the file with both.
        fingerprint: SHA-256 of the certificate, hexadecimal.
    """

    path: Path
    fingerprint: str


def certificate_of(folder: Path, now: str) -> Certificate:
    """Return the certificate in a folder of keys. Create a certificate if there is none.

    Args:
        folder: folder of the keys; created if missing.
        now: date and time, UTC, such as 2026-03-01T12:00:00Z, at which a new certificate becomes valid.

    Raises:
        BadFile: the file cannot be read or written, or is damaged; or other accounts may read its private key.
    """
    path = folder / CERTIFICATE
    if not path.exists():
        _make(path, now)
    check_private(path)
    try:
        der = ssl.PEM_cert_to_DER_cert(_first(content_of(path, _LARGEST)))
        ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER).load_cert_chain(path, password="")
    except ssl.SSLError as error:
        problem = f"certificate and private key are not usable ({error.reason or error})"
        raise BadFile(path, problem, "copy both into this file again; or delete the file to get a new one") from None
    except ValueError:
        remedy = "copy certificate and private key into this file again"
        raise BadFile(path, "the file has no certificate in PEM format", remedy) from None
    except OSError as error:
        remedy = "put a certificate with its private key here; or delete the file to get a new one"
        raise BadFile(path, f"it cannot be read ({reason_of(error)})", remedy) from None
    return Certificate(path, hashlib.sha256(der).hexdigest())


def _first(content: bytes) -> str:
    """Return the first certificate of a file. Raises ValueError."""
    before, end, _ = content.partition(_END)
    begin = before.find(b"-----BEGIN CERTIFICATE-----")
    if not end or begin < 0:
        raise ValueError("no certificate")
    return (before[begin:] + end + b"\n").decode("ascii")


def _make(path: Path, now: str) -> None:
    # This library loads slowly and is only needed once, so it is imported here.
    from cryptography import x509  # noqa: PLC0415
    from cryptography.hazmat.primitives import hashes, serialization  # noqa: PLC0415
    from cryptography.hazmat.primitives.asymmetric import ec  # noqa: PLC0415

    begin = datetime.datetime.fromisoformat(now)
    key = ec.generate_private_key(ec.SECP256R1())
    name = x509.Name([x509.NameAttribute(x509.NameOID.COMMON_NAME, "thbridge")])
    certificate = (
        x509.CertificateBuilder()
        .subject_name(name)
        .issuer_name(name)
        .public_key(key.public_key())
        .serial_number(x509.random_serial_number())
        .not_valid_before(begin - datetime.timedelta(days=1))
        .not_valid_after(begin + datetime.timedelta(days=365 * _YEARS))
        .add_extension(x509.BasicConstraints(ca=False, path_length=None), critical=True)
        .sign(key, hashes.SHA256())
    )
    secret = key.private_bytes(
        serialization.Encoding.PEM, serialization.PrivateFormat.PKCS8, serialization.NoEncryption()
    )
    # If another program is creating a certificate now, that certificate stays: keys may already have its fingerprint.
    with (
        suppress(FileExistsError),
        whole_file(path, "choose another folder", exclusive=True, folders=True, mode=0o600) as file,
    ):
        file.write(secret + certificate.public_bytes(serialization.Encoding.PEM))
