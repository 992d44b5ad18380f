// Controls of the playback: the timeline with its marks, and buttons.

import { element, set, shape } from "../../static/dom.js";
import { clock } from "./recording.js";
import { MARKS } from "./transcript.js";

export const SPEEDS = [0.25, 0.5, 1, 2, 4, 8, 16, 32, 64];
const LANE = 8; // Height of a lane of marks in the timeline.
const NEAR = 6; // Distance in pixels at which the pointer is at a mark.
const EDGE = 8; // Half the width of the slider's thumb.

export class Transport {
  // `player` has the methods toggle, seek, step, jump, setSpeed and showKeys.
  constructor(words, player) {
    this.words = words;
    this.marks = shape("svg", { class: "marks", "aria-hidden": "true", preserveAspectRatio: "none" });
    this.head = element("span", { class: "playhead" });
    this.slider = element("input", { type: "range", min: 0, step: 0.01, "aria-label": words.position });
    this.slider.addEventListener("input", () => player.seek(Number(this.slider.value)));
    this.bubble = element("output", { class: "bubble", hidden: true, "aria-hidden": "true" });
    this.timeline = element("div", { class: "timeline" }, this.marks, this.head, this.slider, this.bubble);
    this.timeline.addEventListener("pointermove", (event) => this.#point(event));
    this.timeline.addEventListener("pointerleave", () => set(this.bubble, { hidden: true }));
    const button = (name, sign, act, weight = "icon") => {
      const icon = shape("svg", { viewBox: "0 0 24 24", "aria-hidden": "true" }, shape("path", { d: sign }));
      const made = element("button", { type: "button", class: weight, "aria-label": words[name], title: words[name] }, icon);
      made.addEventListener("click", act);
      return made;
    };
    this.play = button("play", PLAY, () => player.toggle(), "icon main");
    this.now = element("span", { class: "now" });
    this.speed = element("select", { "aria-label": words.speed, title: words.speed });
    for (const speed of SPEEDS) {
      const label = words.times_speed.replace("£speed£", speed.toLocaleString(document.documentElement.lang));
      this.speed.append(element("option", { value: speed, text: label }));
    }
    this.speed.addEventListener("change", () => player.setSpeed(Number(this.speed.value)));
    const keys = element("button", { type: "button", class: "quiet keys", text: words.keys });
    keys.addEventListener("click", () => player.showKeys());
    const buttons = element(
      "div",
      { class: "buttons" },
      button("previous", "M6 5h2v14H6zM20 5v14l-10-7z", () => player.jump(-1)),
      button("back", "M11 5v14l-8-7zM21 5v14l-8-7z", () => player.step(-5)),
      this.play,
      button("forward", "M3 5l8 7-8 7zM13 5l8 7-8 7z", () => player.step(5)),
      button("next", "M4 5l10 7-10 7zM16 5h2v14h-2z", () => player.jump(1)),
    );
    this.controls = element("div", { class: "controls" }, this.now, buttons, element("div", { class: "end" }, this.speed, keys));
  }

  // Shows a part of the game's time.
  showSpan(game, span) {
    Object.assign(this, { game, span });
    set(this.slider, { min: span.from, max: span.to });
  }

  // Time at a place of the pointer.
  time(event) {
    const { left, width } = this.timeline.getBoundingClientRect();
    return this.span.from + Math.min(Math.max((event.clientX - left) / width, 0), 1) * (this.span.to - this.span.from);
  }

  // Draws the marks of the entries that are shown in the list.
  showMarks(entries) {
    this.entries = entries;
    const width = this.timeline.clientWidth;
    set(this.marks, { viewBox: `0 0 ${Math.max(width, 1)} ${LANE * MARKS.length}` });
    this.marks.replaceChildren(
      ...MARKS.map((mark, lane) => {
        const shown = entries.filter((entry) => entry.mark === mark && entry.at >= this.span.from && entry.at <= this.span.to);
        const places = new Set(shown.map((entry) => Math.round(this.#x(entry.at))));
        return shape("path", { "data-mark": mark, d: [...places].map((x) => `M${x} ${lane * LANE + 1}v${LANE - 2}`).join("") });
      }),
    );
  }

  show(time, playing, speed) {
    const { duration } = this.game;
    set(this.head, { style: `left: ${(100 * this.#share(time)).toFixed(3)}%` });
    this.slider.value = time;
    const position = this.words.position_of.replace("£time£", clock(time)).replace("£duration£", clock(duration));
    set(this.slider, { "aria-valuetext": position });
    set(this.now, { text: `${clock(time, true)} / ${clock(duration)}` });
    this.speed.value = speed;
    const name = playing ? this.words.pause : this.words.play;
    set(this.play, { "aria-label": name, title: name });
    set(this.play.querySelector("path"), { d: playing ? PAUSE : PLAY });
  }

  #share(time) {
    const { from, to } = this.span;
    return to > from ? (time - from) / (to - from) : 0;
  }

  #x(time) {
    return this.#share(time) * this.timeline.clientWidth;
  }

  #point(event) {
    const { left, width } = this.timeline.getBoundingClientRect();
    const x = Math.min(Math.max(event.clientX - left, 0), width);
    const time = this.time(event);
    const distances = this.entries.map((entry) => Math.abs(this.#x(entry.at) - x));
    const near = distances.reduce((best, each, index) => (each < (distances[best] ?? NEAR) ? index : best), -1);
    const entry = this.entries[near];
    const words = entry ? [clock(entry.at), entry.who, entry.text].filter(Boolean).join(" · ") : clock(time, true);
    set(this.bubble, { hidden: false, text: words });
    const half = this.bubble.offsetWidth / 2;
    set(this.bubble, { style: `left: ${Math.min(Math.max(x, half - EDGE), width - half + EDGE)}px` });
  }
}

const PLAY = "M7 4l13 8-13 8z";
const PAUSE = "M6 4h4v16H6zM14 4h4v16h-4z";
