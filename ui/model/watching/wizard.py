"""What a session tells of robots that a person speaks for."""

import msgspec

from thbridge.ros.messages import unpack
from ui.model.watching.scene import Wizard


def wizard(data: bytes) -> Wizard:
    """Of a std_msgs/String on the topic `names.WIZARD`: JSON of the same form.

    Raises:
        ValueError: it tells none.
    """
    try:
        return msgspec.json.decode(unpack.string(data).encode(), type=Wizard)
    except msgspec.DecodeError as error:
        raise ValueError(str(error)) from None
