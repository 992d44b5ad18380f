"""View and requests, for simulated participants that a lab installs; see docs/how-to/your-own-participant.md."""

from thbridge.roles.shared.view import *  # noqa: F403
