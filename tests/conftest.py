"""What all tests share."""

import os

from hypothesis import settings

# Windows are tested without a screen, unless somebody wants to look on.
os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")

# The first example may have to compile a kernel, and other programs may want the machine: no test is a matter of time.
settings.register_profile("untimed", deadline=None)
settings.load_profile("untimed")
