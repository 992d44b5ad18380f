"""Decodes the topic that tells of robots a person speaks for."""

import msgspec

from thbridge.ros.messages import unpack
from ui.model.watching.scene import Wizard


def wizard(data: bytes) -> Wizard:
    """Decode a std_msgs/String of the topic `names.WIZARD`: JSON of the form of `Wizard`.

    Raises:
        ValueError: it is not.
    """
    try:
        return msgspec.json.decode(unpack.string(data).encode(), type=Wizard)
    except msgspec.DecodeError as error:
        raise ValueError(str(error)) from None
