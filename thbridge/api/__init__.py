"""Public interface: the names here and in `thbridge.api.learning`. See docs/reference/api.md."""

from thbridge.api.errors import HuntError as HuntError
from thbridge.api.errors import HuntWarning as HuntWarning
from thbridge.api.participant import HuntParticipant as HuntParticipant
from thbridge.api.recording import HuntRecording as HuntRecording
from thbridge.api.recording import HuntReplay as HuntReplay
from thbridge.api.session import HuntEvent as HuntEvent
from thbridge.api.session import HuntSession as HuntSession
from thbridge.api.snapshot import HuntSnapshot as HuntSnapshot
from thbridge.api.study import HuntStudy as HuntStudy
from thbridge.api.view import HuntAgreement as HuntAgreement
from thbridge.api.view import HuntDialogue as HuntDialogue
from thbridge.api.view import HuntObjection as HuntObjection
from thbridge.api.view import HuntView as HuntView
from thbridge.api.view import HuntVote as HuntVote
