// Pages of a study: texts, consent, forms, waiting. The server has made all words.

import { element, set } from "./dom.js";

const READING = 400; // Milliseconds for which a new page ignores presses, because they were meant for the previous page.
const PAUSE = 700; // Milliseconds without typing after which the text so far is reported.

const nanoseconds = () => Math.round(performance.now() * 1e6);

function html(text, attributes = {}) {
  const made = element("div", { class: "prose", ...attributes });
  made.innerHTML = text; // Made by the server from the study's files: no HTML of theirs takes effect.
  return made;
}

class Page {
  constructor(message, send) {
    this.message = message;
    this.send = send;
    this.came = performance.now();
    this.left = false;
    this.element = element("article", { class: "reading", "aria-labelledby": "heading" });
    this.heading = element("h1", { id: "heading", tabindex: "-1", text: message.heading });
    if (message.heading) this.element.append(this.heading);
    this.onKey = (event) => this.key(event);
    document.addEventListener("keydown", this.onKey);
  }

  close() {
    document.removeEventListener("keydown", this.onKey);
  }

  key() {}

  get isNew() {
    return performance.now() - this.came < READING;
  }

  leave(message) {
    if (this.left || this.isNew) return;
    this.left = true;
    this.send({ page: this.message.page, ...message });
  }

  start() {
    (this.element.querySelector("[tabindex], button") ?? this.element).focus({ preventScroll: true });
    window.scrollTo(0, 0);
    document.getElementById("main").scrollTo(0, 0);
  }

  plainButton(label, key, press, weight = "plain", hint = "") {
    const made = element("button", { type: "button", class: weight }, element("span", { class: "label", text: label }));
    if (key) made.append(element("kbd", { "aria-hidden": "true", text: key }));
    if (hint) made.append(element("span", { class: "hint", text: hint }));
    made.addEventListener("click", press);
    return made;
  }
}

export class TextPage extends Page {
  constructor(message, send) {
    super(message, send);
    this.element.append(html(message.html, { tabindex: "0" }));
    if (message.code) {
      const { label, code, spoken, note } = message.code;
      this.element.append(
        element("p", { class: "code-label", text: label }),
        element("p", { class: "code", "aria-label": spoken, tabindex: "0", text: code }),
        element("p", { class: "muted", text: note, hidden: !note }),
      );
    }
    const footer = element("footer", { class: "row end" });
    if (message.ending?.code) {
      const { label, code, spoken } = message.ending;
      this.element.append(element("p", { class: "code-label", text: label }), element("p", { class: "code", "aria-label": spoken, tabindex: "0", text: code }));
    }
    if (message.ending?.address) {
      const link = element("a", { class: "main", href: message.ending.address, rel: "noreferrer", text: message.ending.label });
      link.addEventListener("click", () => message.button && send({ type: "WentOn", page: message.page }));
      footer.append(link);
    } else if (message.button) {
      this.button = this.plainButton(message.button, "Enter", () => this.leave({ type: "WentOn" }), "main");
      footer.append(this.button);
    }
    if (footer.children.length) this.element.append(footer);
  }

  key(event) {
    if (event.key === "Enter" && !event.repeat && this.button && !(document.activeElement instanceof HTMLButtonElement)) {
      event.preventDefault();
      this.leave({ type: "WentOn" });
    }
  }
}

export class ConsentPage extends Page {
  constructor(message, send) {
    super(message, send);
    const answer = (agrees) => this.leave({ type: "ConsentReply", agrees, window_ns: nanoseconds() });
    this.element.append(
      html(message.html, { tabindex: "0" }),
      element(
        "footer",
        { class: "row" },
        this.plainButton(message.agree, "A", () => answer(true), "plain", message.agree_hint),
        this.plainButton(message.decline, "N", () => answer(false), "plain", message.decline_hint),
      ),
    );
    this.answer = answer;
  }

  key(event) {
    if (event.repeat || event.ctrlKey || event.altKey || event.metaKey) return;
    if (event.key.toUpperCase() === "A") this.answer(true);
    if (event.key.toUpperCase() === "N") this.answer(false);
  }
}

export class WaitPage extends Page {
  constructor(message, send) {
    super(message, send);
    this.element.classList.add("waiting-page");
    this.element.append(element("p", { role: "status", text: message.text }), element("progress", { "aria-label": message.heading }));
  }
}

export class TurnPage extends Page {
  constructor(message, send) {
    super(message, send);
    this.element.classList.add("waiting-page");
    this.waited = element("p", { role: "timer" });
    this.element.append(
      html(message.html, { tabindex: "0" }),
      this.waited,
      element("progress", { "aria-label": message.heading }),
      element("footer", { class: "row" }, this.plainButton(message.button, "", () => this.leave({ type: "WentOn" }))),
    );
    this.update(message);
  }

  update(message) {
    this.message = message;
    set(this.waited, { text: message.waited });
  }
}

export class FormPage extends Page {
  constructor(message, send) {
    super(message, send);
    if (message.html) this.element.append(html(message.html));
    this.items = message.items.map((item) => new Item(this, item));
    this.count = element("p", { class: "muted", role: "status" });
    this.go = this.plainButton(message.button, "Ctrl+Enter", () => this.submit(), "main");
    const foot = element("footer", { class: "row end" }, this.count);
    if (message.back) foot.append(this.plainButton(message.back, "Alt+←", () => this.back()));
    foot.append(this.go);
    this.element.append(...this.items.map((item) => item.element), foot);
    for (const item of this.items) {
      if (item.item.id in message.answers) item.show(message.answers[item.item.id]);
      if (message.timed_out.includes(item.item.id)) item.shut();
      if (message.missing.includes(item.item.id)) item.mark(item.item.please_answer);
    }
    this.watching = new IntersectionObserver((entries) => {
      for (const entry of entries) if (entry.isIntersecting) entry.target.item.seen();
    }, { threshold: 0.99 });
    for (const item of this.items) {
      item.question.item = item;
      this.watching.observe(item.question);
    }
    this.timer = setInterval(() => this.items.forEach((item) => item.countDown((performance.now() - this.came) / 1000)), 200);
    this.showCount();
  }

  close() {
    super.close();
    this.watching.disconnect();
    clearInterval(this.timer);
  }

  start() {
    super.start();
    const first = this.items.find((item) => this.message.missing.includes(item.item.id)) ?? this.items.find((item) => item.answer === null && !item.closed);
    first?.focus();
  }

  key(event) {
    if (event.key === "Enter" && event.ctrlKey && !event.repeat) this.submit();
    if (event.key === "ArrowLeft" && event.altKey && this.message.back) {
      event.preventDefault();
      this.back();
    }
  }

  enter(item) {
    if (this.active && this.active !== item) this.active.goOn();
    this.active = item;
  }

  report(item, what, extra = {}) {
    if (what === "touched" || what === "changed") this.enter(item);
    const answer = ["changed", "given", "timed out"].includes(what) ? item.answer : null;
    this.send({ type: "ItemNews", page: this.message.page, item: item.item.id, what, window_ns: nanoseconds(), answer, ...extra });
    this.showCount();
  }

  showCount() {
    const answered = this.items.filter((item) => item.answer !== null).length;
    set(this.count, { text: [this.message.part, this.message.answered[answered]].filter(Boolean).join(" ") });
  }

  submit() {
    if (this.isNew) return;
    this.enter(null);
    const lacking = this.items.filter((item) => item.lacks);
    for (const item of this.items) item.mark(item.lacks);
    if (!lacking.length) {
      this.leave({ type: "WentOn" });
      return;
    }
    set(this.count, { text: this.message.lacking[lacking.length] });
    lacking[0].focus();
  }

  back() {
    if (this.isNew) return;
    this.enter(null);
    this.leave({ type: "WentBack" });
  }
}

class Item {
  constructor(page, item) {
    this.page = page;
    this.item = item;
    this.closed = this.touched = this.shown = this.ungiven = false;
    this.refused = false;
    this.value = null;
    const id = `item-${item.id}`;
    this.question = element("p", { class: "question-text", id });
    this.question.append(element("span", { "aria-hidden": "true", text: item.question }), element("span", { class: "unseen", text: item.spoken }));
    this.limit = element("p", { class: "muted", hidden: !item.seconds, text: item.left.at(-1) ?? "" });
    this.missing = element("p", { class: "missing", id: `${id}-missing`, role: "alert", hidden: true });
    this.field = element("div", { class: `field ${item.scale}` });
    this.element = element("section", { class: "item", role: "group", "aria-labelledby": id, "aria-describedby": `${id}-missing` }, this.question, this.limit);
    if (item.several) this.element.append(element("p", { class: "muted", text: item.several }));
    this.element.append(this.field, this.missing);
    this.#build();
    if (item.not_applicable) {
      this.refusing = this.#option(item.not_applicable, "N", () => this.#refuse(), "checkbox", "small");
      this.element.append(this.refusing);
    } else if (item.optional) this.element.append(element("p", { class: "muted", text: item.optional }));
    this.element.addEventListener("focusin", () => this.page.enter(this));
  }

  get answer() {
    return this.refused ? "not applicable" : this.value;
  }

  get lacks() {
    if (this.closed) return "";
    if (this.answer === null && this.problem) return this.problem;
    return this.answer === null && this.item.required ? this.item.please_answer : "";
  }

  focus() {
    const target = this.field.querySelector('[aria-checked="true"], input, textarea, [tabindex="0"], button');
    target?.focus({ preventScroll: true });
    this.element.scrollIntoView({ block: "nearest" });
  }

  seen() {
    if (this.shown) return;
    this.shown = true;
    this.page.report(this, "shown");
  }

  touch() {
    if (this.touched) return;
    this.touched = true;
    this.page.report(this, "touched");
  }

  changed() {
    this.ungiven = true;
    this.mark("");
    this.page.report(this, "changed");
  }

  goOn() {
    clearTimeout(this.pause);
    if (this.typing) {
      this.typing = false;
      this.changed();
    }
    if (this.ungiven && !this.closed) {
      this.ungiven = false;
      this.page.report(this, "given");
    }
  }

  mark(sentence) {
    set(this.missing, { text: sentence, hidden: !sentence });
    set(this.element, { "data-missing": !!sentence });
  }

  shut() {
    this.closed = true;
    this.ungiven = false;
    clearTimeout(this.pause);
    for (const part of this.element.querySelectorAll("button, input, textarea")) part.disabled = true;
    set(this.limit, { text: this.item.over, hidden: false });
    this.mark("");
  }

  countDown(passed) {
    if (!this.item.seconds || this.closed) return;
    const left = Math.max(Math.ceil(this.item.seconds - passed), 0);
    set(this.limit, { text: this.item.left[left] });
    if (left === 0) {
      this.typing = false;
      this.shut();
      this.page.report(this, "timed out");
      this.page.go.focus();
    }
  }

  show(answer) {
    this.refused = answer === "not applicable" && !!this.item.not_applicable;
    this.value = this.refused ? null : answer;
    this.#paint();
  }

  #set(value) {
    if (JSON.stringify(this.answer) === JSON.stringify(value)) return;
    this.refused = false;
    this.value = value;
    this.#paint();
    this.changed();
  }

  #refuse() {
    this.touch();
    this.refused = !this.refused;
    this.value = null;
    this.#paint();
    this.changed();
  }

  #paint() {
    const { scale, several } = this.item;
    for (const option of this.field.querySelectorAll("[data-value]")) {
      const value = scale === "choice" ? option.dataset.value : Number(option.dataset.value);
      const on = several ? (this.value ?? []).includes(value) : this.value === value;
      set(option, { "aria-checked": String(on) });
    }
    if (this.refusing) set(this.refusing, { "aria-checked": String(this.refused) });
    if (this.range) {
      this.range.value = this.value ?? (this.item.minimum + this.item.maximum) / 2;
      set(this.range, { "data-unmarked": this.value === null });
    }
    if (this.box && document.activeElement !== this.box) {
      this.box.value = this.value === null ? "" : this.#written(this.value);
    }
  }

  #written(value) {
    return typeof value === "number" ? String(value).replace(".", this.item.decimal) : value;
  }

  #option(label, key, press, role, weight = "plain", spoken = "") {
    const made = element("button", { type: "button", role, class: weight, "aria-checked": "false", "aria-label": spoken || null }, element("span", { class: "label", text: label }));
    made.addEventListener("click", press);
    made.addEventListener("keydown", (event) => this.#optionKey(event, made));
    return made;
  }

  #optionKey(event, made) {
    const options = [...this.field.querySelectorAll("[data-value]")];
    const step = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[event.key];
    if (step && options.includes(made)) {
      event.preventDefault();
      options[(options.indexOf(made) + step + options.length) % options.length].focus();
    } else if (/^[1-9]$/.test(event.key) && options[Number(event.key) - 1]) {
      event.preventDefault();
      options[Number(event.key) - 1].click();
      options[Number(event.key) - 1].focus();
    } else if (event.key.toUpperCase() === "N" && this.refusing && !event.ctrlKey) {
      event.preventDefault();
      this.refusing.click();
    } else if (event.key === "Enter" && !event.ctrlKey && made.getAttribute("aria-checked") === "true") {
      event.preventDefault();
      this.#next();
    }
  }

  #next() {
    const { items, go } = this.page;
    const next = items[items.indexOf(this) + 1];
    if (next) next.focus();
    else go.focus();
  }

  #build() {
    const { item, field } = this;
    if (item.scale === "likert" || item.scale === "differential") {
      const row = element("div", { class: "points", role: "radiogroup", "aria-label": item.question });
      for (const point of item.points) {
        const made = this.#option(point.label, "", () => { this.touch(); this.#set(point.value); }, "radio", "point", point.spoken);
        made.dataset.value = point.value;
        if (point.word) made.append(element("span", { class: "word", "aria-hidden": "true", text: point.word }));
        row.append(made);
      }
      field.append(row);
      if (item.ends.length) field.append(element("p", { class: "ends muted", "aria-hidden": "true" }, ...item.ends.map((end) => element("span", { text: end }))));
    } else if (item.scale === "choice") {
      const row = element("div", { class: "options", role: item.several ? "group" : "radiogroup", "aria-label": item.question });
      for (const { value, label } of item.options) {
        const made = this.#option(label, "", () => this.#choose(value), item.several ? "checkbox" : "radio");
        made.dataset.value = value;
        row.append(made);
      }
      field.append(row);
    } else if (item.scale === "analogue") {
      this.range = element("input", { type: "range", min: item.minimum, max: item.maximum, step: item.step, "aria-label": `${item.question} ${item.ends.join(" – ")}`, title: item.hint, "data-unmarked": true });
      for (const kind of ["input", "click"]) this.range.addEventListener(kind, () => { this.touch(); this.value = null; this.#set(Number(this.range.value)); });
      this.range.addEventListener("keydown", (event) => this.#rangeKey(event));
      field.append(element("div", { class: "line", "data-steps": item.ticks, style: `--steps: ${item.ticks}` }, this.range), element("p", { class: "ends muted", "aria-hidden": "true" }, ...item.ends.map((end) => element("span", { text: end }))));
    } else {
      const isText = item.scale === "text" && !item.one_line;
      this.box = isText
        ? element("textarea", { rows: 4, maxlength: 20000, "aria-label": item.question })
        : element("input", { type: "text", inputmode: item.scale === "number" ? "decimal" : "text", placeholder: item.hint ?? null, "aria-label": item.question, autocomplete: "off" });
      this.box.addEventListener("input", () => this.#typed());
      this.box.addEventListener("paste", (event) => this.page.report(this, "pasted", { characters: event.clipboardData.getData("text").length }));
      this.box.addEventListener("keydown", (event) => {
        if (event.key === "Enter" && !isText && !event.ctrlKey) this.#next();
      });
      field.append(this.box);
      if (item.unit) field.append(element("span", { class: "muted", text: ` ${item.unit}` }));
    }
  }

  // The first arrow key sets the mark in the middle, the next ones move it.
  #rangeKey(event) {
    if (event.key === "Enter" && !event.ctrlKey && this.value !== null) this.#next();
    else if (event.key.startsWith("Arrow") && this.value === null) {
      event.preventDefault();
      this.touch();
      this.#set(Number(this.range.value));
    }
  }

  #choose(value) {
    this.touch();
    if (!this.item.several) {
      this.#set(value);
      return;
    }
    const chosen = new Set(this.value ?? []);
    if (!chosen.delete(value)) chosen.add(value);
    const ordered = this.item.options.map((option) => option.value).filter((option) => chosen.has(option));
    this.#set(ordered.length ? ordered : null);
  }

  #typed() {
    this.touch();
    this.refused = false;
    if (this.refusing) set(this.refusing, { "aria-checked": "false" });
    const text = this.box.value;
    this.problem = "";
    if (this.item.scale === "number") {
      const number = Number(text.trim().replace(",", "."));
      const valid = text.trim() !== "" && Number.isFinite(number) && number >= this.item.minimum && number <= this.item.maximum;
      this.value = valid ? number : null;
      this.problem = valid || text.trim() === "" ? "" : this.item.wanted;
    } else this.value = text.trim() ? text : null;
    this.typing = true;
    clearTimeout(this.pause);
    this.pause = setTimeout(() => {
      this.typing = false;
      this.changed();
    }, PAUSE);
  }
}
