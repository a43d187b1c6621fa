// SPDX-License-Identifier: GPL-2.0-or-later
// The page of a run: sail, controls, curves and tables, all showing the same time.

import { BOTTOM, drawRamp, MOUNTAIN, TOP, VALLEY } from "./colours.js";
import { readRun } from "./data.js";
import { Player } from "./player.js";
import { Plot } from "./plot.js";
import { Stage } from "./stage.js";
import { addTable } from "./tables.js";

const SPEEDS = [64, 32, 16, 8, 4, 2, 1, 1 / 2, 1 / 4, 1 / 8, 1 / 16, 1 / 32];
const PLAYED_IN = 8; // about as long as the run lasts on the screen at first [s]
const PLAY = "M3 1.5v13l11-6.5z";
const PAUSE = "M3 1.5h3.5v13H3zM9.5 1.5H13v13H9.5z";

const run = readRun("run");
const page = (id) => document.getElementById(id);
const decimals = run.times.at(-1) < 10 ? 3 : 2;

let stage = null;
try {
  stage = new Stage(page("scene"), run, showScale);
} catch (error) {
  // The curves serve without a picture, too.
  page("failure").textContent = `This browser shows no 3-D graphics here (WebGL): ${error.message}`;
  page("failure").hidden = false;
}

const plots = run.curves.map(
  (curve) => new Plot(page("curves"), run.historyTimes, curve, followPointer),
);
const player = new Player(run.times, showFrame, showState);

function showFrame(frame) {
  const time = run.times[frame];
  stage?.show(frame);
  plots.forEach((plot) => plot.show(time));
  page("clock").value = `t = ${time.toFixed(decimals)} s`;
  page("slider").value = frame;
  page("slider").setAttribute("aria-valuetext", `${time.toFixed(decimals)} s`);
}

function showState(playing) {
  const shape = playing ? PAUSE : PLAY;
  page("play").innerHTML = `<svg viewBox="0 0 16 16" aria-hidden="true"><path d="${shape}"/></svg>`;
  page("play").setAttribute("aria-label", playing ? "Pause" : "Play");
}

/** While the pointer is on a plot, the sail is that of the time there; then it plays on. */
let interrupted = false;
function followPointer(time) {
  if (time === null) {
    if (interrupted) player.play();
    interrupted = false;
    return;
  }
  if (player.playing) {
    player.pause();
    interrupted = true;
  }
  player.showTime(time);
}

/** Fits the scale bar to the view: 1, 2 or 5 times a power of ten, about 100 pixels long. */
function showScale(perMetre) {
  const power = 10 ** Math.floor(Math.log10(140 / perMetre));
  const length = [5, 2, 1].map((step) => step * power).find((size) => size * perMetre <= 140);
  const bar = page("scale-bar");
  bar.style.width = `${length * perMetre}px`;
  bar.firstElementChild.textContent = length < 1 ? `${+(length * 1e3).toPrecision(2)} mm` : `${length} m`;
}

function showField(field) {
  stage?.colourBy(field);
  const legend = page("legend");
  legend.hidden = !field;
  showKey();
  if (!field) return;
  const end = (sign, value) => `${sign}${+value.toPrecision(3)}`.replace("-", "\u2212");
  const [below, above] = field.cut ? ["\u2264 ", "\u2265 "] : ["", ""];
  legend.querySelector(".name").textContent = `${field.label} [${field.unit}]`;
  legend.querySelector(".low").textContent = end(below, field.low);
  legend.querySelector(".high").textContent = end(above, field.high);
  legend.querySelector(".meaning").textContent = field.meaning;
  drawRamp(legend.querySelector(".ramp"), field);
}

function showFolds(visible) {
  stage?.showFolds(visible);
  showKey();
}

/** Tells the film's sides apart, and mountains from valleys, where they are drawn in these colours. */
function showKey() {
  const field = stage?.field?.name;
  const lines = page("folds").checked && field !== "crease_angle" && run.creases.length > 0;
  page("key-sides").hidden = Boolean(field);
  page("key-folds").hidden = !lines;
}

function addOptions(select, options) {
  select.append(...options.map(([text, value, chosen]) => new Option(text, value, chosen, chosen)));
}

function setUpControls() {
  page("slider").max = run.frames - 1;
  page("slider").addEventListener("input", (event) => {
    player.pause();
    player.show(Number(event.target.value));
  });
  page("play").addEventListener("click", () => player.toggle());
  const wanted = (run.times.at(-1) - run.times[0]) / PLAYED_IN;
  player.speed = SPEEDS.find((speed) => speed <= wanted) ?? SPEEDS.at(-1);
  addOptions(
    page("speed"),
    SPEEDS.map((speed) => [speed < 1 ? `1/${1 / speed}` : `${speed}`, speed, speed === player.speed]),
  );
  page("speed").addEventListener("change", (event) => (player.speed = Number(event.target.value)));
  if (!run.spool) {
    page("corotate-name").textContent = "turn with the sail";
    page("corotate-name").parentElement.title = "Show the sail as seen from a frame that turns as it does";
  }
  addOptions(page("field"), [
    ["top and bottom", -1, true],
    ...run.fields.map(({ label }, i) => [label, i, false]),
  ]);
  page("field").addEventListener("change", (event) => showField(run.fields[event.target.value] ?? null));
  page("folds").addEventListener("change", (event) => showFolds(event.target.checked));
  page("corotate").addEventListener("change", (event) => stage?.corotate(event.target.checked));
  page("reset").addEventListener("click", () => stage?.reset());
  window.addEventListener("keydown", onKey);
}

const TURN = Math.PI / 36; // by a key
const ZOOM = 1.1;
const KEYS = {
  " ": () => player.toggle(),
  ArrowLeft: () => step(-1),
  ArrowRight: () => step(1),
  Home: () => step(-Infinity),
  End: () => step(Infinity),
  "+": () => stage?.move(0, 0, 1 / ZOOM),
  "-": () => stage?.move(0, 0, ZOOM),
};
const KEYS_WITH_SHIFT = {
  ArrowLeft: () => stage?.move(-TURN, 0, 1),
  ArrowRight: () => stage?.move(TURN, 0, 1),
  ArrowUp: () => stage?.move(0, TURN, 1),
  ArrowDown: () => stage?.move(0, -TURN, 1),
  "+": KEYS["+"], // needs it on many keyboards
};

function step(frames) {
  player.pause();
  player.show(player.frame + frames);
}

/** Keys act unless they belong to the control that has the focus. */
function onKey(event) {
  const act = (event.shiftKey ? KEYS_WITH_SHIFT : KEYS)[event.key];
  if (!act || event.altKey || event.ctrlKey || event.metaKey) return;
  const { target, key, shiftKey } = event;
  const pressed = target.matches("button, input[type=checkbox]") && key === " ";
  const slides = target.matches("input[type=range]") && key !== " " && !shiftKey;
  if (pressed || slides || target.matches("select")) return;
  event.preventDefault();
  act();
}

const KEY = {
  "key-sides": [
    ["top", TOP],
    ["bottom", BOTTOM],
  ],
  "key-folds": [
    ["mountain", MOUNTAIN],
    ["valley", VALLEY],
  ],
};

function setUpKey() {
  for (const [id, entries] of Object.entries(KEY)) {
    for (const [name, colour] of entries) {
      const entry = document.createElement("span");
      const swatch = document.createElement("span");
      swatch.className = "swatch";
      swatch.style.background = `#${colour.toString(16).padStart(6, "0")}`;
      entry.append(swatch, name);
      page(id).append(entry);
    }
  }
}

document.title = `Sail: ${run.name}`;
setUpControls();
setUpKey();
showKey();
run.tables.forEach((table) => addTable(page("tables"), table));
showState(false);
player.show(0);
