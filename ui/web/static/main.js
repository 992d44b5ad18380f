// Connects the page with the server, and shows what it sends: pages of the study, and the game.

import { element, set } from "./dom.js";
import { ConsentPage, FormPage, TextPage, TurnPage, WaitPage } from "./study.js";

const PAGES = { text: TextPage, recorded: TextPage, consent: ConsentPage, wait: WaitPage, turn: TurnPage, form: FormPage };
const main = document.getElementById("main");
const strip = document.getElementById("strip");
const connection = document.getElementById("connection");
const settings = document.getElementById("settings");
const sheet = document.getElementById("sheet");

let words = {};
let socket = null;
let page = null;
let game = null;
let retries = 0;
let instructions = [];
let ended = false;

// The first pages do not need the modules of games, so these load while the person reads.
let GamePage = null;
const held = []; // Messages of and after a game that came before its modules, in their order.
import("./game.js").then((module) => {
  GamePage = module.GamePage;
  held.splice(0).forEach(receive);
});

// A page that connects again is the same tab, also after its network address has changed.
const tab = [...crypto.getRandomValues(new Uint8Array(8))].map((byte) => byte.toString(16).padStart(2, "0")).join("");

const SILENCE = 6000; // Milliseconds without any message of the server after which the connection counts as lost.
const outbox = []; // Messages that the server has not confirmed, in their order.
let confirmed = 0; // Number of messages that it has confirmed.
let heardAt = 0;

function send(message) {
  outbox.push(JSON.stringify(message));
  transmit(outbox.at(-1));
}

function transmit(text) {
  if (socket?.readyState === WebSocket.OPEN) socket.send(text);
}

function confirm(number) {
  outbox.splice(0, number - confirmed);
  confirmed = number;
}

function connect() {
  const address = `${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/socket?tab=${tab}&first=${confirmed}`;
  const made = (socket = new WebSocket(address));
  heardAt = performance.now();
  made.addEventListener("open", () => {
    if (made !== socket) return;
    retries = 0;
    connection.hidden = true;
    outbox.forEach(transmit);
    send({ type: "FocusNews", has_focus: document.hasFocus(), window_ns: Math.round(performance.now() * 1e6) });
  });
  made.addEventListener("message", ({ data }) => {
    if (made !== socket) return;
    heardAt = performance.now();
    const message = JSON.parse(data);
    if (message.t !== "ping" && (held.length || (message.t === "game" && !GamePage))) held.push(message);
    else receive(message);
  });
  made.addEventListener("close", ({ code }) => {
    if (made !== socket || ended) return;
    if (code !== 4403) lose();
    // The server no longer knows this page, unless it never knew it: then the browser does not keep the cookie.
    else if (Object.keys(words).length) location.reload();
    else {
      ended = true;
      set(connection, { text: connection.dataset.cookies, hidden: false });
    }
  });
}

// Give up the connection, and connect again.
function lose(delay = Math.min(250 * 2 ** retries++, 3000)) {
  socket?.close();
  socket = null;
  connection.hidden = false;
  setTimeout(() => socket ?? connect(), delay);
}

// A network that is gone closes no connection.
setInterval(() => socket && !ended && performance.now() - heardAt > SILENCE && lose(0), 1000);
window.addEventListener("online", () => !ended && lose(0));

function receive(message) {
  switch (message.t) {
    case "ping":
      confirm(message.heard);
      transmit(JSON.stringify({ t: "pong", at: message.at, visible: document.visibilityState === "visible" }));
      break;
    case "words":
      words = message.words;
      document.documentElement.lang = message.language;
      break;
    case "floor":
    case "picture":
    case "page":
      game?.receive(message);
      break;
    case "game":
      showGame(message);
      break;
    case "news":
      showNews(message);
      break;
    case "instructions":
      instructions = message.html;
      showStrip();
      break;
    case "message":
      showMessage(message);
      break;
    case "kept":
      break;
    case "elsewhere":
      words = message.words;
      replace(new TextPage(message, () => send({ t: "take over" })));
      page.start();
      break;
    case "stopped":
    case "closed":
      ended = message.t === "closed";
      showPage({ t: "text", page: 0, heading: message.heading ?? "", html: message.html ?? "", button: "", code: null, ending: null, step: "", share: 0 });
      break;
    case "recorded":
      if (game && game.page?.phase === "over" && page?.message.page === message.page) break;
      showPage(message);
      break;
    default:
      showPage(message);
  }
}

// A message of the researcher stays above all pages until the person closes it.
function showMessage({ heading, text, close }) {
  const shown = document.getElementById("message");
  const button = element("button", { type: "button", class: "small", text: close });
  button.addEventListener("click", () => {
    shown.replaceChildren();
    main.focus();
    send({ type: "MessageClosed" });
  });
  shown.replaceChildren(element("section", { class: "notice" }, element("h2", { text: heading }), element("p", { class: "prose", text }), button));
}

// A person who waits may look at another tab: a sound and the tab's title call them back.
function callBack() {
  import("./sounds.js").then(({ play }) => play("question"));
  const title = document.title;
  document.title = `● ${title}`;
  window.addEventListener("focus", () => (document.title = title), { once: true });
}

function replace(next) {
  if (page?.message?.t === "turn" && !document.hasFocus()) callBack();
  page?.close();
  game?.close();
  game = null;
  page = next;
  main.replaceChildren(next.element);
  showStrip();
}

function isShown(message) {
  return message.page > 0 && page?.message.t === message.t && page.message.page === message.page;
}

function showPage(message) {
  if (isShown(message)) {
    // After a lost connection, the page has answers that the server does not have yet.
    page.update?.(message);
    return;
  }
  replace(new PAGES[message.t](message, send));
  page.start();
}

function showGame(message) {
  if (isShown(message)) return;
  const shown = new GamePage(words, send, openSettings);
  replace({ element: shown.element, message, close() {} });
  game = shown;
  showNews({ ...message, left: "", near: false });
}

let news = null;

function showNews(message) {
  news = message;
  showStrip();
  if (message.warn) set(document.getElementById("announcer"), { text: message.left });
}

function showStrip() {
  const message = page?.message ?? {};
  const shown = [];
  const acts = [];
  // The address must not show who the person is. When they have begun, the server knows them without it.
  if (message.step && location.search) history.replaceState(null, "", location.pathname);
  if (message.step) shown.push(element("span", { class: "muted", text: message.step }), element("progress", { value: message.share, max: 1, "aria-label": message.step }));
  if (game && news?.left) shown.push(element("span", { class: news.near ? "near" : "muted", text: news.left }));
  if (game && message.practice && news) {
    const back = element("button", { type: "button", class: "small", text: message.back, "aria-disabled": news.done ? null : "true" });
    back.addEventListener("click", () => news.done && send({ type: "WentOn", page: message.page }));
    shown.push(element("span", { class: "to-do" }, element("span", { text: news.to_do }), back));
  }
  if (instructions.length) acts.push(stripButton("kiosk.read_again", readAgain, "kiosk.read_again_name"));
  // A game has its own button for the settings.
  if (!game) acts.push(stripButton("settings.title", openSettings));
  if (message.step) acts.push(stripButton("kiosk.stop", askToStop, "kiosk.stop_name"));
  strip.replaceChildren(element("div", { class: "news", hidden: !shown.length }, ...shown), element("div", { class: "acts", hidden: !acts.length }, ...acts));
  strip.hidden = !shown.length && !acts.length;
}

function stripButton(key, press, spoken = null) {
  const made = element("button", { type: "button", class: "quiet", text: words[key] ?? "", "aria-label": spoken ? words[spoken] : null });
  made.addEventListener("click", press);
  return made;
}

function openSheet(...parts) {
  sheet.replaceChildren(...parts);
  if (!sheet.open) sheet.showModal();
}

function closer(key, press = () => {}) {
  const made = element("button", { type: "button", class: "plain", text: words[key] });
  made.addEventListener("click", () => {
    sheet.close();
    press();
  });
  return made;
}

function readAgain() {
  const body = element("div", { class: "body prose", tabindex: "0" });
  body.innerHTML = instructions.join("<hr>"); // Made by the server, as in study.js.
  send({ type: "InstructionsNews", is_open: true, window_ns: Math.round(performance.now() * 1e6) });
  openSheet(element("h2", { text: words["pages.instructions"] }), body, element("footer", { class: "row end" }, closer("popups.close")));
  sheet.addEventListener("close", () => send({ type: "InstructionsNews", is_open: false, window_ns: Math.round(performance.now() * 1e6) }), { once: true });
}

function askToStop() {
  openSheet(
    element("h2", { text: words["kiosk.leave"] }),
    element("p", { text: words["kiosk.leave_text"] }),
    element("footer", { class: "row end" }, closer("kiosk.stop", () => send({ type: "StoppedTakingPart" })), closer("kiosk.go_on")),
  );
}

// Settings ------------------------------------------------------------------------------------------------------------

const SIZES = [80, 90, 100, 115, 130, 150, 175, 200];

function apply() {
  document.documentElement.dataset.look = localStorage.getItem("look") ?? "system";
  document.documentElement.style.fontSize = `${localStorage.getItem("size") ?? 100}%`;
}

function choice(label, options, current, choose) {
  const chooser = element("select", {});
  for (const [value, text] of options) chooser.append(element("option", { value, text, selected: value === current }));
  chooser.addEventListener("change", () => choose(chooser.value));
  return element("label", { class: "row" }, element("span", { text: label }), chooser);
}

function soundChoice(choose) {
  const box = element("input", { type: "checkbox", checked: localStorage.getItem("sound") !== "off" });
  box.addEventListener("change", () => choose(box.checked ? "on" : "off"));
  return element("label", { class: "row" }, box, element("span", { text: words["settings.sound_on"] }));
}

function openSettings() {
  const keep = (name) => (value) => {
    localStorage.setItem(name, value);
    apply();
  };
  const close = element("button", { type: "button", class: "main", text: words["settings.close"] });
  close.addEventListener("click", () => settings.close());
  settings.replaceChildren(
    element("h2", { text: words["settings.title"] }),
    choice(words["settings.look"], [["system", words["settings.look_system"]], ["light", words["settings.look_light"]], ["dark", words["settings.look_dark"]]], localStorage.getItem("look") ?? "system", keep("look")),
    choice(words["settings.text_size"], SIZES.map((size) => [String(size), `${size} %`]), localStorage.getItem("size") ?? "100", keep("size")),
    soundChoice(keep("sound")),
    element("footer", { class: "row end" }, close),
  );
  settings.showModal();
}

document.addEventListener("keydown", (event) => {
  const size = Number(localStorage.getItem("size") ?? 100);
  if (!event.ctrlKey) return;
  const at = SIZES.indexOf(size);
  const next = { "+": SIZES[at + 1], "-": SIZES[at - 1], 0: 100 }[event.key];
  if (next) {
    event.preventDefault();
    localStorage.setItem("size", next);
    apply();
  }
});
for (const [kind, focus] of [["focus", true], ["blur", false]]) {
  window.addEventListener(kind, () => send({ type: "FocusNews", has_focus: focus, window_ns: Math.round(performance.now() * 1e6) }));
}
document.addEventListener("visibilitychange", () => send({ type: "FocusNews", has_focus: document.visibilityState === "visible" && document.hasFocus(), window_ns: Math.round(performance.now() * 1e6) }));

apply();
document.getElementById("too-old").remove(); // The page's modules run.
connect();
