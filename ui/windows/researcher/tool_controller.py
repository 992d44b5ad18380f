"""Researcher's requests to robots, by buttons, by strokes on the map, and by the wizard's dock."""

import math
from collections.abc import Callable, Mapping
from functools import partial

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QMessageBox

from sim.common.geometry import Pose2
from sim.common.robot_numbers import robot_name
from sim.numerics.float_array import FloatArray
from thbridge.hunt.refusals import RequestRefused
from ui.model.watching.scene import PendingTurn, Scene
from ui.model.watching.tools import Tools, dragged_pose
from ui.windows.map import MapView
from ui.windows.researcher.docked_window import DockedWindow
from ui.windows.researcher.feeds.feed import Feed, FeedRequest
from ui.windows.researcher.map.preview import ToolPreview
from ui.windows.researcher.map.tools import TOOLS, Gesture, MapTool

GRAB_RADIUS, GRAB_PIXELS = 0.4, 24.0
"""Distance from a robot's middle within which a press selects the robot for a stroke, meters and pixels. The larger
distance counts."""
_CONFIRMATIONS = {
    MapTool.GOAL: "Sending {robot} there.",
    MapTool.POSE: "Setting the pose of {robot}.",
    MapTool.CARRY: "Moving {robot} there. The robot's software is not informed.",
    MapTool.OBSTACLE: "Requested. An obstacle appears as soon as there is free space at its place.",
}


class ToolController:
    """Controller that turns buttons, strokes and the wizard's choices into requests, and reports their sending.

    Args:
        feed: receiver of the requests.
        window: window with the buttons.
        view: the map.
        bodies: (n, 2) corners of the known robots' bodies in their own frames, by the robots' indices.
        select: function that selects another robot.

    Attributes:
        scene: scene on the map; None before there is one.
        selected: index of the robot that the buttons act on.
    """

    def __init__(
        self,
        feed: Feed,
        window: DockedWindow,
        view: MapView,
        bodies: Mapping[int, FloatArray],
        select: Callable[[int], None],
    ) -> None:
        self.scene: Scene | None = None
        self.selected = 0
        self._feed = feed
        self._window = window
        self._view = view
        self._bodies = bodies
        self._select = select
        self._tools = Tools()
        self._preview = ToolPreview(view.box)
        window.kill.connect(self._ask_to_kill)
        window.revive.connect(partial(self._ask, Tools.revive, "Reviving {robot}."))
        window.clear_costmaps.connect(partial(self._ask, Tools.clear_costmaps, "Clearing the costmaps of {robot}."))
        window.wizard.puppeteered.connect(self._puppeteer)
        window.wizard.spoke.connect(self._speak)
        window.wizard.advised.connect(self._advise)
        window.tool_selected.connect(self.use_tool)
        view.point_pressed.connect(self._press)
        view.point_dragged.connect(self._drag)
        view.point_released.connect(self._release)

    @property
    def _name(self) -> str:
        return robot_name(self.selected)

    def _ask(self, make: Callable[[Tools, Scene, int], FeedRequest | RequestRefused], sentence: str) -> None:
        """Create a request for the selected robot, and send it."""
        if self.scene is not None:
            self._send(make(self._tools, self.scene, self.selected), sentence)

    def _send(self, request: FeedRequest | RequestRefused, sentence: str) -> None:
        """Send a request. Show `sentence` if it was sent, otherwise the reason why it was not sent."""
        refusal = request.sentence if isinstance(request, RequestRefused) else self._feed.ask(request)
        self._window.show_status(refusal or sentence.format(robot=self._name))

    def _ask_to_kill(self) -> None:
        box = QMessageBox(self._window)
        box.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        box.setIcon(QMessageBox.Icon.Warning)
        box.setWindowTitle("Kill a robot")
        box.setText(f"Kill {robot_name(self.selected)}?")
        box.setInformativeText("Its software stops and its motors brake until you revive it. The recording shows this.")
        kill = box.addButton("Kill it", QMessageBox.ButtonRole.DestructiveRole)
        box.setDefaultButton(box.addButton("Leave it alive", QMessageBox.ButtonRole.RejectRole))
        kill.setAutoDefault(False)  # Without this, Enter would press this button after a change of colors.
        kill.clicked.connect(lambda: self._ask(Tools.kill, "Killing {robot}."))
        box.open()

    def _puppeteer(self, robot: int, on: bool) -> None:
        if self.scene is not None:
            sentence = "You now speak for {robot}." if on else "You no longer speak for {robot}."
            self._send(self._tools.puppeteer(self.scene, robot, on), sentence.format(robot=robot_name(robot)))

    def _speak(self, turn: PendingTurn, move: int, text: str) -> None:
        if self.scene is not None:
            sentence = f"{robot_name(turn.robot).capitalize()} says your sentence."
            self._send(self._tools.speak(self.scene, turn, move, text), sentence)

    def _advise(self, robot: int, room: int) -> None:
        if self.scene is not None:
            where = self._feed.data.log.room_names.titled(room)
            sentence = f"{robot_name(robot).capitalize()} will suggest {where}. Next, choose the robot's sentence."
            self._send(self._tools.advise(self.scene, robot, room), sentence)

    def use_tool(self, tool: MapTool) -> None:
        """Use this tool from now on."""
        self._preview.gesture = None
        self._view.set_tool(None if tool is MapTool.LOOK else Qt.CursorShape.CrossCursor)
        self._window.tool_help.setText(TOOLS[tool].how.format(robot=robot_name(self.selected)))
        self._preview.update()

    def _press(self, x: float, y: float) -> None:
        if self._window.tool is MapTool.CARRY:
            robot = self._robot_near(x, y)
            if robot is None:
                self._window.show_status("No robot is there. Press the mouse button on a robot, and drag the robot.")
                return
            self._select(robot)
            self._preview.body = self._bodies.get(robot)
        self._preview.thing_shape = self._window.shape
        self._preview.heading = self._heading()
        self._preview.gesture = Gesture(self._window.tool, x, y, x, y)
        self._preview.update()

    def _drag(self, x: float, y: float) -> None:
        begun = self._preview.gesture
        if begun is not None:
            self._preview.gesture = Gesture(begun.tool, begun.x, begun.y, x, y)
            self._preview.update()

    def _release(self, x: float, y: float) -> None:
        self._drag(x, y)
        done, self._preview.gesture = self._preview.gesture, None
        if done is None or self.scene is None:
            return
        self._send(self._meant(done, self.scene), _CONFIRMATIONS[done.tool])
        if done.tool in {MapTool.GOAL, MapTool.POSE}:
            self._window.select_tool(MapTool.LOOK)

    def _meant(self, done: Gesture, scene: Scene) -> FeedRequest | RequestRefused:
        """Return the request that a stroke means, or the reason why it is not possible."""
        tools = self._tools
        match done.tool:
            case MapTool.GOAL | MapTool.POSE:
                place = dragged_pose(done.x, done.y, done.to_x, done.to_y, self._heading())
                make = tools.goal if done.tool is MapTool.GOAL else tools.pose
                return make(scene, self.selected, place)
            case MapTool.CARRY:
                return tools.carry(scene, self.selected, done.to_x, done.to_y)
            case _:
                hit = tools.remove(scene, done.x, done.y) if done.is_click else None
                put = tools.put(scene, self._window.shape, done.x, done.y, done.size)
                return put if hit is None or isinstance(hit, RequestRefused) else hit

    def _heading(self) -> float:
        """Return the selected robot's heading: the true heading for the tool Kidnap, otherwise the estimate."""
        robots = () if self.scene is None else self.scene.robots
        robot = next((each for each in robots if each.robot == self.selected), None)
        if robot is None:
            return 0.0
        carried = self._window.tool is MapTool.CARRY
        pose = (robot.truth or robot.estimate) if carried else (robot.estimate or robot.truth)
        return 0.0 if pose is None else pose.theta

    def _robot_near(self, x: float, y: float) -> int | None:
        """Return the index of the robot whose true or estimated pose is near this place; None if there is none."""
        here = Pose2(x, y, 0.0)
        robots = () if self.scene is None else self.scene.robots
        near = [
            (pose.distance(here), robot.robot) for robot in robots for pose in (robot.truth, robot.estimate) if pose
        ]
        distance, robot = min(near, default=(math.inf, -1))
        return robot if distance <= max(GRAB_RADIUS, self._view.metres(GRAB_PIXELS)) else None
