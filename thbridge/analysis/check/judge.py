"""Application of all rules to the records of a bag."""

from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass

from thbridge.analysis.check import connections, contents, frames, structure, times
from thbridge.analysis.check.finding import (
    BagStructure,
    BagTool,
    CheckedMessage,
    Finding,
    FindingSeverity,
    MessageRule,
    ScannedChunk,
)
from thbridge.analysis.check.reading import MessageReader, Reading, UnreadableMessage
from thbridge.recording.bag.reading.scan import (
    BagHeaderRecord,
    BagRecord,
    ChunkInfoRecord,
    ChunkRecord,
    ConnectionRecord,
    IndexDataRecord,
    MessageRecord,
    UnreadableSpan,
)
from thbridge.ros.messages.identification import by_name, identified

_ORDER = tuple(FindingSeverity)


@dataclass(frozen=True, slots=True)
class Judgement:
    """Result of a check.

    Attributes:
        findings: findings, most severe first.
        messages: number of messages read.
        seconds: time from the first message to the last.
        start_ns: stamp of the first message; None if there is none.
    """

    findings: tuple[Finding, ...]
    messages: int
    seconds: float
    start_ns: int | None

    def worst(self, tool: BagTool) -> FindingSeverity | None:
        """Return the worst severity for a tool; None without findings."""
        mine = {finding.severity for finding in self.findings if tool in finding.tools}
        return next((severity for severity in _ORDER if severity in mine), None)

    @property
    def ok(self) -> bool:
        """True if there is no finding of severity error."""
        return all(finding.severity is not FindingSeverity.ERROR for finding in self.findings)


def judge(records: Iterable[BagRecord]) -> Judgement:
    """Check a bag, given by its records (see `scan`)."""
    reader = _BagReader()
    for record in records:
        reader.take(record)
    bag = reader.structure()
    findings = [finding for rule in (*structure.RULES, *connections.RULES) for finding in rule(bag)]
    for message_rule in reader.rules:
        findings.extend(message_rule.findings(bag))
    findings.sort(key=lambda finding: (_ORDER.index(finding.severity), finding.topic or "", finding.rule))
    return Judgement(tuple(findings), sum(bag.counts.values()), bag.seconds, bag.start_ns)


class _ConnectionReader:
    """Reader of one connection, which decodes its messages and passes them to the rules."""

    def __init__(self, source: ConnectionRecord, rules: Iterable[MessageRule]) -> None:
        self._handlers = [handle for rule in rules if (handle := rule.listen(source)) is not None]
        self._source = source
        self._begun = False
        self._layout: MessageReader | None = None

    def _begin(self, data: bytes) -> None:
        """Choose a layout for all messages, based on the first message."""
        self._begun = True
        kind = self._source.msgtype
        found = identified(kind, self._source.md5, self._source.definition) or by_name(kind, data)
        if found is not None:
            with suppress(ValueError):  # the rule `definition_missing` reports it
                self._layout = MessageReader(kind, found.definition, contents.numbers_of(kind))

    def handle(self, record: MessageRecord) -> None:
        if not self._begun:
            self._begin(record.data)
        try:
            reading = Reading() if self._layout is None else self._layout.read(record.data)
            message = CheckedMessage(record.stamp_ns, reading)
        except UnreadableMessage as fault:
            message = CheckedMessage(record.stamp_ns, Reading(), str(fault))
        for handle in self._handlers:
            handle(message)


class _BagReader:
    """Collector of a bag's structure from its records. It also passes messages to the rules."""

    def __init__(self) -> None:
        rules = (*times.RULES, *frames.RULES, *contents.RULES)
        self.rules: tuple[MessageRule, ...] = tuple(rule() for rule in rules)
        self._header: BagHeaderRecord | None = None
        self._sources: dict[int, ConnectionRecord] = {}
        self._readers: dict[int, _ConnectionReader] = {}
        self._counts: dict[int, int] = {}
        self._chunks: list[ScannedChunk] = []
        self._index: list[ChunkInfoRecord] = []
        self._indexed_sources: set[int] = set()
        self._tears: list[UnreadableSpan] = []

    def take(self, record: BagRecord) -> None:
        """Add the next record of the file."""
        match record:
            case MessageRecord():
                self._take_message(record)
            case IndexDataRecord(number, count):
                self._indexed_sources.clear()
                if self._chunks:
                    indexed = self._chunks[-1].indexed
                    indexed[number] = indexed.get(number, 0) + count
            case ConnectionRecord(number):
                if number not in self._sources:
                    self._sources[number] = record
                    self._readers[number] = _ConnectionReader(record, self.rules)
                # Connection records after the last chunk and its index data belong to the index at the end of the file.
                self._indexed_sources.add(number)
            case ChunkRecord():
                self._chunks.append(ScannedChunk(record, {}, {}))
                self._indexed_sources.clear()
            case ChunkInfoRecord():
                self._index.append(record)
            case BagHeaderRecord():
                self._header = record
            case UnreadableSpan():
                self._tears.append(record)

    def _take_message(self, record: MessageRecord) -> None:
        self._counts[record.number] = self._counts.get(record.number, 0) + 1
        if self._chunks:
            known = self._chunks[-1]
            known.counts[record.number] = known.counts.get(record.number, 0) + 1
            if known.start_ns is None or record.stamp_ns < known.start_ns:
                known.start_ns = record.stamp_ns
            if known.end_ns is None or record.stamp_ns > known.end_ns:
                known.end_ns = record.stamp_ns
        reader = self._readers.get(record.number)
        if reader is not None:
            reader.handle(record)

    def structure(self) -> BagStructure:
        """Return the structure, after the last record."""
        starts = [known.start_ns for known in self._chunks if known.start_ns is not None]
        ends = [known.end_ns for known in self._chunks if known.end_ns is not None]
        return BagStructure(
            self._header,
            self._sources,
            self._counts,
            tuple(self._chunks),
            tuple(self._index),
            len(self._indexed_sources),
            tuple(self._tears),
            min(starts, default=None),
            max(ends, default=None),
        )
