"""HTML page that plays a recording: styles, script and data are in the file, which loads nothing else."""

import base64
import hashlib
import json
import zlib
from collections.abc import Iterator
from pathlib import Path

import msgspec
from jinja2 import Environment, StrictUndefined
from markupsafe import Markup

from sim.common.grid import OccupancyGrid
from thbridge.analysis.report.builder import ReportBuilder, gather_games
from thbridge.analysis.report.report import Report
from thbridge.analysis.report.tracks import FOUND_BY_NAME, TrajectoryTopics
from thbridge.dialogue.wording.texts import Texts
from thbridge.files.errors import BadFile
from thbridge.files.language_texts import ENGLISH, shipped_languages, shipped_texts
from thbridge.files.progress import Tell, followed, untold
from thbridge.recording.bag.reading.reader import info, messages
from thbridge.ros.messages.session_records import SessionRecord
from thbridge.study.study_file import Study, read_study_text
from ui.sources.rooms import rooms_of
from ui.web.page.theme_css import THEME_CSS
from ui.web.player.bundle import bundle
from ui.web.player.content import PlayedGame, PlayedRecording
from ui.web.player.gathering import GameContext, bare_floor, floor_of, obstacles_of, played_game

_STATIC = Path(__file__).with_name("static")
_MAP_CSS = Path(__file__).parents[1] / "static" / "map.css"
_PREFIX = "player."


def build_player(
    bag: Path,
    grid: OccupancyGrid | None = None,
    tell: Tell = untold,
    named: TrajectoryTopics = FOUND_BY_NAME,
    language: str | None = None,
) -> str:
    """Return the page that plays a recording; the same bag gives the same page.

    Args:
        bag: bag of thbridge or of other robots.
        grid: map to use instead of the bag's own.
        `tell`: receives the progress.
        named: topics of a robot's trajectories, if the user named them.
        language: language of the page. If None, it is the language of the study, or English if the study's language
            is not built in.

    Raises:
        BadFile: the bag cannot be read, or there is no such language.
    """
    builders = gather_games(followed(messages(bag), "messages", info(bag).messages, tell), named)
    first = builders[0].report(grid)
    study = None if first.session is None else _study_of(first.session, bag)
    texts = _texts(language, study)
    context = GameContext(study, texts)
    rooms = () if first.session is None else rooms_of(first.session, bag)
    shown = study or Study()
    floor = bare_floor(first, shown) if first.grid is None else floor_of(first.grid, rooms, first.rooms, shown)
    recording = PlayedRecording(
        language=texts.language,
        words=words_of(texts),
        floor=floor,
        obstacles=obstacles_of(first),
        games=tuple(_games(first, builders, grid, context, tell)),
    )
    return page_of(recording, bag.name, "" if first.session is None else first.session.study)


def page_of(recording: PlayedRecording, name: str, study: str) -> str:
    """Return the page of a recording.

    Args:
        recording: content of the page.
        name: name of the bag.
        study: text of the study file; empty if it is unknown.
    """
    environment = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    template = environment.from_string((_STATIC / "player.html").read_text(encoding="utf-8"))
    style = THEME_CSS + "".join(path.read_text(encoding="utf-8") for path in (_MAP_CSS, _STATIC / "player.css"))
    script = bundle(_STATIC / "player.js")
    # Not msgspec's encoder: it refuses lone surrogates, which recorded names may contain.
    content = json.dumps(msgspec.to_builtins(recording), separators=(",", ":"))
    packed = base64.b64encode(zlib.compress(content.encode("ascii"), 9)).decode("ascii")
    return template.render(
        language=recording.language,
        words=recording.words,
        name=name,
        study=study,
        games=recording.games,
        policy=(
            f"default-src 'none'; script-src {_hash(script)}; style-src {_hash(style)}; base-uri 'none'; "
            "form-action 'none'; require-trusted-types-for 'script'; trusted-types 'none'"
        ),
        # Safe: all three are our own files, or letters and digits.
        style=Markup(style),
        script=Markup(script),
        data=Markup(packed),
    )


def words_of(texts: Texts) -> dict[str, str]:
    """Return the words of the page in a language, by their names in `player.yaml`; without texts for numbers."""
    return {
        key.removeprefix(_PREFIX): text
        for key, text in texts.entries.items()
        if key.startswith(_PREFIX) and isinstance(text, str)
    }


def _games(
    first: Report, builders: list[ReportBuilder], grid: OccupancyGrid | None, context: GameContext, tell: Tell
) -> Iterator[PlayedGame]:
    """Yield the content of each game; only one report at a time is in memory."""
    count = len(builders)
    for done in range(count):
        tell("games", done, count)
        builder = builders.pop(0)
        yield played_game(first if done == 0 else builder.report(grid), context, count > 1)
    tell("games", count, count)


def _study_of(session: SessionRecord, bag: Path) -> Study | None:
    """Return the study of a session; None if this version cannot read it."""
    try:
        return read_study_text(bag, session.study)
    except BadFile:
        return None


def _texts(language: str | None, study: Study | None) -> Texts:
    if language is None:
        wanted = ENGLISH if study is None else study.dialogue.language
        return shipped_texts(wanted if wanted in shipped_languages() else ENGLISH)
    return shipped_texts(language)


def _hash(text: str) -> str:
    """Return the source of a content security policy that allows exactly this script or style sheet."""
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode('ascii')}'"
