// SPDX-License-Identifier: GPL-2.0-or-later
// The results of a run, as report.py packed them, as typed arrays.

/** Bytes of a base64 string. */
function bytes(text) {
  return Uint8Array.from(atob(text), (character) => character.charCodeAt(0)).buffer;
}

/** Levels (0 to 255) of S frames of a field. */
function levels({ data, ...about }, frames) {
  const values = new Uint8Array(bytes(data));
  return { ...about, values, size: values.length / frames };
}

/** Reads the run in the page's element `id`. Lengths in m, times in s. */
export function readRun(id) {
  const run = JSON.parse(document.getElementById(id).textContent);
  const frames = run.times.length;
  const positions = new Int16Array(bytes(run.positions.data));
  return {
    ...run,
    frames,
    nodes: positions.length / (3 * frames),
    unit: run.positions.unit,
    positions,
    triangles: new Uint32Array(bytes(run.triangles)),
    creases: new Uint32Array(bytes(run.creases)),
    cables: new Uint32Array(bytes(run.cables)),
    creaseAngles: levels(run.creaseAngles, frames),
    fields: run.fields.map((field) => levels(field, frames)),
  };
}

/** Index of the entry of the rising array `sorted` that is nearest to `value`. */
export function nearest(sorted, value) {
  let low = 0;
  let high = sorted.length - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (sorted[middle] <= value) low = middle;
    else high = middle;
  }
  return value - sorted[low] <= sorted[high] - value ? low : high;
}
