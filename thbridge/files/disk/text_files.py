"""Reading of text files that people write."""

import codecs
import unicodedata
from pathlib import Path

from thbridge.files.disk.regular_files import as_on_disk, content_of
from thbridge.files.errors import BadFile

LARGEST_FILE = 1 << 20
"""Largest size of a file, bytes. Files written by people have a few thousand bytes."""


_UNDEFINED_IN_WINDOWS = frozenset(b"\x81\x8d\x8f\x90\x9d")
_NAMES_OF_ICONV = {"Windows-1252": "WINDOWS-1252", "Latin-1": "ISO-8859-1"}


def read_text(path: Path, largest: int = LARGEST_FILE) -> str:
    """Read the text of a file that people write.

    The text is composed (NFC), so that names are equal even if they were typed differently.

    Raises:
        BadFile: the file does not exist, is larger than `largest` bytes, or is not UTF-8; or the path is no file.
    """
    return unicodedata.normalize("NFC", text_of(path, read_bytes(path, largest)))


def read_bytes(path: Path, largest: int = LARGEST_FILE) -> bytes:
    """Read the bytes of a file that people write.

    Raises:
        BadFile: the file does not exist, or is larger than `largest` bytes; or the path is no file.
    """
    try:
        return content_of(as_on_disk(path), largest)
    except FileNotFoundError:
        raise BadFile(path, "there is no such file", "Check the name and the folder") from None
    except OSError as error:
        raise BadFile(path, f"it cannot be read ({error.strerror})", "Check that it is a file") from None


def text_of(path: Path, data: bytes) -> str:
    """Return the text of a file's bytes, without a byte order mark.

    Raises:
        BadFile: the bytes are not UTF-8; the message names the probable encoding.
    """
    utf16 = _utf16_of(data)
    if b"\0" in data and not utf16:
        line = data.count(b"\n", 0, data.index(b"\0")) + 1
        remedy = "Check that it is a text file, and delete the byte"
        raise BadFile(path, "the file contains a NUL byte", remedy, line=line)
    try:
        if utf16:
            raise UnicodeDecodeError("utf-8", data, 0, 1, utf16)
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        encoding = utf16 or _byte_encoding_of(data)
        problem = f"byte 0x{data[error.start]:02x} is not UTF-8; the file was probably saved as {encoding}"
        if utf16 and data[0] < 0x80:
            problem = f"the text is not UTF-8; it was probably saved as {encoding}"
        remedy = "Save the file with the encoding UTF-8 in an editor"
        if encoding != _UNKNOWN:
            iconv = _NAMES_OF_ICONV.get(encoding, encoding)
            remedy += f", or run: iconv -f {iconv} -t UTF-8 {path.name} > {path.name}.utf8"
        raise BadFile(path, problem, remedy, line=line) from None


_UNKNOWN = "an encoding of another system"


def _utf16_of(data: bytes) -> str:
    """Return the probable kind of UTF-16, by the byte order mark or by zeros at every second byte; empty if none."""
    if data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return "UTF-16"
    for name, zeros, letters in (("UTF-16LE", data[1::2], data[::2]), ("UTF-16BE", data[::2], data[1::2])):
        if len(zeros) > 1 and zeros.count(0) > 0.8 * len(zeros) and not letters.count(0):
            return name
    return ""


def _byte_encoding_of(data: bytes) -> str:
    """Return the probable encoding with one byte per character. Latin-1 has no characters from 0x80 to 0x9f."""
    controls = {byte for byte in data if 0x80 <= byte < 0xA0}
    return _UNKNOWN if controls & _UNDEFINED_IN_WINDOWS else "Windows-1252" if controls else "Latin-1"
