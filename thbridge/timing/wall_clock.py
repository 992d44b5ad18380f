"""Time of day, for records that people read."""

from datetime import UTC, datetime


def utc_now() -> str:
    """Return the current time in ISO 8601, to the second, such as "2026-11-23T09:30:00Z"."""
    return datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%SZ")
