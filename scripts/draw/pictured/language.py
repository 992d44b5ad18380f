"""Language of all pictures that are drawn in one run."""

from dataclasses import replace

from thbridge.dialogue.wording.texts import Texts
from thbridge.files.language_texts import ENGLISH, shipped_texts
from thbridge.study.study_file import Study


class _Spoken:
    language = ENGLISH


def speak(language: str) -> None:
    """Set the language of all pictures; the language must come with the project."""
    _Spoken.language = language


def texts() -> Texts:
    """Return the texts of the language."""
    return shipped_texts(_Spoken.language)


def spoken(study: Study) -> Study:
    """Return a study in the language."""
    return replace(study, dialogue=replace(study.dialogue, language=_Spoken.language))
