"""Certificate by which a session shows clients who it is: made on first use, or the lab's own."""

import datetime
import hashlib
import ssl
from dataclasses import dataclass
from pathlib import Path

from thbridge.files.errors import BadFile, reason_of
from thbridge.files.keys.private_file import check_private
from thbridge.files.regular_files import content_of
from thbridge.files.whole import whole_file

CERTIFICATE = "certificate.pem"
"""File of the certificate in the folder of keys; a lab's own may be followed by those of its authorities."""
PRIVATE_KEY = "private.pem"
"""File of the certificate's private key."""

_YEARS = 20
"""Years that a certificate of ours is valid. Nobody looks: clients know it by its fingerprint."""
_END = b"-----END CERTIFICATE-----"
_LARGEST = 1 << 20


@dataclass(frozen=True, slots=True)
class Certificate:
    """A certificate and its private key.

    Attributes:
        path: of the certificate.
        private_key: path of its private key.
        fingerprint: SHA-256 of the certificate, hexadecimal.
    """

    path: Path
    private_key: Path
    fingerprint: str


def certificate_of(folder: Path, now: str) -> Certificate:
    """Return the certificate in a folder of keys; one is made where there is none.

    Args:
        folder: of the keys; made where it is missing.
        now: time of day, UTC, such as 2026-03-01T12:00:00Z: the beginning of a new certificate's validity.

    Raises:
        BadFile: it cannot be read or written, it is damaged, or others may read its private key.
    """
    path, private_key = folder / CERTIFICATE, folder / PRIVATE_KEY
    if not path.exists() and not private_key.exists():
        _make(path, private_key, now)
    check_private(private_key)
    try:
        der = ssl.PEM_cert_to_DER_cert(_first(content_of(path, _LARGEST)))
        ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER).load_cert_chain(path, private_key, password="")
    except ssl.SSLError as error:
        problem = f"certificate and private key are of no use ({error.reason or error})"
        remedy = f"copy both again, the key as {private_key}; or remove both, and a new certificate is made"
        raise BadFile(path, problem, remedy) from None
    except ValueError:
        problem = "this is no certificate in PEM"
        raise BadFile(path, problem, "copy it again; or remove it with its private key") from None
    except OSError as error:
        remedy = f"put a certificate there, and its private key as {private_key}; or remove both"
        raise BadFile(path, f"it cannot be read, or its private key ({reason_of(error)})", remedy) from None
    return Certificate(path, private_key, hashlib.sha256(der).hexdigest())


def _first(content: bytes) -> str:
    """Return the first certificate of a file. Raises ValueError."""
    before, end, _ = content.partition(_END)
    begin = before.find(b"-----BEGIN CERTIFICATE-----")
    if not end or begin < 0:
        raise ValueError("no certificate")
    return (before[begin:] + end + b"\n").decode("ascii")


def _make(path: Path, private_key: Path, now: str) -> None:
    # It takes a moment to load, and is needed once.
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
    remedy = "choose another folder"
    try:
        with whole_file(private_key, remedy, exclusive=True, folders=True, mode=0o600) as file:
            file.write(secret)
        with whole_file(path, remedy, exclusive=True, mode=0o600) as file:
            file.write(certificate.public_bytes(serialization.Encoding.PEM))
    except FileExistsError:
        raise BadFile(path, "another program is making one just now", "try again in a moment") from None
