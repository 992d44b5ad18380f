// Map of the player: rooms, robots, obstacles and believed poses at a time.

import { set, shape } from "../../static/dom.js";
import { GameMap } from "../../static/map.js";
import { Curve } from "./recording.js";

const TRAIL = 500; // Length in centimeters of the trail behind a robot.
const MOVED = 60; // Distance in centimeters between samples from which a robot was moved by hand.

export class Stage {
  // `choose` is called with the index of a robot that a person clicks on, and with null when a person moves the map.
  constructor(name, recording, choose) {
    this.map = new GameMap((act) => {
      if (act.act === "FollowRobot") choose(null);
      else if (act.robot !== undefined) choose(act.robot);
    }, name);
    this.beliefs = shape("g", { class: "beliefs" });
    if (recording.floor) {
      this.map.showFloor(recording.floor);
      const things = recording.obstacles.map((corners) => shape("polygon", { points: corners.join(" ") }));
      const [left, bottom, right, top] = recording.floor.box;
      set(this.map.element, { style: `--shape: ${right - left} / ${top - bottom}` });
      this.map.layers.walls.after(shape("g", { class: "obstacles" }, ...things), this.beliefs);
    }
  }

  showGame(game) {
    this.game = game;
    this.poses = game.robots.map((robot) => robot.pose && new Curve(robot.pose, [0.1, 0.1, 1]));
    this.believed = game.robots.map((robot) => robot.belief && new Curve(robot.belief, [0.1, 0.1, 1]));
    this.outlines = this.believed.map((_, index) =>
      shape("polygon", { points: this.map.floor?.footprint.join(" ") ?? "", style: `--robot: var(--robot${index % 10})` }),
    );
    this.beliefs.replaceChildren(...this.outlines);
  }

  show(time, followed) {
    const { map, game } = this;
    if (!map.floor) return;
    const rooms = new Map(map.floor.rooms.map((room) => [room.room, { state: "unvisited", found: [] }]));
    for (const change of game.rooms) {
      if (change.at > time) break;
      rooms.set(change.room, { state: change.state, found: change.points === null ? [] : [signed(change.points)] });
    }
    map.show({
      tiles: [...rooms].map(([room, tile]) => ({ room, ...tile, considered: false, choose: { enabled: false, act: {} } })),
      robots: game.robots.map((robot, index) => this.#robot(robot, index, time, followed === index)),
      cards: game.robots.map((_, robot) => ({ select: { act: { robot } } })),
      followed,
    });
    this.believed.forEach((curve, index) => {
      if (!curve) return;
      const [x, y, theta] = curve.at(time);
      set(this.outlines[index], { transform: `translate(${x.toFixed(1)} ${y.toFixed(1)}) rotate(${((theta * 0.18) / Math.PI).toFixed(1)})` });
    });
  }

  #robot(robot, index, time, selected) {
    const curve = this.poses[index];
    if (!curve) return { x: 0, y: 0, theta: 0, path: [], trail: [], selected, trouble: false };
    const [x, y, theta] = curve.at(time);
    const drive = robot.drives.find((each) => each.start <= time && time < each.end);
    const phase = robot.phases.findLast((each) => each.at <= time);
    return {
      x,
      y,
      theta,
      selected,
      trouble: phase?.trouble ?? false,
      trail: trail(curve, time, x, y),
      path: drive ? ahead(curve, time, drive.end, x, y) : [],
    };
  }
}

// The last meters that a robot has driven before a time, as x, y, x, y, ...
function trail(curve, time, x, y) {
  const [xs, ys] = curve.values;
  const points = [[x, y]];
  let length = 0;
  for (let index = curve.last(time); index >= 0 && length < TRAIL; index--) {
    const [lastX, lastY] = points.at(-1);
    const step = Math.hypot(xs[index] - lastX, ys[index] - lastY);
    const seconds = (curve.times[index + 1] ?? time) - curve.times[index];
    if (step > MOVED && step > 200 * seconds) break;
    length += step;
    points.push([xs[index], ys[index]]);
  }
  return points.flat().map(Math.round);
}

// The rest of a drive, as it was driven.
function ahead(curve, time, end, x, y) {
  const points = [[x, y]];
  for (let index = curve.last(time) + 1; index < curve.length && curve.times[index] <= end; index++) {
    points.push([curve.values[0][index], curve.values[1][index]]);
  }
  return points.flat().map(Math.round);
}

export function signed(number) {
  return number > 0 ? `+${number}` : String(number).replace("-", "−");
}
