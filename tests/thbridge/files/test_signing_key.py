"""The file of a signing key."""

import pytest

from thbridge.files.errors import BadFile
from thbridge.files.signing_key import read_signing_key


def test_a_key_is_read(tmp_path):
    (tmp_path / "key").write_bytes(bytes(range(32)))
    assert read_signing_key(tmp_path / "key").secret == bytes(range(32))


def test_a_file_without_a_key_says_what_would_be_one(tmp_path):
    (tmp_path / "key").write_bytes(bytes(7))
    with pytest.raises(BadFile, match=r"neither one line of text nor 32 bytes, but 7 bytes. Put a passphrase"):
        read_signing_key(tmp_path / "key")


def test_a_file_that_is_not_there_is_named(tmp_path):
    with pytest.raises(BadFile, match=r"none: the signing key cannot be read \(No such file"):
        read_signing_key(tmp_path / "none")
