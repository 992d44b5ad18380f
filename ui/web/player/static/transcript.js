// Transcript of a game: what was said and what happened, in sync with the time. A click on an entry jumps to it.

import { element, list, set } from "../../static/dom.js";
import { clock, lastUpTo } from "./recording.js";
import { signed } from "./stage.js";

export const MARKS = ["said", "found", "decided", "driven", "failed", "other"];

export class Transcript {
  constructor(kinds, entries, words, seek, changed) {
    this.kinds = kinds;
    this.entries = entries;
    this.words = words;
    this.seek = seek;
    this.shown = new Set(MARKS);
    this.changed = changed;
    this.empty = element("li", { class: "empty muted" });
  }

  showGame(game) {
    this.game = game;
    this.active = null;
    const present = MARKS.filter((mark) => game.entries.some((entry) => entry.mark === mark));
    list(
      this.kinds,
      present,
      (mark) => mark,
      (mark) => {
        const made = element("button", { type: "button", class: "kind", "data-mark": mark }, element("i", {}), element("span", {}), element("b", {}));
        made.addEventListener("click", () => {
          if (!this.shown.delete(mark)) this.shown.add(mark);
          this.#filter();
          this.changed();
        });
        return made;
      },
      (made, mark) => {
        set(made.children[1], { text: this.words[mark] });
        set(made.children[2], { text: String(game.entries.filter((entry) => entry.mark === mark).length) });
      },
    );
    this.items = game.entries.map((entry) => this.#item(entry));
    this.entries.replaceChildren(this.empty, ...this.items);
    this.#filter();
  }

  // Entries of the kinds that are shown.
  get visible() {
    return this.game.entries.filter((entry) => this.shown.has(entry.mark));
  }

  // Scrolls smoothly if the recording is being played.
  show(time, playing) {
    const index = lastUpTo(this.times, time);
    const active = index < 0 ? null : this.visibleItems[index];
    if (active === this.active) return;
    if (this.active) set(this.active.firstChild, { "aria-current": null });
    this.active = active;
    if (!active) {
      this.entries.scrollTop = 0;
      return;
    }
    set(active.firstChild, { "aria-current": "true" });
    // A person who reads the list moves it alone.
    if (!this.entries.matches(":hover, :focus-within")) {
      const still = matchMedia("(prefers-reduced-motion: reduce)").matches;
      this.entries.scrollTo({ top: active.offsetTop - 0.6 * this.entries.clientHeight, behavior: playing && !still ? "smooth" : "instant" });
    }
  }

  #item(entry) {
    const style = entry.robot === null ? null : `--robot: var(--robot${entry.robot % 10})`;
    const made = element(
      "button",
      { type: "button", class: "entry", "data-mark": entry.mark, "data-speaker": entry.speaker || null, style },
      element("time", { text: clock(entry.at) }),
      element("i", {}),
      element("span", { class: "words" }, entry.who ? element("b", { text: entry.who }) : null, element("span", { text: entry.text })),
      entry.points ? element("strong", { class: entry.points > 0 ? "won" : "lost", text: signed(entry.points) }) : null,
    );
    made.addEventListener("click", () => this.seek(entry.at));
    return element("li", {}, made);
  }

  #filter() {
    for (const button of this.kinds.children) set(button, { "aria-pressed": this.shown.has(button.dataset.mark) ? "true" : "false" });
    this.game.entries.forEach((entry, index) => set(this.items[index], { hidden: !this.shown.has(entry.mark) }));
    this.visibleItems = this.items.filter((item) => !item.hidden);
    this.times = this.visible.map((entry) => entry.at);
    set(this.empty, {
      hidden: this.visibleItems.length > 0,
      text: this.game.entries.length ? this.words.nothing_shown : this.words.nothing,
    });
  }
}
