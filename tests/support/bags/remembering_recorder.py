"""A recorder that remembers."""


class RememberingRecorder:
    """A recorder that remembers."""

    def __init__(self):
        self.records = []

    def record(self, snapshot, records):
        self.records += records
