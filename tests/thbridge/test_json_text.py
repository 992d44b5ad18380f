import pytest

from thbridge.json_text import json_of


@pytest.mark.parametrize("text", ["[" * 100_000, '{"a":' * 100_000, "", "nothing", b"\xff"])
def test_what_is_no_json_is_a_value_error(text: str) -> None:
    with pytest.raises(ValueError):
        json_of(text)


def test_json_is_read() -> None:
    assert json_of('{"a": [1, "b"]}') == {"a": [1, "b"]}
