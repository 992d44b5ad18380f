"""The file of a signing key."""

import pytest

from thbridge.files.errors import BadFile
from thbridge.files.keys import private_file
from thbridge.mavlink.files.signing_key import read_signing_key


@pytest.fixture
def key(tmp_path):
    path = tmp_path / "my key"
    path.write_bytes(bytes(range(32)))
    path.chmod(0o600)
    return path


def test_a_key_is_read(key):
    assert read_signing_key(key).secret == bytes(range(32))
    key.chmod(0o400)
    assert read_signing_key(key).secret == bytes(range(32))


@pytest.mark.parametrize("mode", [0o640, 0o604, 0o622, 0o610])
def test_a_key_that_other_accounts_may_read_or_write_is_refused_with_the_remedy(key, mode):
    key.chmod(mode)
    with pytest.raises(BadFile, match=rf"its mode is {mode:o}\). Run: chmod 600 '{key}'"):
        read_signing_key(key)


def test_where_files_have_no_modes_nothing_is_refused(key, monkeypatch):
    key.chmod(0o755)
    # As every file on FAT is, new ones too.
    monkeypatch.setattr(private_file.tempfile, "TemporaryFile", lambda **_given: key.open("rb"))
    assert read_signing_key(key).secret == bytes(range(32))


def test_a_file_without_a_key_says_what_would_be_one(key):
    key.write_bytes(bytes(7))
    with pytest.raises(BadFile, match=r"neither one line of text nor 32 bytes, but 7 bytes. Put a passphrase"):
        read_signing_key(key)


def test_a_file_that_is_not_there_is_named(tmp_path):
    with pytest.raises(BadFile, match=r"none: the signing key cannot be read \(No such file"):
        read_signing_key(tmp_path / "none")
