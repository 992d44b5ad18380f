// Elements of the page. All text is set as text, never as HTML, except the study's own texts, which the server has made.

export function element(tag, attributes = {}, ...children) {
  const made = document.createElement(tag);
  set(made, attributes);
  made.append(...children.filter((child) => child !== null && child !== undefined));
  return made;
}

const SVG = "http://www.w3.org/2000/svg";

export function shape(tag, attributes = {}, ...children) {
  const made = document.createElementNS(SVG, tag);
  set(made, attributes);
  made.append(...children);
  return made;
}

// Sets only what differs: an attribute that is set again can make a screen reader read it again.
export function set(target, attributes) {
  for (const [name, value] of Object.entries(attributes)) {
    if (name === "text") {
      if (target.textContent !== value) target.textContent = value;
    } else if (name === "style") {
      // As a property, because the page's policy forbids the attribute.
      if (target.styled !== value) target.style.cssText = target.styled = value ?? "";
    } else if (value === null || value === false || value === undefined) {
      target.removeAttribute(name);
    } else {
      const text = value === true ? "" : String(value);
      if (target.getAttribute(name) !== text) target.setAttribute(name, text);
    }
  }
}

// Shows a list: one child for each item, kept by its key, so that the focus stays where it is.
export function list(parent, items, key, make, show) {
  const before = new Map([...parent.children].map((child) => [child.dataset.key, child]));
  const wanted = items.map((item, index) => {
    const name = String(key(item, index));
    let child = before.get(name);
    if (child === undefined) {
      child = make(item);
      child.dataset.key = name;
    }
    before.delete(name);
    show(child, item, index);
    return child;
  });
  for (const gone of before.values()) gone.remove();
  wanted.forEach((child, index) => {
    if (parent.children[index] !== child) parent.insertBefore(child, parent.children[index] ?? null);
  });
}

// A button of the page; `act` is called with the act of the button. A button that is not possible at the moment can be
// pressed: the game then says why it is not possible.
export function button(act, weight = "plain") {
  const label = element("span", { class: "label" });
  const key = element("kbd", {});
  const hint = element("span", { class: "hint" });
  const made = element("button", { type: "button", class: weight }, label, key, hint);
  made.addEventListener("click", () => {
    if (made.shown) act(made.shown.act, made);
  });
  made.parts = { label, key, hint };
  return made;
}

export function showButton(made, shown, { hints = true } = {}) {
  made.shown = shown;
  set(made, {
    "aria-label": shown.spoken === shown.label ? null : shown.spoken,
    "aria-disabled": shown.enabled && !shown.pending ? null : "true",
    "data-pending": shown.pending,
    title: hints ? null : shown.hint || null,
  });
  set(made.parts.label, { text: shown.label });
  set(made.parts.key, { text: shown.key, hidden: !shown.key, "aria-hidden": "true" });
  set(made.parts.hint, { text: hints ? shown.hint : "", hidden: !hints || !shown.hint });
}

export function buttons(parent, shown, act, { weight = "plain", hints = true } = {}) {
  list(
    parent,
    shown,
    (each) => JSON.stringify(each.act),
    () => button(act, weight),
    (made, each) => showButton(made, each, { hints }),
  );
}
