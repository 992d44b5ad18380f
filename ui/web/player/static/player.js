// Player of a recording. The time of the recording decides what every part of the page shows.

import { element, list, set } from "../../static/dom.js";
import { number, plotsOf } from "./plots.js";
import { clock, Curve, unpack } from "./recording.js";
import { Stage } from "./stage.js";
import { Transcript } from "./transcript.js";
import { SPEEDS, Transport } from "./transport.js";

const SHORTEST = 5; // Seconds that the time axis shows at least.
const CALM = 500; // Milliseconds between two pictures for people who want less motion.
const by = (id) => document.getElementById(id);

class Player {
  constructor(recording) {
    Object.assign(this, { recording, words: recording.words, at: 0, playing: false, speed: 1, followed: null, hovered: null });
    this.stage = new Stage(this.words.map, recording, (robot) => this.follow(robot));
    this.transcript = new Transcript(by("kinds"), by("entries"), this.words, (time) => this.seek(time), () => this.#marks());
    this.transport = new Transport(this.words, this);
    this.#listenForZoom(this.transport.timeline, (event) => this.transport.time(event));
    this.plots = [];
    this.#build();
    const place = new URLSearchParams(location.hash.slice(1));
    this.showGame(Number(place.get("game") ?? 1) - 1);
    this.seek(Number(place.get("t") ?? 0));
    new ResizeObserver(() => this.#resize()).observe(by("plots"));
    new ResizeObserver(() => this.#fitScreen()).observe(document.querySelector(".head"));
    new ResizeObserver(() => this.#marks()).observe(this.transport.timeline);
  }

  showGame(index) {
    this.game = this.recording.games[index] ?? this.recording.games[0];
    Object.assign(this, { at: 0, playing: false, followed: null, hovered: null });
    this.energies = this.game.robots.map((robot) => robot.energy && new Curve(robot.energy, [0.1]));
    this.full = this.energies.map((curve) => (curve ? Math.max(...curve.values[0].slice(0, 1), 1e-6) : 1));
    this.score = this.game.score && new Curve(this.game.score, [1, 1]);
    by("summary").replaceChildren(
      ...this.game.summary.map(([label, value]) => element("div", {}, element("dt", { text: label }), element("dd", { text: value }))),
    );
    for (const button of by("games").children) set(button, { "aria-pressed": button.game === this.game ? "true" : "false" });
    this.stage.showGame(this.game);
    this.transcript.showGame(this.game);
    this.plots = plotsOf(this.game, this.words);
    by("plots").replaceChildren(...this.plots.map((plot) => plot.element));
    for (const plot of this.plots) this.#listen(plot);
    set(by("values"), { hidden: !this.plots.length });
    set(by("missing"), { hidden: !this.game.missing.length });
    by("missing").querySelector("ul").replaceChildren(...this.game.missing.map((text) => element("li", { text })));
    this.#showSpan(0, this.game.duration);
    this.#resize();
    this.show();
  }

  // Shows `factor` times as much of the time axis; the time `around` keeps its place.
  zoom(factor, around = this.at) {
    const { from, to } = this.span;
    const length = Math.min(Math.max((to - from) * factor, SHORTEST), this.game.duration);
    const share = to > from ? (around - from) / (to - from) : 0;
    this.#showSpan(around - share * length, length);
    this.show();
  }

  toggle() {
    if (!this.playing && this.at >= this.game.duration) this.at = 0;
    this.playing = !this.playing && this.game.duration > 0;
    this.last = performance.now();
    this.show();
    if (this.playing) requestAnimationFrame((now) => this.#play(now));
  }

  seek(time) {
    this.at = Math.min(Math.max(Number.isFinite(time) ? time : 0, 0), this.game.duration);
    this.last = performance.now();
    this.show();
  }

  step(seconds) {
    this.seek(this.at + seconds);
  }

  // Goes to the next (1) or the previous (-1) entry of the kinds that are shown.
  jump(direction) {
    const times = this.transcript.times.filter((time) => (direction > 0 ? time > this.at + 0.05 : time < this.at - 0.5));
    const end = direction > 0 ? this.game.duration : 0;
    this.seek((direction > 0 ? times[0] : times.at(-1)) ?? end);
  }

  setSpeed(speed) {
    this.speed = speed;
    this.show();
  }

  // Follows a robot, or stops following it; null stops following without moving the map.
  follow(robot) {
    if (robot >= this.game.robots.length) return;
    this.followed = this.followed === robot ? null : robot;
    if (this.followed === null && robot !== null) this.stage.map.fit();
    this.show();
  }

  showKeys() {
    by("keys").showModal();
  }

  show() {
    const { from, to } = this.span;
    // The time axis turns the page.
    if (this.at < from || this.at > to) this.#showSpan(this.at - 0.1 * (to - from), to - from);
    this.stage.show(this.at, this.followed);
    this.transcript.show(this.at, this.playing);
    this.transport.show(this.at, this.playing, this.speed);
    this.#showRobots();
    for (const plot of this.plots) plot.showAt(this.hovered ?? this.at);
  }

  #showSpan(start, length) {
    const from = Math.min(Math.max(start, 0), this.game.duration - length);
    this.span = { from, to: from + length };
    for (const plot of this.plots) {
      plot.span = this.span;
      if (plot.width) plot.draw(plot.width);
    }
    this.transport.showSpan(this.game, this.span);
    this.#marks();
  }

  #play(now) {
    if (!this.playing) return;
    requestAnimationFrame((later) => this.#play(later));
    if (matchMedia("(prefers-reduced-motion: reduce)").matches && now - this.last < CALM) return;
    this.at = Math.min(this.at + (Math.max(now - this.last, 0) / 1000) * this.speed, this.game.duration);
    this.last = now;
    this.playing = this.at < this.game.duration;
    this.show();
  }

  #showRobots() {
    list(
      by("robots"),
      this.game.robots,
      (_, index) => index,
      () => {
        const parts = ["chip", "label", "energy", "state", "bar"].map((name) => element("span", { class: name }));
        parts[4].append(element("span", {}));
        const made = element("button", { type: "button", class: "robot-card" }, ...parts);
        made.addEventListener("click", () => this.follow(made.robot));
        return element("li", {}, made);
      },
      (item, robot, index) => {
        const made = item.firstChild;
        made.robot = index;
        const [chip, label, energy, state, bar] = made.children;
        const phase = robot.phases.findLast((each) => each.at <= this.at);
        const left = this.energies[index]?.held(this.at)?.[0] ?? null;
        set(item, { style: `--robot: var(--robot${index % 10})` });
        set(made, { "aria-pressed": this.followed === index ? "true" : "false", title: this.words.follow.replace("£robot£", () => robot.name) });
        set(chip, { text: String(index + 1), "aria-hidden": "true" });
        set(label, { text: robot.name });
        set(state, { text: phase?.text ?? "", "data-bad": phase?.trouble });
        set(energy, { text: left === null ? "" : this.words.energy.replace("£energy£", number(left, 0)) });
        set(bar, { hidden: left === null });
        set(bar.firstChild, { style: `width: ${(100 * Math.min(Math.max(left / this.full[index], 0), 1)).toFixed(1)}%` });
      },
    );
    const [score, visited] = this.score?.held(this.at) ?? [0, 0];
    set(this.points, { text: String(score) });
    set(this.visited, { text: this.words.rooms_of.replace("£visited£", visited).replace("£rooms£", this.game.room_count) });
    set(this.figures, { hidden: !this.score });
  }

  #marks() {
    if (this.game) this.transport.showMarks(this.transcript.visible);
  }

  // Map and list fill the first screen, between the facts at the top and the playback at the bottom.
  #fitScreen() {
    set(by("stage"), { style: `--above: ${document.querySelector(".head").offsetHeight}px` });
  }

  #resize() {
    for (const plot of this.plots) {
      const width = plot.svg.clientWidth;
      if (width && width !== plot.width) plot.draw(width);
      if (width) plot.showAt(this.hovered ?? this.at);
    }
  }

  #listen(plot) {
    const time = (event) => plot.time(event.clientX - plot.svg.getBoundingClientRect().left);
    plot.svg.addEventListener("pointermove", (event) => {
      if (event.pointerType !== "mouse") return;
      this.hovered = time(event);
      for (const each of this.plots) each.showAt(this.hovered);
    });
    plot.svg.addEventListener("pointerleave", () => {
      this.hovered = null;
      this.show();
    });
    plot.svg.addEventListener("click", (event) => this.seek(time(event)));
    this.#listenForZoom(plot.svg, time);
  }

  // Zooms by the wheel with Ctrl, which is also what touchpads send for two fingers, and by two fingers on a screen.
  #listenForZoom(target, time) {
    target.addEventListener(
      "wheel",
      (event) => {
        if (!event.ctrlKey && !event.metaKey) return;
        event.preventDefault();
        this.zoom(Math.exp(Math.min(Math.max(event.deltaY, -100), 100) / 200), time(event));
      },
      { passive: false },
    );
    const fingers = new Map();
    const apart = () => Math.max(Math.abs([...fingers.values()].reduce((one, other) => one - other)), 10);
    target.addEventListener("pointerdown", (event) => fingers.set(event.pointerId, event.clientX));
    target.addEventListener("pointermove", (event) => {
      if (!fingers.has(event.pointerId)) return;
      const before = apart();
      fingers.set(event.pointerId, event.clientX);
      if (fingers.size === 2) this.zoom(before / apart(), time(event));
    });
    for (const end of ["pointerup", "pointercancel", "pointerleave"]) target.addEventListener(end, (event) => fingers.delete(event.pointerId));
  }

  #build() {
    const { words } = this;
    const whole = element("button", { type: "button", class: "small whole", text: words.whole_map });
    whole.addEventListener("click", () => this.#wholeMap());
    this.points = element("b", {});
    this.visited = element("b", {});
    this.figures = element(
      "p",
      { class: "figures" },
      element("span", {}, element("span", { class: "muted", text: words.score }), this.points),
      element("span", {}, element("span", { class: "muted", text: words.rooms_visited }), this.visited),
    );
    by("place").append(element("div", { class: "over" }, this.figures, whole), this.stage.map.element);
    if (this.recording.games.some((game) => game.robots.some((robot) => robot.belief))) {
      by("place").append(element("p", { class: "note muted", text: words.belief }));
    }
    set(this.stage.map.element, { hidden: !this.recording.floor });
    by("transport").append(this.transport.timeline, this.transport.controls);
    set(by("games"), { hidden: this.recording.games.length < 2 });
    for (const [index, game] of this.recording.games.entries()) {
      const button = element("button", { type: "button", class: "small", text: game.title });
      button.game = game;
      button.addEventListener("click", () => this.showGame(index));
      by("games").append(button);
    }
    const keys = [
      ["␣ K", "key_play"], ["← →", "key_seek"], [", .", "key_step"], ["[ ]", "key_event"], ["− +", "key_speed"],
      ["Home End", "key_ends"], ["I O", "key_zoom"], ["1–9", "key_robot"], ["0", "key_map"],
    ];
    const rows = keys.flatMap(([key, name]) => [
      element("dt", {}, ...key.split(" ").map((each) => element("kbd", { text: each }))),
      element("dd", { text: words[name] }),
    ]);
    const close = element("button", { type: "button", class: "main", text: words.close });
    close.addEventListener("click", () => by("keys").close());
    by("keys").append(element("h2", { id: "keys-title", text: words.keys }), element("dl", {}, ...rows), close);
    document.addEventListener("keydown", (event) => this.#key(event));
  }

  #wholeMap() {
    this.followed = null;
    this.stage.map.fit();
    this.show();
  }

  #key(event) {
    if (event.ctrlKey || event.altKey || event.metaKey || by("keys").open || event.target.matches("select")) return;
    // A button with the focus is pressed by the space bar.
    if (event.key === " " && event.target.matches("button, summary")) return;
    const scrolls = event.target.matches("pre");
    const speed = (change) => this.setSpeed(SPEEDS[SPEEDS.indexOf(this.speed) + change] ?? this.speed);
    const acts = {
      " ": () => this.toggle(),
      k: () => this.toggle(),
      ArrowLeft: () => this.step(-5),
      ArrowRight: () => this.step(5),
      ",": () => this.step(-1),
      ".": () => this.step(1),
      "[": () => this.jump(-1),
      "]": () => this.jump(1),
      "+": () => speed(1),
      "-": () => speed(-1),
      Home: () => this.seek(0),
      End: () => this.seek(this.game.duration),
      0: () => this.#wholeMap(),
      i: () => this.zoom(0.5),
      o: () => this.zoom(2),
    };
    const act = /^[1-9]$/.test(event.key) ? () => this.follow(Number(event.key) - 1) : acts[event.key];
    if (!act || scrolls) return;
    event.preventDefault();
    act();
  }
}

const notice = by("notice");
set(notice, { hidden: false });
unpack(by("recording").textContent).then((recording) => {
  for (const part of ["stage", "transport"]) set(by(part), { hidden: false });
  new Player(recording);
  set(notice, { hidden: true });
});
