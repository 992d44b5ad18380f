// Panel of the people in a game, and their texts. The server decides; the browser only knows what is on the screen.

import { element, list, set } from "./dom.js";

export class PeoplePanel {
  constructor(act) {
    this.act = act;
    this.page = null;
    this.restored = -1;
    this.visible = false;
    this.title = element("h2", {});
    this.news = element("button", { type: "button", class: "small news", hidden: true });
    this.news.addEventListener("click", () => this.#toEnd());
    this.team = element("ul", { class: "team" });
    this.log = element("ol", { class: "texts", tabindex: "0" });
    this.log.addEventListener("scroll", () => this.#reportRead(), { passive: true });
    this.nothing = element("p", { class: "muted nothing" });
    this.closed = element("p", { class: "muted closed" });
    this.chooser = element("select", {});
    this.chooser.addEventListener("change", () => this.act(this.page.addressees[this.chooser.selectedIndex].choose));
    this.to = element("label", { class: "to" }, element("span", { class: "muted" }), this.chooser);
    this.field = element("textarea", { rows: 2, autocomplete: "off", enterkeyhint: "send" });
    this.field.addEventListener("input", () => this.act({ act: "WriteText", text: this.field.value }));
    this.field.addEventListener("keydown", (event) => this.#key(event));
    this.button = element("button", { type: "submit", class: "main" });
    this.hint = element("p", { class: "warning", id: "people-hint", role: "status" });
    this.form = element("form", { class: "write" }, this.to, element("div", { class: "line-of-text" }, this.field, this.button), this.hint);
    this.form.addEventListener("submit", (event) => {
      event.preventDefault();
      this.#send();
    });
    this.element = element("section", { class: "people region", hidden: true }, element("header", {}, this.title, this.news), this.team, this.nothing, this.log, this.closed, this.form);
    this.switch = element("button", { type: "button", class: "people-switch", hidden: true });
    this.switch.addEventListener("click", () => {
      this.element.scrollIntoView({ block: "nearest" });
      this.#toEnd();
    });
    // Texts count as read when the list is on the screen and scrolled to its end.
    this.observer = new IntersectionObserver(([entry]) => {
      this.visible = entry.isIntersecting;
      this.element.toggleAttribute("data-seen", this.visible);
      if (this.page) this.#showSwitch();
      this.#reportRead();
    }, { threshold: 0.3 });
    this.observer.observe(this.log);
    this.onVisible = () => this.#reportRead();
    document.addEventListener("visibilitychange", this.onVisible);
  }

  close() {
    this.observer.disconnect();
    document.removeEventListener("visibilitychange", this.onVisible);
  }

  // Keys belong to the text while a person writes.
  takes(name) {
    return document.activeElement === this.field ? !["F1", "F6", "Shift+F6"].includes(name) : document.activeElement === this.chooser && !name.startsWith("F");
  }

  focus() {
    this.element.scrollIntoView({ block: "nearest" });
    (this.page?.closed ? this.log : this.field).focus();
  }

  show(page) {
    this.element.hidden = !page;
    const before = this.page;
    this.page = page;
    this.#showSwitch();
    if (!page || page === before) return;
    set(this.element, { "aria-label": page.title });
    set(this.title, { text: page.title });
    set(this.news, { text: page.news, hidden: !page.news });
    list(
      this.team,
      page.people,
      (person) => person.seat,
      () => element("li", {}, element("b", {}), element("span", { class: "presence" }), element("span", { class: "muted" })),
      (made, person) => {
        set(made, { "data-present": person.present, title: person.may || null });
        set(made.children[0], { text: person.name });
        set(made.children[1], { text: person.presence, hidden: !person.presence });
        set(made.children[2], { text: person.commands });
      },
    );
    this.#showTexts(page, before);
    set(this.nothing, { text: page.nothing, hidden: !page.nothing });
    set(this.closed, { text: page.closed, hidden: !page.closed || !page.writes });
    this.log.hidden = !page.texts.length;
    this.form.hidden = !page.writes || !!page.closed;
    this.to.hidden = !page.addressees.length;
    set(this.to.firstChild, { text: page.label });
    // The words next to it are hidden on narrow pages.
    set(this.chooser, { "aria-label": page.label });
    list(this.chooser, page.addressees, (each) => each.name, () => element("option", {}), (made, each) => set(made, { text: each.name }));
    const chosen = page.addressees.findIndex((each) => each.chosen);
    if (chosen >= 0 && this.chooser.selectedIndex !== chosen) this.chooser.selectedIndex = chosen;
    set(this.field, { "aria-label": page.prompt, placeholder: page.prompt, "aria-describedby": page.hint ? "people-hint" : null });
    // The field belongs to the person, except on a new page and after the game has put a text back.
    if (page.restored > this.restored) {
      this.field.value = page.draft;
      this.restored = page.restored;
    }
    set(this.button, { text: page.send_label, "aria-disabled": page.can_send ? null : "true" });
    set(this.hint, { text: page.hint, hidden: !page.hint });
  }

  #showTexts(page, before) {
    if (page.texts === before?.texts) return;
    const last = page.texts.at(-1);
    const follows = this.#atEnd || !!last?.pending;
    set(this.log, { "aria-label": page.messages });
    list(
      this.log,
      page.texts,
      (text, index) => (text.line ? text.line : `p${index}`),
      () => element("li", {}, element("p", { class: "who" }, element("b", {}), element("span", { class: "muted" }), element("span", { class: "mark" })), element("p", { class: "text", dir: "auto" })),
      (made, text) => {
        set(made, { "data-own": text.own, "data-new": text.new, "data-pending": text.pending });
        const [who, time, mark] = made.firstChild.children;
        set(who, { text: text.who });
        set(time, { text: text.pending ? page.sending : text.time });
        set(mark, { text: page.new, hidden: !text.new });
        set(made.lastChild, { text: text.text });
      },
    );
    this.log.hidden = !page.texts.length;
    if (follows) this.log.scrollTop = this.log.scrollHeight;
    this.#reportRead();
  }

  #showSwitch() {
    const page = this.page;
    this.switch.hidden = !page || this.visible;
    if (page) set(this.switch, { text: page.unread ? `${page.show} · ${page.unread}` : page.show, "aria-label": page.news ? `${page.show}, ${page.news}` : null, "data-news": !!page.news });
  }

  get #atEnd() {
    return this.log.hidden || this.log.scrollTop + this.log.clientHeight >= this.log.scrollHeight - 8;
  }

  #toEnd() {
    this.log.scrollTop = this.log.scrollHeight;
    this.#reportRead();
  }

  #reportRead() {
    const read = this.page?.read;
    if (!read || !this.visible || document.visibilityState !== "visible" || !this.#atEnd) return;
    if (this.reported === read.line) return;
    this.reported = read.line;
    this.act(read);
  }

  #key(event) {
    if (event.key === "Enter" && !event.shiftKey && !event.isComposing) {
      event.preventDefault();
      this.#send();
    } else if (event.key === "Escape") {
      event.stopPropagation();
      this.log.focus();
    }
  }

  #send() {
    const text = this.field.value;
    if (!text.trim()) return;
    this.field.value = "";
    this.act({ ...this.page.send, text });
    this.#toEnd();
  }
}
