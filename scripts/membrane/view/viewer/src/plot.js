// SPDX-License-Identifier: GPL-2.0-or-later
// A plot of curves over time, with a cursor that can be moved along them.

import { scaleLinear } from "d3-scale";
import { line } from "d3-shape";

import { nearest } from "./data.js";

const MARGIN = { left: 46, right: 10, top: 6, bottom: 20 };

function element(parent, name, attributes = {}, text = "") {
  const made = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  made.textContent = text;
  parent.append(made);
  return made;
}

export class Plot {
  /**
   * @param parent element to put the plot into
   * @param times of the curves [s]
   * @param curve with label, unit and lines (label, values, minor); the first line is the main one
   * @param onTime called with the time at the pointer, and with null when it leaves
   */
  constructor(parent, times, curve, onTime) {
    this.times = times;
    this.curve = curve;
    this.time = times[0];
    const all = curve.lines.flatMap(({ values }) => values);
    this.low = all.reduce((a, b) => Math.min(a, b), 0);
    this.high = all.reduce((a, b) => Math.max(a, b), 0);
    const leading = Math.floor(Math.log10(this.high - this.low || 1));
    this.decimals = Math.min(Math.max(2 - leading, 1), 20); // of the values told
    this.figure = document.createElement("figure");
    this.figure.className = "plot";
    parent.append(this.figure);
    this.addCaption();
    this.svg = element(this.figure, "svg", { role: "img", "aria-label": `${curve.label} over time` });
    const move = (event) => onTime(this.timeAt(event.offsetX));
    this.svg.addEventListener("pointermove", move);
    this.svg.addEventListener("pointerdown", move);
    this.svg.addEventListener("pointerleave", () => onTime(null));
    new ResizeObserver(() => this.draw()).observe(this.svg);
  }

  addCaption() {
    const caption = document.createElement("figcaption");
    const { label, unit, lines } = this.curve;
    const title = document.createElement("b");
    title.textContent = `${label} [${unit}]`;
    caption.append(title);
    this.readings = lines.map(({ label: name, minor }, i) => {
      const entry = document.createElement("span");
      entry.className = minor ? "minor" : "";
      const swatch = document.createElement("span");
      swatch.className = "swatch";
      swatch.style.background = `var(--line-${i})`;
      const value = document.createElement("i");
      entry.append(swatch, name, " ", value);
      caption.append(entry);
      return value;
    });
    this.figure.append(caption);
  }

  timeAt(pixel) {
    const [first, last] = this.x.domain();
    return Math.min(Math.max(this.x.invert(pixel), first), last);
  }

  /** Draws everything for the present size. */
  draw() {
    const { width, height } = this.svg.getBoundingClientRect();
    if (!width || !height) return;
    this.svg.replaceChildren();
    this.svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
    const { lines } = this.curve;
    const right = width - MARGIN.right;
    const bottom = height - MARGIN.bottom;
    this.x = scaleLinear([this.times[0], this.times.at(-1)], [MARGIN.left, right]);
    this.y = scaleLinear([this.low, this.high], [bottom, MARGIN.top]).nice(4);
    this.drawAxes(right, bottom);
    const path = line((value, i) => this.x(this.times[i]), (value) => this.y(value));
    // The main curve last, on top.
    [...lines.keys()].reverse().forEach((i) => {
      const minor = lines[i].minor ? " minor" : "";
      const style = `stroke: var(--line-${i})`;
      element(this.svg, "path", { class: `curve${minor}`, style, d: path(lines[i].values) });
    });
    this.cursor = element(this.svg, "line", { class: "cursor", y1: MARGIN.top, y2: bottom });
    this.dots = [];
    [...lines.keys()].reverse().forEach((i) => {
      const radius = lines[i].minor ? 0 : 3;
      this.dots[i] = element(this.svg, "circle", { r: radius, style: `fill: var(--line-${i})` });
    });
    this.show(this.time);
  }

  drawAxes(right, bottom) {
    for (const value of this.y.ticks(4)) {
      const y = this.y(value);
      const zero = value === 0 ? " zero" : "";
      element(this.svg, "line", { class: `grid${zero}`, x1: MARGIN.left, x2: right, y1: y, y2: y });
      const place = { x: MARGIN.left - 6, y: y + 4, "text-anchor": "end" };
      element(this.svg, "text", place, this.y.tickFormat(4)(value));
    }
    const count = Math.max(2, Math.floor((right - MARGIN.left) / 70));
    const ticks = this.x.ticks(count);
    ticks.forEach((value, i) => {
      const x = this.x(value);
      element(this.svg, "line", { class: "grid", x1: x, x2: x, y1: MARGIN.top, y2: bottom });
      const last = i === ticks.length - 1;
      const place = { x: Math.min(x, right), y: bottom + 15, "text-anchor": last ? "end" : "middle" };
      element(this.svg, "text", place, this.x.tickFormat(count)(value) + (last ? " s" : ""));
    });
  }

  /** Moves the cursor to `time` [s] and tells the values there. */
  show(time) {
    this.time = time;
    const i = nearest(this.times, time);
    this.curve.lines.forEach(({ values }, k) => {
      this.readings[k].textContent = values[i].toFixed(this.decimals).replace("-", "\u2212");
      this.dots?.[k].setAttribute("cx", this.x(this.times[i]));
      this.dots?.[k].setAttribute("cy", this.y(values[i]));
    });
    this.cursor?.setAttribute("x1", this.x(time));
    this.cursor?.setAttribute("x2", this.x(time));
  }
}
