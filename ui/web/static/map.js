// Map: floor, rooms and robots in SVG. Robots glide from where they are shown to their latest pose. A robot of a recording
// has its own trail, and is shown exactly at its pose.

import { element, list, set, shape } from "./dom.js";

const GLIDE = 0.09; // Time constant in seconds with which a robot approaches its latest pose.
const JUMP = 60; // Distance in centimeters from which a robot is shown at its new place at once.
const TRAIL_STEP = 12;
const TRAIL_POINTS = 44;
const FOLLOW_WIDTH = 700; // Width in centimeters of the part of the map around a robot that is followed.
const SIGNS = { unvisited: "", reserved: "→", visited: "•", won: "✓", lost: "✗" };
const LETTER = 0.58; // Mean width of a letter, as a share of the size of the text.
const LARGEST = 40; // Greatest size of texts in centimeters, so that they stay in their rooms.
const EDGE = 13; // Distance in centimeters between the edge of a room and its texts.

export class GameMap {
  constructor(act, name) {
    this.act = act;
    this.floor = null;
    this.page = null;
    this.robots = new Map();
    this.view = null;
    this.fitted = true;
    this.ground = shape("g", { transform: "scale(1 -1)" });
    this.signs = shape("g", {});
    this.svg = shape("svg", { role: "img", "aria-label": name, preserveAspectRatio: "xMidYMid meet" }, this.ground, this.signs);
    this.element = element("div", { class: "map" });
    this.element.append(this.svg);
    this.layers = Object.fromEntries(
      ["known", "unknown", "rooms", "walls", "paths", "trails", "bodies"].map((layer) => [layer, shape("g", { class: layer })]),
    );
    this.ground.append(...Object.values(this.layers));
    this.labels = shape("g", { class: "labels" });
    this.numbers = shape("g", { class: "numbers" });
    this.signs.append(this.labels, this.numbers);
    this.sizes = new ResizeObserver(() => this.#measure());
    this.sizes.observe(this.element);
    this.last = performance.now();
    this.#listen();
    const frame = (now) => {
      this.#glide(now);
      this.frame = requestAnimationFrame(frame);
    };
    this.frame = requestAnimationFrame(frame);
  }

  close() {
    cancelAnimationFrame(this.frame);
    this.sizes.disconnect();
  }

  showFloor(floor) {
    this.floor = floor;
    const [x, y, theta] = floor.origin;
    const place = `translate(${x} ${y}) rotate(${(theta * 180) / 1000 / Math.PI}) scale(${floor.resolution})`;
    const [left, bottom, right, top] = floor.box;
    this.layers.known.replaceChildren(shape("rect", { x: left, y: bottom, width: right - left, height: top - bottom }));
    this.layers.unknown.replaceChildren(shape("path", { d: floor.unknown, transform: place, "fill-rule": "evenodd" }));
    this.layers.walls.replaceChildren(shape("path", { d: floor.walls, transform: place, "fill-rule": "evenodd" }));
    this.fit();
    if (this.page) this.show(this.page);
  }

  show(page) {
    this.page = page;
    if (!this.floor || !this.unit) return;
    const tiles = new Map(page.tiles.map((tile) => [tile.room, tile]));
    const shown = this.floor.rooms.filter((room) => tiles.has(room.room));
    list(
      this.layers.rooms,
      shown,
      (room) => room.room,
      (room) => {
        const made = shape("polygon", { points: pairs(room.corners) });
        made.room = room.room;
        return made;
      },
      (made, room) => {
        const tile = tiles.get(room.room);
        set(made, { "data-state": tile.state, "data-considered": tile.considered, "data-choosable": tile.choose.enabled });
      },
    );
    list(
      this.labels,
      shown,
      (room) => room.room,
      () => {
        const sign = shape("g", { class: "sign" }, shape("circle", {}), shape("text", {}));
        return shape("g", {}, shape("text", { class: "room" }), shape("text", { class: "name" }), sign, shape("text", { class: "found" }));
      },
      (made, room) => this.#letter(made, room, tiles.get(room.room)),
    );
    page.robots.forEach((robot, index) => this.#showRobot(robot, index));
    if (page.followed !== null) this.fitted = false;
  }

  // Places the texts of a room: its number and name at the upper left, its sign at the upper right, its treasure below.
  #letter(made, room, tile) {
    const size = this.unit;
    const [left, top, right, bottom] = edges(room.corners);
    const space = (right - left - 2 * EDGE) / size;
    const small = Math.min(0.82, space / 8);
    const [number, name, sign, found] = made.children;
    const x = left + EDGE;
    set(number, { text: String(tile.room), x, y: top + EDGE + 0.8 * size, "font-size": 1.9 * size });
    set(name, { text: fitting([room.name], space / small), x, y: top + EDGE + 2.05 * size, "font-size": small * size });
    set(sign, { transform: `translate(${right - EDGE - 0.6 * size} ${top + EDGE + 0.6 * size}) scale(${size})`, "data-state": tile.state, style: (tile.robot ?? null) === null ? null : `--robot: var(--robot${tile.robot % 10})` });
    set(sign.lastChild, { text: SIGNS[tile.state] });
    set(found, { text: fitting(tile.found, space / small), x, y: bottom - EDGE - 0.5 * size, "font-size": small * size });
  }

  // Keeps texts and signs at the size of the page's text, whatever part of the map is shown.
  #measure() {
    if (!this.view || !this.element.clientWidth) return;
    const scale = Math.min(this.element.clientWidth / this.view[2], this.element.clientHeight / this.view[3]);
    const unit = Math.min(parseFloat(getComputedStyle(document.documentElement).fontSize) / scale, LARGEST);
    if (this.unit && Math.abs(unit / this.unit - 1) < 0.01) return;
    this.unit = unit;
    this.svg.style.setProperty("--unit", `${unit}px`);
    if (this.page) this.show(this.page);
  }

  fit() {
    this.fitted = true;
    if (!this.floor) return;
    const [left, bottom, right, top] = this.floor.box;
    const edge = 0.03 * Math.max(right - left, top - bottom);
    this.#look([left - edge, -top - edge, right - left + 2 * edge, top - bottom + 2 * edge]);
  }

  // Returns true if a room is in the right half of the shown map.
  isRight(number) {
    const room = this.floor?.rooms.find((each) => each.room === number);
    if (!room || !this.view) return false;
    const [left, , right] = edges(room.corners);
    return (left + right) / 2 > this.view[0] + this.view[2] / 2;
  }

  #showRobot(robot, index) {
    let known = this.robots.get(index);
    if (!known) {
      const body = shape("polygon", { points: pairs(this.floor.footprint), style: `--robot: var(--robot${index % 10})` });
      const nose = shape("path", { d: "M-6 -12 12 0 -6 12 -1 0Z" });
      const ring = shape("circle", { class: "ring", r: 50 });
      const ellipse = shape("ellipse", { class: "ellipse" });
      const made = shape("g", { class: "robot" }, ring, body, nose);
      made.robot = index;
      const style = `--robot: var(--robot${index % 10})`;
      const badge = shape("g", { class: "badge" }, shape("circle", {}), shape("text", { text: String(this.page.cards[index]?.number ?? index + 1) }));
      const number = shape("g", { style }, badge);
      const path = shape("polyline", {});
      const flag = shape("path", { class: "flag" });
      const trail = shape("polyline", { style });
      const truth = shape("g", { class: "truth" }, shape("path", {}), shape("polygon", { points: pairs(this.floor.footprint) }));
      this.layers.bodies.append(ellipse, truth, made);
      this.numbers.append(number);
      this.layers.paths.append(shape("g", { style }, path, flag));
      this.layers.trails.append(trail);
      known = { x: robot.x, y: robot.y, theta: robot.theta / 1000, made, number, badge, path, flag, trail, ellipse, truth, points: [] };
      this.robots.set(index, known);
    }
    if (robot.trail || Math.hypot(robot.x - known.x, robot.y - known.y) > JUMP) {
      Object.assign(known, { x: robot.x, y: robot.y, theta: robot.theta / 1000, points: [] });
    }
    known.target = robot;
    set(known.made, { "data-selected": robot.selected, "data-trouble": robot.trouble, "data-commanded": !!robot.commander });
    set(known.number, { "data-selected": robot.selected });
    set(known.path, { points: pairs(robot.path) });
    if (robot.trail) set(known.trail, { points: pairs(robot.trail) });
    const [x, y] = robot.path.slice(-2);
    set(known.flag, { d: x === undefined ? null : `M${x} ${y}v22l16 -7l-16 -7` });
    const [major, minor, angle] = robot.ellipse ?? [0, 0, 0];
    set(known.ellipse, { rx: major, ry: minor, transform: `translate(${robot.x} ${robot.y}) rotate(${degrees(angle)})` });
    known.truth.style.display = robot.truth ? "" : "none";
    if (robot.truth) {
      const [trueX, trueY, theta] = robot.truth;
      set(known.truth.firstChild, { d: `M${robot.x} ${robot.y}L${trueX} ${trueY}` });
      set(known.truth.lastChild, { transform: `translate(${trueX} ${trueY}) rotate(${degrees(theta)})` });
    }
  }

  #glide(now) {
    const share = 1 - Math.exp(-Math.min(now - this.last, 200) / 1000 / GLIDE);
    this.last = now;
    const still = matchMedia("(prefers-reduced-motion: reduce)").matches;
    for (const [index, robot] of this.robots) {
      if (!robot.target || !this.unit) continue;
      const step = still ? 1 : share;
      robot.x += step * (robot.target.x - robot.x);
      robot.y += step * (robot.target.y - robot.y);
      const turn = robot.target.theta / 1000 - robot.theta;
      robot.theta += step * Math.atan2(Math.sin(turn), Math.cos(turn));
      set(robot.made, { transform: `translate(${robot.x.toFixed(1)} ${robot.y.toFixed(1)}) rotate(${((robot.theta * 180) / Math.PI).toFixed(1)})` });
      set(robot.number, { transform: `translate(${robot.x.toFixed(1)} ${(-robot.y).toFixed(1)})` });
      set(robot.badge, { transform: `translate(0 ${(-42 - 0.6 * this.unit).toFixed(1)}) scale(${this.unit.toFixed(1)})` });
      const end = robot.points.at(-1);
      if (!robot.target.trail && (!end || Math.hypot(robot.x - end[0], robot.y - end[1]) >= TRAIL_STEP)) {
        robot.points.push([robot.x, robot.y]);
        if (robot.points.length > TRAIL_POINTS) robot.points.shift();
        set(robot.trail, { points: robot.points.map(([x, y]) => `${x.toFixed(0)},${y.toFixed(0)}`).join(" ") });
      }
      if (this.page && this.page.followed === index) {
        const wide = Math.min(this.view[2], FOLLOW_WIDTH);
        const high = (wide * this.view[3]) / this.view[2];
        this.#look([robot.x - wide / 2, -robot.y - high / 2, wide, high]);
      }
    }
  }

  #look(view) {
    this.view = view;
    set(this.svg, { viewBox: view.map((number) => number.toFixed(1)).join(" ") });
    this.#measure();
  }

  #point(event) {
    const matrix = this.svg.getScreenCTM().inverse();
    return new DOMPoint(event.clientX, event.clientY).matrixTransform(matrix);
  }

  #zoom(event, factor) {
    const at = this.#point(event);
    const [x, y, wide, high] = this.view;
    this.fitted = false;
    this.#look([at.x - (at.x - x) * factor, at.y - (at.y - y) * factor, wide * factor, high * factor]);
  }

  #listen() {
    const pointers = new Map();
    let moved = false;
    this.svg.addEventListener("wheel", (event) => {
      event.preventDefault();
      this.#zoom(event, Math.exp(event.deltaY * 0.0015));
    }, { passive: false });
    this.svg.addEventListener("pointerdown", (event) => {
      pointers.set(event.pointerId, event);
      moved = false;
    });
    this.svg.addEventListener("pointermove", (event) => {
      const before = pointers.get(event.pointerId);
      if (!before) {
        const room = event.target.room ?? null;
        if (room !== this.considered && event.pointerType === "mouse") {
          this.considered = room;
          this.act({ act: "ConsiderRoom", room });
        }
        return;
      }
      if (!moved && Math.hypot(event.clientX - before.clientX, event.clientY - before.clientY) < 5) return;
      moved = true;
      const [from, to] = [this.#point(before), this.#point(event)];
      if (pointers.size === 2) {
        const other = [...pointers.values()].find((each) => each.pointerId !== event.pointerId);
        const apart = (one) => Math.hypot(one.clientX - other.clientX, one.clientY - other.clientY);
        this.#zoom(other, apart(before) / Math.max(apart(event), 1));
      } else {
        const [x, y, wide, high] = this.view;
        this.fitted = false;
        this.#look([x + from.x - to.x, y + from.y - to.y, wide, high]);
        if (this.page && this.page.followed !== null) this.act({ act: "FollowRobot" });
      }
      pointers.set(event.pointerId, event);
    });
    const lift = (event) => {
      const pressed = pointers.delete(event.pointerId);
      if (event.type !== "pointerup" || !pressed || moved || !this.page) return;
      const robot = event.target.closest("g.robot")?.robot;
      const room = event.target.room;
      if (robot !== undefined) this.act(this.page.cards[robot].select.act, null, true);
      else if (room !== undefined) this.act(this.page.tiles.find((tile) => tile.room === room).choose.act, null, true);
    };
    for (const kind of ["pointerup", "pointercancel", "pointerleave"]) this.svg.addEventListener(kind, lift);
    this.svg.addEventListener("dblclick", () => this.fit());
  }
}

function pairs(numbers) {
  const points = [];
  for (let at = 0; at < numbers.length; at += 2) points.push(`${numbers[at]},${numbers[at + 1]}`);
  return points.join(" ");
}

// Smallest x, smallest y, greatest x and greatest y of corners, y downward.
function edges(corners) {
  const xs = corners.filter((_, at) => at % 2 === 0);
  const ys = corners.filter((_, at) => at % 2 === 1);
  return [Math.min(...xs), -Math.max(...ys), Math.max(...xs), -Math.min(...ys)];
}

function fitting(texts, space) {
  return texts.find((text) => text.length * LETTER <= space) ?? "";
}

function degrees(thousandths) {
  return ((thousandths * 180) / 1000 / Math.PI).toFixed(1);
}
