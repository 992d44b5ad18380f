"""Language of all pictures that are drawn in one run."""

from dataclasses import replace

from thbridge.dialogue.wording.texts import Texts
from thbridge.files.language_texts import ENGLISH, shipped_texts
from thbridge.study.study_file import Study


class _Spoken:
    language = ENGLISH
    in_browser = False


def speak(language: str, *, in_browser: bool = False) -> None:
    """Set the language of all pictures; the language must come with the project."""
    _Spoken.language, _Spoken.in_browser = language, in_browser


def texts() -> Texts:
    """Return the texts of the language, for a browser or for a window."""
    texts = shipped_texts(_Spoken.language)
    return texts.in_browser() if _Spoken.in_browser else texts


def spoken(study: Study) -> Study:
    """Return a study in the language."""
    return replace(study, dialogue=replace(study.dialogue, language=_Spoken.language))
