"""What all tests share."""

from hypothesis import settings

# The first example may have to compile a kernel, and other programs may want the machine: no test is a matter of time.
settings.register_profile("untimed", deadline=None)
settings.load_profile("untimed")
