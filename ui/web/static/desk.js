// The researcher's desk: draws the page that the server sends, and sends the researcher's requests.

import { element, list, set } from "./dom.js";
import { applied } from "./patches.js";

const by = (id) => document.getElementById(id);
const dialog = by("dialog");

let socket = null;
let page = null;
let retries = 0;

// The key comes in the part of the address that browsers do not send, and leaves it, so that nobody reads it there.
if (location.hash.length > 1) {
  sessionStorage.setItem("key", decodeURIComponent(location.hash.slice(1)));
  history.replaceState(null, "", location.pathname);
}

function connect() {
  const key = sessionStorage.getItem("key");
  if (!key) {
    by("key").focus();
    return;
  }
  socket = new WebSocket(`${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/desk/socket`);
  socket.addEventListener("open", () => socket.send(JSON.stringify({ t: "key", key })));
  socket.addEventListener("message", ({ data }) => receive(JSON.parse(data)));
  socket.addEventListener("close", ({ code }) => {
    if (code === 4401) {
      sessionStorage.removeItem("key");
      set(by("enter"), { hidden: false });
      set(by("desk"), { hidden: true });
      page = null;
      by("key").focus();
      return;
    }
    set(by("connection"), { hidden: false });
    setTimeout(connect, Math.min(250 * 2 ** retries++, 3000));
  });
}

function send(request) {
  if (socket?.readyState === WebSocket.OPEN) socket.send(JSON.stringify(request));
}

function receive(message) {
  if (message.t === "refused") {
    set(by("refused"), { text: message.text });
    return;
  }
  const first = page === null;
  page = applied(page, message.p);
  retries = 0;
  show();
  if (first) by("title").focus();
}

function show() {
  document.documentElement.lang = page.language;
  document.title = page.title;
  set(by("connection"), { hidden: true, text: page.lost });
  set(by("enter"), { hidden: true });
  set(by("desk"), { hidden: false });
  set(by("title"), { text: page.title });
  list(by("sentences"), page.sentences, (_, index) => index, () => element("p"), (made, text) => set(made, { text }));
  set(by("told"), { text: page.told });
  set(by("problems"), { "data-bad": page.has_problems });
  set(by("problems-heading"), { text: page.problems_heading });
  list(by("problems").querySelector("ul"), page.problems, (_, index) => index, () => element("li"), (made, text) => set(made, { text }));
  showActions(by("actions"), page.actions);
  list(by("tables"), page.tables, (_, index) => index, makeTable, showTable);
}

// The roles are those of the elements, which lose them when a narrow screen shows rows as cards.
function makeTable() {
  const made = element("section", {}, element("h2"), element("p", { class: "muted" }), element("table", { role: "table" }, element("caption", { class: "unseen" }), element("thead", { role: "rowgroup" }, element("tr", { role: "row" })), element("tbody", { role: "rowgroup" })));
  return made;
}

function showTable(made, shown) {
  set(made.querySelector("h2"), { text: shown.heading });
  set(made.querySelector("p"), { text: shown.empty, hidden: !shown.empty });
  set(made.querySelector("table"), { hidden: !shown.rows.length });
  set(made.querySelector("caption"), { text: shown.heading });
  list(made.querySelector("thead tr"), shown.columns, (name) => name, () => element("th", { scope: "col", role: "columnheader" }), (cell, text) => set(cell, { text }));
  list(made.querySelector("tbody"), shown.rows, (row) => row.key, makeRow, (row, value) => showRow(row, value, shown.columns));
}

function makeRow() {
  return element("tr", { role: "row" });
}

function showRow(made, row, columns) {
  set(made, { "data-mark": row.mark || null });
  const cells = columns.map((column, index) => ({ column, text: row.cells[index] ?? null }));
  list(made, cells, ({ column }) => column, ({ column }) => (column === columns[0] ? element("th", { scope: "row", role: "rowheader" }) : element("td", { role: "cell" })), (cell, { column, text }, index) => {
    // Codes such as P-7K3FQ do not break at their hyphen.
    set(cell, { "data-column": index ? column : null, "data-code": /^\S{1,12}$/.test(text ?? "") ? "" : null });
    if (text !== null) set(cell, { text });
    else showLast(cell, row);
  });
}

function showLast(cell, row) {
  if (!cell.firstChild) cell.append(element("div", {}, element("div", { class: "row" }), element("p", { class: "muted" }), element("code", { tabindex: "0" })));
  const [buttons, note, command] = cell.firstChild.children;
  showActions(buttons, row.actions);
  set(note, { text: row.note, hidden: !row.note });
  set(command, { text: row.command, hidden: !row.command });
}

function showActions(parent, actions) {
  list(
    parent,
    actions,
    (action) => action.request.type,
    () => {
      const made = element("button", { type: "button", class: "small" });
      made.addEventListener("click", () => (made.action.field ? ask(made.action, made) : send(made.action.request)));
      return made;
    },
    (made, action) => {
      made.action = action;
      set(made, { text: action.label, "aria-label": action.spoken === action.label ? null : action.spoken });
    },
  );
}

function ask(action, opener) {
  const field = element("textarea", { rows: 4, required: true, maxlength: 2000 });
  const cancel = element("button", { type: "button", class: "plain", text: page.cancel });
  cancel.addEventListener("click", () => dialog.close());
  const form = element(
    "form",
    {},
    element("h2", { id: "dialog-title", text: action.title }),
    element("p", { text: action.note }),
    element("label", { class: "field" }, element("span", { text: action.question }), field),
    element("footer", { class: "row end" }, cancel, element("button", { class: "main", text: action.yes })),
  );
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    send({ ...action.request, [action.field]: field.value });
    dialog.close();
  });
  dialog.replaceChildren(form);
  dialog.addEventListener("close", () => opener.isConnected && opener.focus(), { once: true });
  dialog.showModal();
  field.focus();
}

by("enter").addEventListener("submit", (event) => {
  event.preventDefault();
  sessionStorage.setItem("key", by("key").value);
  set(by("refused"), { text: "" });
  connect();
});
connect();
