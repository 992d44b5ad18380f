// Plots of values over time, as SVG. All plots have the same time axis and the same cursor.

import { element, list, set, shape } from "../../static/dom.js";
import { clock, Curve } from "./recording.js";

const LEFT = 44; // Space for the labels of the values.
const BELOW = 22;
const ABOVE = 8;
const HEIGHT = 168;
const ROW = 26; // Height of a robot's row in the plot of drives.

// All plots of a game for which the recording has data.
export function plotsOf(game, words) {
  const robots = game.robots.map((robot, index) => ({ robot, index, name: robot.name }));
  const curves = (name, units) =>
    robots.filter((each) => each.robot[name]).map((each) => ({ ...each, curve: new Curve(each.robot[name], units) }));
  const made = [];
  if (robots.some((each) => each.robot.drives.length)) made.push(new Drives(game, robots, words));
  if (game.score) {
    const score = { name: words.score, index: null, curve: new Curve(game.score, [1, 1]), column: 0 };
    made.push(new Values(game, words, { title: words.score_plot, unit: words.unit_points, digits: 0, held: true }, [score]));
  }
  const energies = curves("energy", [0.1]).map((each) => ({ ...each, column: 0 }));
  if (energies.length) {
    made.push(new Values(game, words, { title: words.energy_plot, unit: words.unit_units, digits: 1, held: true, least: 0 }, energies));
  }
  const bands = curves("deviation", [0.1, 0.01]);
  for (const [column, name, unit] of [[0, "error", words.unit_cm], [1, "heading", words.unit_degrees]]) {
    const errors = curves("error", [0.1, 0.01]).map((each) => ({
      ...each,
      column,
      band: bands.find((band) => band.index === each.index)?.curve,
    }));
    if (!errors.length) continue;
    const note = errors.some((each) => each.band) ? words[`${name}_note`] : "";
    made.push(new Values(game, words, { title: words[`${name}_plot`], note, unit, digits: column + 1, least: 0 }, errors));
  }
  return made;
}

class Plot {
  constructor(game, words, title, unit, note, height) {
    Object.assign(this, { game, words, height, span: { from: 0, to: game.duration } });
    this.svg = shape("svg", { class: "plot", role: "img", "aria-label": title });
    this.values = element("ul", { class: "values" });
    const heading = element("h3", { text: title }, unit ? element("span", { class: "muted", text: ` ${unit}` }) : null);
    this.element = element("figure", {}, element("figcaption", {}, heading, this.values), this.svg);
    if (note) this.element.append(element("p", { class: "note muted", text: note }));
  }

  // Draws everything for a width in pixels.
  draw(width) {
    this.width = width;
    this.right = width - 10;
    set(this.svg, { viewBox: `0 0 ${width} ${this.height}`, height: this.height });
    this.cursor = shape("line", { class: "cursor", y1: ABOVE, y2: this.height - BELOW });
    const parts = [...this.timeAxis(), ...this.drawn()];
    const isFrame = (part) => ["grid", "tick"].includes(part.getAttribute("class"));
    // An inner picture, which cuts off what is before and after the shown time.
    const [inner, height] = [this.right - LEFT, this.height];
    const box = { x: LEFT, width: inner, height, viewBox: `${LEFT} 0 ${inner} ${height}`, preserveAspectRatio: "none" };
    const content = shape("svg", box, ...parts.filter((part) => !isFrame(part)), this.cursor);
    this.svg.replaceChildren(...parts.filter(isFrame), content);
  }

  x(time) {
    const { from, to } = this.span;
    return LEFT + ((time - from) / Math.max(to - from, 1e-3)) * (this.right - LEFT);
  }

  time(x) {
    const { from, to } = this.span;
    const share = Math.min(Math.max((x - LEFT) / (this.right - LEFT), 0), 1);
    return from + share * (to - from);
  }

  timeAxis() {
    const steps = [1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 900, 1800, 3600, 7200];
    const most = Math.max(2, (this.right - LEFT) / 80);
    const { from, to } = this.span;
    const step = steps.find((each) => (to - from) / each <= most) ?? (to - from) / most;
    const ticks = [];
    for (let time = Math.ceil(from / step - 1e-6) * step; time <= to + 1e-6; time += step) ticks.push(time);
    return ticks.flatMap((time) => [
      shape("line", { class: "grid", x1: this.x(time), x2: this.x(time), y1: ABOVE, y2: this.height - BELOW }),
      shape("text", { class: "tick", x: this.x(time), y: this.height - 6, "text-anchor": "middle", text: clock(time) }),
    ]);
  }

  showAt(time) {
    const x = this.x(time).toFixed(1);
    set(this.cursor, { x1: x, x2: x });
    list(
      this.values,
      this.valuesAt(time),
      (value) => value.key,
      () => element("li", {}, element("i", {}), element("span", {}), element("b", {})),
      (made, value) => {
        set(made, { style: value.index === null ? null : `--robot: var(--robot${value.index % 10})` });
        set(made.children[0], { hidden: value.index === null });
        set(made.children[1], { text: value.name });
        set(made.children[2], { text: value.text });
      },
    );
  }
}

class Values extends Plot {
  constructor(game, words, { title, unit, digits, note = "", held = false, least = null }, series) {
    super(game, words, title, unit, note, HEIGHT);
    Object.assign(this, { digits, held, series });
    const ends = series.flatMap(({ curve, column }) => extent(curve.values[column]));
    // A band is cut where it is much wider than the errors.
    const most = Math.max(...ends);
    const bands = series.flatMap(({ band, column }) => (band ? extent(band.values[column]) : []));
    const high = Math.max(most, Math.min(Math.max(...bands, 0), 3 * most));
    this.scale = scaleOf(Math.min(least ?? Math.min(...ends), 0), high);
  }

  y(value) {
    const { low, high } = this.scale;
    const share = (Math.min(value, high) - low) / (high - low);
    return this.height - BELOW - share * (this.height - BELOW - ABOVE);
  }

  drawn() {
    const parts = this.scale.ticks.flatMap((tick) => [
      shape("line", { class: "grid", x1: LEFT, x2: this.right, y1: this.y(tick), y2: this.y(tick) }),
      shape("text", { class: "tick", x: LEFT - 8, y: this.y(tick) + 4, "text-anchor": "end", text: tick.toLocaleString(document.documentElement.lang) }),
    ]);
    for (const { index, curve, column, band } of this.series) {
      const style = index === null ? null : `--robot: var(--robot${index % 10})`;
      if (band) parts.push(shape("path", { class: "band", style, d: this.#band(band, column) }));
      parts.push(shape("path", { class: "line", style, d: this.held ? this.#steps(curve, column) : this.#line(curve, column) }));
    }
    return parts;
  }

  valuesAt(time) {
    return this.series.map(({ index, name, curve, column }) => {
      const inside = time >= curve.times[0];
      const value = inside ? (this.held ? curve.held(time) : curve.at(time))[column] : null;
      return { key: String(index), index, name, text: value === null ? this.words.no_value : number(value, this.digits) };
    });
  }

  // A line with at most the first, least, greatest and last value in each column of pixels.
  #line(curve, column) {
    const points = [];
    let from = Math.max(curve.last(this.span.from), 0);
    const end = Math.min(curve.last(this.span.to) + 2, curve.length);
    const values = curve.values[column];
    while (from < end) {
      const pixel = Math.round(this.x(curve.times[from]));
      let [low, high, to] = [from, from, from];
      for (; to + 1 < end && Math.round(this.x(curve.times[to + 1])) === pixel; to++) {
        if (values[to + 1] < values[low]) low = to + 1;
        if (values[to + 1] > values[high]) high = to + 1;
      }
      for (const index of [...new Set([from, low, high, to])].sort((one, other) => one - other)) {
        points.push(`${this.x(curve.times[index]).toFixed(1)} ${this.y(values[index]).toFixed(1)}`);
      }
      from = to + 1;
    }
    return `M${points.join("L")}`;
  }

  #steps(curve, column) {
    let path = "";
    curve.times.forEach((time, index) => {
      const [x, y] = [this.x(time).toFixed(1), this.y(curve.values[column][index]).toFixed(1)];
      path += index ? `H${x}V${y}` : `M${x} ${y}`;
    });
    return `${path}H${this.x(this.game.duration).toFixed(1)}`;
  }

  #band(band, column) {
    const base = this.y(0).toFixed(1);
    return `${this.#steps(band, column)}V${base}H${this.x(band.times[0]).toFixed(1)}Z`;
  }
}

class Drives extends Plot {
  constructor(game, robots, words) {
    super(game, words, words.drives, "", robots.some(({ robot }) => robot.drives.some((drive) => !drive.arrived)) ? words.drives_note : "", 0);
    this.robots = robots;
    this.height = ABOVE + ROW * robots.length + BELOW;
    this.element.classList.add("wide");
  }

  drawn() {
    return this.robots.flatMap(({ robot, index }) => {
      const style = `--robot: var(--robot${index % 10})`;
      const y = ABOVE + ROW * index;
      const label = shape("text", { class: "tick", x: LEFT - 8, y: y + ROW / 2 + 4, "text-anchor": "end", text: String(index + 1) });
      return [label, ...robot.drives.flatMap((drive) => {
        const [from, to] = [this.x(drive.start), this.x(drive.end)];
        const bar = shape("rect", { class: "drive", style, x: from, y: y + 3, width: Math.max(to - from - 1, 1), height: ROW - 6, rx: 3, "data-arrived": drive.arrived });
        bar.append(shape("title", { text: drive.text }));
        if (!drive.label || to - from < 10 + 8 * drive.label.length) return [bar];
        return [bar, shape("text", { class: "label", x: (from + to) / 2, y: y + ROW / 2 + 4, "data-arrived": drive.arrived, text: drive.label })];
      })];
    });
  }

  valuesAt(time) {
    return this.robots.map(({ robot, index, name }) => {
      const phase = robot.phases.findLast((each) => each.at <= time);
      return { key: String(index), index, name, text: phase?.text ?? this.words.no_value };
    });
  }
}

export function number(value, digits) {
  // A minus sign before zero would look like a mistake.
  const rounded = Number(value.toFixed(digits)) || 0;
  return rounded.toLocaleString(document.documentElement.lang, { minimumFractionDigits: digits, maximumFractionDigits: digits });
}

// Round numbers on an axis from `least` to at least `most`.
function scaleOf(least, greatest) {
  // The axis is coarse enough that rounding does not look like a change.
  const most = Math.max(greatest, least + 1);
  const rough = (most - least) / 4;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((each) => each * power).find((each) => each >= rough);
  const low = Math.floor(least / step + 1e-9) * step;
  const high = Math.max(Math.ceil(most / step - 1e-9) * step, low + step);
  const ticks = [];
  for (let index = 0; low + index * step <= high + step * 1e-6; index++) ticks.push(Number((low + index * step).toPrecision(12)));
  return { low, high, ticks };
}

function extent(values) {
  let [low, high] = [Infinity, -Infinity];
  for (const value of values) {
    low = Math.min(low, value);
    high = Math.max(high, value);
  }
  return values.length ? [low, high] : [];
}
