"""The participant's view and requests, where participants of labs import them; see docs/how-to/your-own-participant.md."""

from thbridge.roles.shared.view import *  # noqa: F403
