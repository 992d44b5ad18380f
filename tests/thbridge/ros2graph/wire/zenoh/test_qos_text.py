"""Quality of service in liveliness keys, written and read as by rmw_zenoh."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from thbridge.ros2.qos import LATCHED, ROSOUT, SENSOR_DATA, DeliveryReliability, Durability, QosProfile
from thbridge.ros2graph.wire.zenoh.qos_text import read_qos, write_qos

profiles = st.builds(
    QosProfile,
    st.integers(1, 9_999_999_999),
    st.sampled_from(DeliveryReliability),
    st.sampled_from(Durability),
    st.none() | st.integers(0, 9_223_372_035_000_000_000),
)


@pytest.mark.parametrize(
    ("qos", "text"),
    [
        (QosProfile(), "::,10:,:,:,,"),
        (QosProfile(42), "::,:,:,:,,"),  # rmw_zenoh's own default has a depth of 42.
        (SENSOR_DATA, "2::,5:,:,:,,"),
        (LATCHED, ":1:,1:,:,:,,"),
        (ROSOUT, ":1:,1000:,:10,0:,,"),
    ],
)
def test_texts_of_rmw_zenoh(qos, text):
    assert write_qos(qos) == text
    assert read_qos(text) == qos


def test_defaults_may_be_written_in_full():
    assert read_qos("1:2:1,10:1,0:9223372036,854775807:1,2,3") == QosProfile()


@given(profiles)
def test_a_written_quality_is_read_again(qos):
    assert read_qos(write_qos(qos)) == qos


@pytest.mark.parametrize(
    "text", ["", ":::::", "3::,10:,:,:,,", "::,-1:,:,:,,", "::,10:,:,:,,\n", "::,10:,:,:,,:", "::,٣:,:,:,,"]
)
def test_other_texts_are_invalid(text):
    assert read_qos(text) is None


@given(st.text(":,0123456789", max_size=60))
def test_reading_never_raises(text):
    read_qos(text)
