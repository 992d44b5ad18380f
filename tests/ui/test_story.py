"""A hunt told in sentences."""

from tests.thbridge.roles.test_command import TAKE, Play
from thbridge.roles.robot_requests import ReleaseCommand
from ui.story import tell


def test_who_commands_a_robot_is_told() -> None:
    play = Play()
    play.ask(TAKE)
    play.stage.puppets.researchers = ("/rviz", None)
    play.stage.run(60)
    play.stage.puppets.researchers = (None, None)
    play.stage.run(60)
    play.ask(ReleaseCommand(0))
    sentences = [sentence.split("s  ", 1)[1] for tick in play.stage.tick_records for sentence in tell(tick)]
    assert [sentence for sentence in sentences if "commanded" in sentence] == [
        "Robot 1 is commanded by ground station 255 from now on.",
        "Robot 1 is commanded by /rviz from now on.",
        "Robot 1 is commanded by ground station 255 from now on.",
        "Robot 1 is commanded by the participant from now on.",
    ]
