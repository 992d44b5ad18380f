"""View and requests, for simulated participants of labs; see docs/how-to/your-own-participant.md."""

from thbridge.roles.shared.view import *  # noqa: F403
