// Open votes of the participants of a game: who proposes what, the votes so far, and the buttons of the own vote.

import { button, buttons, element, list, set } from "./dom.js";

export class Votes {
  constructor(words, act, element) {
    this.words = words;
    this.act = act;
    this.element = element;
    element.classList.add("votes");
  }

  show(votes) {
    this.element.hidden = !votes.length;
    list(this.element, votes, (vote) => vote.decision, () => this.#make(), (made, vote) => this.#show(made, vote));
  }

  #make() {
    const made = element("article", { class: "vote" });
    made.heading = element("h2", {});
    made.left = element("span", { class: "left muted" });
    made.cast = element("ul", {});
    made.needed = element("p", { class: "muted" });
    made.reason = element("input", { type: "text", maxlength: "200", "aria-label": this.words["votes.reason"], placeholder: this.words["votes.reason"] });
    made.answers = element("div", { class: "row" });
    made.append(element("header", {}, made.heading, made.left), made.cast, made.needed, element("div", { class: "row own" }, made.reason, made.answers));
    return made;
  }

  #show(made, vote) {
    set(made, { style: vote.robot === null ? null : `--robot: var(--robot${vote.robot % 10})` });
    set(made.heading, { text: vote.title });
    set(made.left, { text: vote.left });
    list(
      made.cast,
      vote.votes,
      (_, index) => index,
      () => element("li", {}, element("span", { class: "sign", "aria-hidden": "true" }), element("span", {})),
      (line, cast) => {
        set(line.children[0], { text: cast.agrees ? "✓" : "✗", "data-agrees": String(cast.agrees) });
        set(line.children[1], { text: cast.words });
      },
    );
    made.cast.hidden = !vote.votes.length;
    set(made.needed, { text: vote.needed });
    made.lastChild.hidden = !vote.buttons.length;
    const cast = (act) => {
      const reason = made.reason.value.trim();
      made.reason.value = "";
      this.act({ ...act, reason });
    };
    buttons(made.answers, vote.buttons, cast, { weight: "small" });
  }
}
