import numpy as np
import pytest

from thbridge.files.errors import BadFile
from thbridge.files.tables.csv_files import MOST_FAULTS, read_columns

POSE = ("x", "y", "yaw")


def read(folder, text):
    path = folder / "poses.csv"
    path.write_bytes(text.encode() if isinstance(text, str) else text)
    return read_columns(path, POSE)


@pytest.mark.parametrize(
    "text",
    [
        "x,y,yaw\n1,2,0.5\n-3,4e-1,0\n",
        "x,y,yaw\r\n1,2,0.5\r\n\r\n-3,4e-1,0",
        "\ufeffx, y, yaw\n 1 , 2,0.5\n-3,.4,0\n",
        '"yaw","x","y"\n0.5,1,2\n0,-3,0.4\n',
        "x;y;yaw\r\n1;2,0;0,5\r\n-3;0,4;0\r\n",
        "\ufeffsep=;\r\nx;y;yaw\r\n1;2;0.5\r\n-3;.4;0\r\n",
        "x\ty\tyaw\n1\t2\t0.5\n-3\t0.4\t0\n",
    ],
)
def test_rows_come_in_the_order_asked_for(tmp_path, text):
    assert np.array_equal(read(tmp_path, text), [[1.0, 2.0, 0.5], [-3.0, 0.4, 0.0]])


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("", "the table has no rows of numbers"),
        ("x,y,yaw\n", "the table has no rows of numbers"),
        ("x,y\n1,2\n", "line 1: the header is 'x,y'. Write x,y,yaw"),
        ("x y yaw\n1 2 3\n", "line 1: the header is 'x y yaw'"),
        ("x;y\n1;2\n", "line 1: the header is 'x,y'. Write x,y,yaw"),
        ("x;y;yaw\n1;2\n", "line 2: 2 values, but the header has 3 names. Write 3 numbers, with the same separators"),
        ("1,2,3\n", "line 1: the header is '1,2,3'"),
        ("x,y,yaw\n1,2\n", "line 2: 2 values, but the header has 3 names"),
        ("x,y,yaw\n1,2,3\n\n1,two,3\n", "line 4, y: 'two' is not a number"),
        ("x,y,yaw\n1,,3\n", "line 2, y: '' is not a number"),
        ("x,y,yaw\n1,nan,3\n", "line 2, y: nan is not a finite number"),
        ('x,y,yaw\n1,"2,3\n', "not CSV"),
        (b"x,y,yaw\n1,\xff,3\n", "line 2: byte 0xff is not UTF-8"),
    ],
)
def test_a_fault_is_told_with_its_line_and_column(tmp_path, text, told):
    with pytest.raises(BadFile) as caught:
        read(tmp_path, text)
    assert told in str(caught.value)
    assert "poses.csv" in str(caught.value)


def test_faults_are_told_together_but_not_for_ever(tmp_path):
    with pytest.raises(BadFile) as caught:
        read(tmp_path, "x,y,yaw\n" + "1,2,?\n" * 100)
    assert len(str(caught.value).splitlines()) == MOST_FAULTS


def test_a_missing_table_is_told(tmp_path):
    with pytest.raises(BadFile, match="there is no such file"):
        read_columns(tmp_path / "none.csv", POSE)
