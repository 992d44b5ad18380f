// Page of a game: shows the tree that the server sends, and returns acts and keys. It decides nothing.

import { button, buttons, element, list, set, showButton } from "./dom.js";
import { GameMap } from "./map.js";
import { applied } from "./patches.js";
import { PeoplePanel } from "./people.js";
import { play } from "./sounds.js";
import { Votes } from "./votes.js";

const REPEATING = new Set(["Tab", "Shift+Tab", "Up", "Down"]);
const NAMES = { Escape: "Esc", " ": "Space", ArrowUp: "Up", ArrowDown: "Down", Return: "Enter" };

export class GamePage {
  constructor(words, send, openSettings) {
    this.words = words;
    this.send = send;
    this.openSettings = openSettings;
    this.page = null;
    this.number = 0;
    this.pictures = new Map();
    this.act = this.act.bind(this);
    this.#build();
    this.onKey = (event) => this.#key(event);
    document.addEventListener("keydown", this.onKey);
  }

  close() {
    document.removeEventListener("keydown", this.onKey);
    this.map.close();
    this.people.close();
    for (const url of this.pictures.values()) URL.revokeObjectURL(url);
  }

  receive(message) {
    if (message.t === "floor") this.map.showFloor(message.floor);
    else if (message.t === "picture") this.#keepPicture(message);
    else if (message.t === "page") {
      this.page = applied(this.page, message.p);
      this.number = message.n;
      this.#show();
      requestAnimationFrame((at) => this.send({ t: "painted", n: message.n, at }));
    }
  }

  act(act, _button, onMap = false) {
    if (act.act === "ShowSettings") this.openSettings();
    else {
      if (act.act === "FitMap") this.map.fit();
      this.send({ t: "act", n: this.number, at: performance.now(), act, on_map: onMap });
    }
  }

  #region(tag, name, ...children) {
    const made = element(tag, { class: "region", "aria-label": name }, ...children);
    this.regions.push(made);
    return made;
  }

  #build() {
    const words = this.words;
    this.regions = [];
    const part = (this.parts = {});
    part.banner = element("p", { class: "banner", role: "status", hidden: true });
    part.advise = element("p", { class: "advise", role: "status", hidden: true });
    part.dialogue = this.#region("section", words["window.dialogue"]);
    part.treasure = this.#region("section", words["window.treasure"]);
    part.ending = this.#region("section", words["pages.game_over"]);
    part.game = element("span", { class: "muted" });
    part.score = element("output", { class: "score" });
    part.progress = element("span", {});
    part.tools = element("div", { class: "tools" });
    part.mapSwitch = element("button", { type: "button", class: "map-switch", text: words["map.name"], "aria-expanded": "false" });
    part.mapSwitch.addEventListener("click", () => this.#switchMap());
    part.scored = element("span", { class: "muted", text: words["window.score"] });
    const figures = element("p", { class: "figures" }, part.game, part.scored, part.score, part.progress);
    const top = this.#region("section", words["window.score_and_tools"], figures, part.mapSwitch, part.tools);
    top.classList.add("top");
    part.cards = this.#region("section", words["window.robots"]);
    part.cards.classList.add("cards");
    part.remark = element("p", { class: "remark muted", "aria-live": "polite" });
    part.advice = button(this.act, "plain advice");
    part.tiles = element("div", { class: "tiles" });
    part.rooms = this.#region("section", words["window.rooms"], part.tiles, part.advice, part.remark);
    part.queue = element("p", { class: "muted" });
    part.waiting = element("div", { class: "waiting" });
    const waiting = this.#region("section", words["window.what_waits"], part.queue, part.waiting);
    this.people = new PeoplePanel(this.act);
    this.regions.push(this.people.element);
    part.history = element("ol", { class: "history", tabindex: "0", "aria-label": words["window.history"] });
    this.map = new GameMap(this.act, words["map.name"]);
    this.votes = new Votes(words, this.act, this.#region("section", words["votes.title"]));
    part.noMap = element("p", { class: "no-map muted", hidden: true });
    part.pops = element("div", { class: "pops" }, part.dialogue, part.treasure, part.ending);
    part.area = element("div", { class: "area" }, this.map.element, part.noMap, part.banner, this.votes.element, part.pops);
    part.column = element("div", { class: "column" }, part.cards, part.rooms);
    part.below = element("div", { class: "below" }, waiting, part.history);
    part.question = element("dialog", { class: "question" });
    part.large = element("dialog", { class: "large" }, element("img", { alt: words["window.picture_of_find"] }));
    part.help = element("dialog", { class: "help" });
    for (const [dialog, key] of [[part.question, "Esc"], [part.large, "Esc"], [part.help, "Esc"]]) {
      dialog.addEventListener("cancel", (event) => {
        event.preventDefault();
        this.#press(key);
      });
    }
    const title = element("h1", { class: "unseen", text: words["window.title"] });
    part.playing = element("div", { class: "playing" }, title, top, part.advise, part.area, part.column, this.people.element, part.below, this.people.switch);
    part.plain = element("div", { class: "reading" });
    this.element = element("div", { class: "game" }, part.playing, part.plain, part.question, part.large, part.help);
  }

  #switchMap() {
    const open = this.element.toggleAttribute("data-map");
    set(this.parts.mapSwitch, { "aria-expanded": String(open) });
    (open ? this.map.element : this.element).scrollIntoView({ block: "nearest" });
  }

  #keepPicture({ id, data }) {
    const bytes = Uint8Array.from(atob(data), (letter) => letter.charCodeAt(0));
    this.pictures.set(id, URL.createObjectURL(new Blob([bytes])));
  }

  #show() {
    const { page, parts: part } = this;
    const playing = page.phase === "playing" || page.phase === "over";
    part.playing.hidden = !playing;
    part.plain.hidden = playing;
    if (!playing) this.#showPlain(page);
    set(part.banner, { text: page.banner, hidden: !page.banner, "data-bad": page.trouble });
    set(part.advise, { text: page.advise, hidden: !page.advise });
    set(part.game, { text: page.game, hidden: !page.game });
    part.scored.hidden = !page.score;
    set(part.score, { text: page.score, "aria-label": page.score_spoken, hidden: !page.score });
    this.map.element.hidden = !!page.no_map;
    part.mapSwitch.hidden = !!page.no_map;
    set(part.noMap, { text: page.no_map, hidden: !page.no_map });
    this.votes.show(page.votes);
    set(part.progress, { text: page.progress });
    buttons(part.tools, page.tools, this.act, { weight: "quiet", hints: false });
    list(part.cards, page.cards, (card) => card.robot, () => this.#makeCard(), (made, card) => showCard(made, card, this.act));
    showButton(part.advice, page.advice);
    set(part.remark, { text: page.remark || "\u00a0" });
    list(part.tiles, page.tiles, (tile) => tile.room, (tile) => this.#makeTile(tile), showTile);
    set(part.queue, { text: page.queue });
    list(
      part.waiting,
      page.waiting,
      (item) => JSON.stringify(item.show.act),
      () => element("p", {}, element("span", {}), button(this.act, "small")),
      (made, item) => {
        set(made, { style: `--robot: var(--robot${item.robot % 10})` });
        set(made.children[0], { text: item.text });
        showButton(made.children[1], item.show, { hints: false });
      },
    );
    this.#showHistory(page.history);
    this.#showPop("dialogue", page.dialogue, (made, pop) => this.#showDialogue(made, pop));
    this.#showPop("treasure", page.treasure, (made, pop) => this.#showTreasure(made, pop));
    this.#showPop("ending", page.treasure || page.dialogue ? null : page.ending, (made, pop) => this.#showQuestion(made, pop));
    const room = (page.dialogue ?? page.treasure)?.room;
    set(part.pops, { "data-wide": !!page.treasure, "data-left": this.map.isRight(room) });
    this.#showDialog(part.question, page.question, (made, asked) => this.#showQuestion(made, asked));
    this.#showDialog(part.help, page.help.length ? page : null, (made) => this.#showHelp(made));
    this.#showDialog(part.large, page.enlarged || null, (made, id) => set(made.firstChild, { src: this.pictures.get(id) }));
    this.map.show(page);
    set(part.playing, { "data-people": !!page.people });
    this.people.show(page.people);
    if (page.announcement_number !== this.announced) {
      this.announced = page.announcement_number;
      set(document.getElementById("announcer"), { text: page.announcement });
    }
    if (page.sound_number !== this.sounded) {
      if (this.sounded !== undefined) play(page.sound);
      this.sounded = page.sound_number;
    }
  }

  #showPlain(page) {
    const parts = [element("h1", { text: page.phase === "consent" ? this.words["pages.before"] ?? "" : this.words["pages.one_moment"] ?? "" })];
    parts.push(element("p", { class: "written", text: page.phase === "consent" ? page.consent : page.waiting_for }));
    if (page.phase === "consent") {
      const row = element("p", { class: "row" });
      buttons(row, page.consent_buttons, this.act);
      parts.push(row);
    }
    if (this.plain !== JSON.stringify([page.phase, page.consent, page.waiting_for])) {
      this.plain = JSON.stringify([page.phase, page.consent, page.waiting_for]);
      this.parts.plain.replaceChildren(...parts);
    }
  }

  #makeCard() {
    const made = element("article", { class: "card" });
    made.addEventListener("click", ({ target }) => !target.closest("button") && made.select.click());
    made.select = button(this.act, "face");
    made.chip = element("span", { class: "chip", "aria-hidden": "true" });
    made.energy = element("span", { class: "energy", "aria-hidden": "true" });
    made.bar = element("span", { class: "bar", "aria-hidden": "true" }, element("span", {}), element("span", {}));
    made.state = element("span", { class: "state", "aria-hidden": "true" });
    made.waits = element("span", { class: "waits", "aria-hidden": "true" });
    made.progress = element("span", { class: "driven", "aria-hidden": "true" }, element("span", {}));
    made.select.prepend(made.chip);
    made.select.append(made.waits, made.energy, made.bar);
    made.more = element("div", { class: "more" });
    made.append(made.select, element("div", { class: "doing" }, made.state, made.more), made.progress);
    return made;
  }

  #makeTile(tile) {
    const made = button(this.act, "tile");
    made.called = element("span", { class: "name muted", "aria-hidden": "true" });
    made.chip = element("span", { class: "chip", "aria-hidden": "true" });
    made.sign = element("span", { class: "sign", "aria-hidden": "true" });
    made.words = element("span", { class: "words", "aria-hidden": "true" });
    made.append(made.called, made.chip, made.sign, made.words);
    const consider = (room) => this.act({ act: "ConsiderRoom", room });
    made.addEventListener("pointerenter", (event) => event.pointerType === "mouse" && consider(tile.room));
    made.addEventListener("pointerleave", (event) => event.pointerType === "mouse" && consider(null));
    made.addEventListener("focus", () => made.matches(":focus-visible") && consider(tile.room));
    made.addEventListener("blur", () => consider(null));
    return made;
  }

  #showHistory(lines) {
    if (lines === this.history) return;
    this.history = lines;
    const box = this.parts.history;
    const atEnd = box.scrollTop + box.clientHeight >= box.scrollHeight - 4;
    list(
      box,
      lines,
      (line, index) => `${index}:${line.who}:${line.text}`,
      () => element("li", {}, element("b", {}), element("span", {})),
      (made, line) => {
        set(made, { "data-speaker": line.speaker });
        set(made.children[0], { text: line.who ? `${line.who}: ` : "", hidden: !line.who });
        set(made.children[1], { text: line.text });
      },
    );
    if (atEnd) box.scrollTop = box.scrollHeight;
  }

  #showPop(name, pop, show) {
    const made = this.parts[name];
    const had = made.contains(document.activeElement);
    const wasHidden = made.hidden;
    made.hidden = !pop;
    if (pop && pop !== made.pop) show(made, pop);
    made.pop = pop;
    // On a narrow page, a person may have scrolled to the rooms.
    if (pop && wasHidden) made.scrollIntoView({ block: "nearest" });
    if (pop && wasHidden && this.#lostFocus) this.#focusRegion(made);
    if (!pop && had) {
      this.#lostFocus = true;
      const card = this.parts.cards.querySelector('[data-selected] button');
      card?.focus();
    } else this.#lostFocus = false;
  }

  #lostFocus = false;

  #head(made, pop) {
    if (!made.head) {
      made.chip = element("span", { class: "chip", "aria-hidden": "true" });
      made.heading = element("h2", {});
      made.aside = button(this.act, "quiet");
      made.head = element("header", {}, made.chip, made.heading, made.aside);
      made.body = element("div", { class: "body" });
      made.foot = element("footer", {});
      made.append(made.head, made.body, made.foot);
    }
    set(made, { style: pop.robot === undefined ? null : `--robot: var(--robot${pop.robot % 10})` });
    set(made.chip, { text: String(this.page.cards[pop.robot]?.number ?? "") });
    set(made.heading, { text: pop.title });
    made.aside.hidden = !pop.aside;
    if (pop.aside) showButton(made.aside, pop.aside, { hints: false });
  }

  #showDialogue(made, pop) {
    this.#head(made, pop);
    if (!made.said) {
      made.figure = element("button", { type: "button", class: "picture" }, element("img", { alt: this.words["window.picture_of_find"] }));
      made.figure.addEventListener("click", () => made.pop?.enlarge && this.act(made.pop.enlarge.act));
      made.facts = element("ul", { class: "facts" });
      made.said = element("ol", { class: "said", tabindex: "0", "aria-label": this.words["window.what_was_said"] });
      made.state = element("p", { class: "muted" });
      made.outcome = element("p", { class: "outcome" });
      made.warning = element("p", { class: "warning" });
      made.words = element("input", { type: "text", maxlength: "200" });
      made.object = button((act) => this.act({ ...act, text: made.words.value.trim() }), "small");
      made.objection = element("div", { class: "row own objection" }, made.words, made.object);
      made.body.append(made.figure, made.facts, made.said, made.state, made.outcome, made.warning, made.objection);
      made.foot.classList.add("answers");
    }
    set(made.figure, { hidden: !pop.picture, title: pop.enlarge?.hint || null });
    if (pop.picture) set(made.figure.firstChild, { src: this.pictures.get(pop.picture) });
    showFacts(made.facts, pop.facts, this.act);
    const count = made.said.children.length;
    list(
      made.said,
      pop.sentences,
      (_, index) => index,
      () => element("li", {}, element("b", { class: "unseen" }), element("span", {})),
      (line, sentence) => {
        set(line, { "data-speaker": sentence.speaker });
        set(line.children[0], { text: sentence.who ? `${sentence.who}: ` : "" });
        set(line.children[1], { text: sentence.text });
      },
    );
    if (made.said.children.length !== count) made.said.scrollTop = made.said.scrollHeight;
    for (const name of ["state", "outcome", "warning"]) set(made[name], { text: pop[name], hidden: !pop[name] });
    const { objection } = pop;
    made.objection.hidden = !objection;
    if (objection) showButton(made.object, objection.button);
    // Words for one dialogue are never sent to another.
    if (!objection?.own_words || made.about !== pop.title) made.words.value = "";
    made.about = pop.title;
    set(made.words, { hidden: !objection?.own_words, placeholder: objection?.own_words, "aria-label": objection?.own_words });
    buttons(made.foot, pop.choices, this.act);
  }

  #showTreasure(made, pop) {
    this.#head(made, pop);
    if (!made.names) {
      made.talk = element("p", { class: "muted" });
      made.figure = element("button", { type: "button", class: "picture" }, element("img", { alt: this.words["window.picture_of_find"] }));
      made.figure.addEventListener("click", () => made.pop?.enlarge && this.act(made.pop.enlarge.act));
      made.unseen = element("p", { class: "unseen-picture muted" });
      made.take = button(this.act);
      made.facts = element("ul", { class: "facts" });
      made.nothing = element("p", { class: "muted" });
      made.asking = element("p", { class: "asking" });
      made.names = element("div", { class: "names", role: "listbox", tabindex: "0", "aria-label": this.words["window.possible_names"] });
      made.verdict = element("p", { class: "verdict" });
      made.left = element("div", { class: "finding" }, made.figure, made.unseen, made.take, made.facts, made.nothing);
      made.right = element("div", { class: "naming" }, made.asking, made.names, made.verdict);
      made.body.append(made.talk, element("div", { class: "halves" }, made.left, made.right));
    }
    set(made.talk, { text: pop.talk, hidden: !pop.talk });
    set(made.figure, { hidden: !pop.picture, title: pop.enlarge?.hint || null });
    if (pop.picture) set(made.figure.firstChild, { src: this.pictures.get(pop.picture) });
    set(made.unseen, { text: pop.unseen, hidden: !!pop.picture });
    made.take.hidden = !pop.take;
    if (pop.take) showButton(made.take, pop.take);
    showFacts(made.facts, pop.facts, this.act);
    set(made.nothing, { text: pop.nothing, hidden: !pop.nothing });
    set(made.asking, { text: pop.asking, hidden: !pop.asking });
    made.names.hidden = !pop.names.length;
    list(
      made.names,
      pop.names,
      (name) => name.pick.name,
      (name) => {
        const option = element("div", { role: "option", id: `name-${name.pick.name}` });
        option.addEventListener("click", () => this.act(option.pick));
        return option;
      },
      (option, name) => {
        option.pick = name.pick;
        set(option, { text: name.words, "aria-selected": String(name.picked) });
        if (name.picked && option.parentElement) option.scrollIntoView({ block: "nearest" });
      },
    );
    const picked = pop.names.find((name) => name.picked);
    set(made.names, { "aria-activedescendant": picked ? `name-${picked.pick.name}` : null });
    set(made.verdict, { hidden: !pop.verdict, "data-won": pop.won === null ? null : String(pop.won) });
    made.verdict.replaceChildren(element("b", { text: pop.points }), ` ${pop.verdict}`);
    buttons(made.foot, [pop.name_it, pop.unsure, pop.leave].filter(Boolean), this.act);
  }

  #showQuestion(made, asked) {
    if (!made.rows) {
      made.heading = element("h2", {});
      made.rows = element("div", { class: "body" });
      made.foot = element("footer", { class: "answers" });
      made.append(made.heading, made.rows, made.foot);
    }
    set(made.heading, { text: asked.title });
    list(made.rows, asked.lines, (_, index) => index, () => element("p", {}), (row, line) => set(row, { text: line }));
    buttons(made.foot, asked.buttons, this.act);
  }

  #showHelp(made) {
    const { page } = this;
    const close = button(this.act, "main");
    showButton(close, page.close_help);
    made.replaceChildren(
      element("h2", { text: this.words["pages.rules_and_keys"] }),
      element("div", { class: "body", tabindex: "0" },
        element("ul", {}, ...page.rules.map((rule) => element("li", { text: rule }))),
        element("dl", {}, ...page.help.flatMap(([keys, effect]) => [element("dt", {}, element("kbd", { text: keys })), element("dd", { text: effect })])),
      ),
      element("footer", {}, close),
    );
  }

  #showDialog(dialog, content, show) {
    if (content && content !== dialog.content) show(dialog, content);
    dialog.content = content;
    if (content && !dialog.open) dialog.showModal();
    else if (!content && dialog.open) dialog.close();
  }

  // Keys ------------------------------------------------------------------------------------------------------------

  #press(key) {
    this.send({ t: "key", n: this.number, at: performance.now(), key });
  }

  #key(event) {
    if (!this.page || !this.element.isConnected || event.isComposing || document.querySelector("dialog[open]:not(.game dialog)")) return;
    const name = keyName(event);
    if (this.people.takes(name)) return;
    if (name === "F6" || name === "Shift+F6") {
      event.preventDefault();
      this.#nextRegion(name === "F6" ? 1 : -1);
      return;
    }
    const focused = document.activeElement;
    const onButton = focused instanceof HTMLButtonElement;
    if (focused instanceof HTMLInputElement || focused instanceof HTMLTextAreaElement) return; // A person writes.
    if (onButton && name === "Enter") return;
    if (event.repeat && !REPEATING.has(name)) return;
    const known = this.page.keys.includes(name);
    if (known || (/^\p{L}$/u.test(name) && this.page.treasure)) {
      if (known) event.preventDefault();
      // While a treasure has a list of names, letters belong to the list.
      if (name === (this.page.treasure?.names.length ? "Ctrl+A" : "A") && this.page.phase === "playing") this.map.fit();
      if (name === "Ctrl+,") this.openSettings();
      else if (name === this.page.people?.key) this.people.focus();
      else if (name === this.page.dialogue?.objection?.button.key && !this.page.question) this.parts.dialogue.object.click();
      else this.#press(name);
      return;
    }
    const talk = this.parts.dialogue;
    if (onButton && event.key.startsWith("Arrow")) {
      event.preventDefault();
      this.#step(focused, event.key === "ArrowDown" || event.key === "ArrowRight" ? 1 : -1);
    } else if (!talk.hidden && (name === "Down" || name === "Up")) {
      event.preventDefault();
      [...talk.foot.querySelectorAll("button")].at(name === "Down" ? 0 : -1)?.focus();
    } else if (!talk.hidden && (name === "PageDown" || name === "PageUp")) {
      event.preventDefault();
      talk.said.scrollBy(0, (name === "PageDown" ? 0.9 : -0.9) * talk.said.clientHeight);
    }
  }

  #step(focused, step) {
    const region = focused.closest(".region, dialog, #strip, #message") ?? this.element;
    const all = [...region.querySelectorAll("button")].filter((each) => each.offsetParent);
    all[(all.indexOf(focused) + step + all.length) % all.length]?.focus();
  }

  #nextRegion(step) {
    const dialog = this.element.querySelector("dialog[open]");
    // The strip and messages of the researcher are above the game, and Tab has another meaning here.
    const above = ["strip", "message"].map((id) => document.getElementById(id));
    const shown = dialog ? [dialog] : [...above, ...this.regions, this.parts.history].filter((region) => [...region.children].some((each) => each.offsetParent));
    const at = shown.findIndex((region) => region.contains(document.activeElement));
    this.#focusRegion(shown[(at + step + shown.length) % shown.length]);
  }

  #focusRegion(region) {
    const parts = [...region.querySelectorAll("button, textarea, [tabindex]")].filter((each) => each.offsetParent);
    (parts.find((each) => each.closest("[data-selected]")) ?? parts[0] ?? region).focus();
  }
}

function keyName(event) {
  let key = NAMES[event.key] ?? event.key;
  if (key.length === 1) key = key.toUpperCase();
  if (event.ctrlKey && key !== "Control") return `Ctrl+${key}`;
  if (event.shiftKey && (key === "Tab" || key === "F6")) return `Shift+${key}`;
  return event.altKey || event.metaKey ? `Alt+${key}` : key;
}

function showCard(made, card, act) {
  set(made, { "data-selected": card.selected, "data-asked": card.asked_for, style: `--robot: var(--robot${card.robot % 10})` });
  showButton(made.select, card.select, { hints: false });
  set(made.select, { "aria-pressed": String(card.selected) });
  set(made.select.parts.label, { text: card.name });
  set(made.chip, { text: String(card.number) });
  set(made.energy, { text: card.energy[1] ?? card.energy[0] ?? "", "data-bad": !card.affordable });
  set(made.bar, { "data-bad": !card.affordable, hidden: !card.energy.length });
  set(made.bar.children[0], { style: `width:${100 * card.left}%` });
  set(made.bar.children[1], { style: `width:${100 * card.kept}%` });
  const state = card.warning || [card.commander, card.state, card.place].filter(Boolean).join(" · ");
  set(made.state, { text: state, "data-bad": card.trouble || !!card.warning });
  set(made.waits, { text: card.waits ? String(card.waits) : "", hidden: !card.waits });
  set(made.progress, { hidden: card.progress === null });
  set(made.progress.firstChild, { style: `width:${100 * (card.progress ?? 0)}%` });
  buttons(made.more, card.buttons, act, { weight: "small", hints: false });
}

const WORDS = 18; // Letters that fit on a tile.
const SIGNS = { unvisited: "○", reserved: "→", visited: "•", won: "✓", lost: "✗" };

function showTile(made, tile) {
  showButton(made, tile.choose, { hints: false });
  set(made, { "data-state": tile.state, "data-considered": tile.considered, title: tile.choose.hint || tile.name });
  set(made.parts.label, { text: String(tile.room) });
  made.parts.key.hidden = true;
  set(made.called, { text: tile.name });
  set(made.chip, { text: String((tile.robot ?? 0) + 1), hidden: tile.robot === null, style: tile.robot === null ? null : `--robot: var(--robot${tile.robot % 10})` });
  set(made.sign, { text: SIGNS[tile.state] });
  const words = tile.words.find((each) => each.length <= WORDS) ?? tile.words.at(-1) ?? "";
  set(made.words, { text: `${tile.warning ? "⚠ " : ""}${words}` });
}

function showFacts(parent, facts, act) {
  list(
    parent,
    facts.filter((fact) => fact.words || fact.acts.length),
    (fact, index) => index,
    () => element("li", {}, element("span", { class: "drawn" }), element("span", {}), element("span", { class: "asked muted" }, element("span", {}), element("kbd", {})), element("div", { class: "row" })),
    (made, fact) => {
      set(made.children[0], { hidden: fact.drawn === "none", "data-drawn": fact.drawn, "data-value": fact.value });
      if (fact.drawn === "colour") made.children[0].style.setProperty("--swatch", fact.value.replaceAll(" ", ""));
      set(made.children[1], { text: fact.words, hidden: !fact.words });
      made.children[2].hidden = !fact.asked;
      set(made.children[2].children[0], { text: fact.asked });
      set(made.children[2].children[1], { text: fact.key, hidden: !fact.key });
      buttons(made.children[3], fact.acts, act, { weight: "small" });
    },
  );
  parent.hidden = !parent.children.length;
}
