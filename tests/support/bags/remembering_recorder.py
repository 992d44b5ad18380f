"""Recorder that keeps all records in memory."""


class RememberingRecorder:
    """Recorder that keeps all records in memory."""

    def __init__(self):
        self.records = []

    def record(self, snapshot, records):
        self.records += records
