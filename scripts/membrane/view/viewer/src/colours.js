// SPDX-License-Identifier: GPL-2.0-or-later
// Colours of the sail and of its fields.

import { interpolateRdBu, interpolateViridis } from "d3-scale-chromatic";
import { Color, SRGBColorSpace } from "three";

export const TOP = 0xf2b84b; // of the film, seen from +z when flat
export const BOTTOM = 0xb9c1cc;
export const SPOOL = 0x6b7280;
export const MARK = 0xe8eaee; // on the spool, so that one sees it turn
export const TIP = 0x2b313b;
export const TIP_ON_DARK = 0xaab3bf;
export const TETHER = 0x7d8794;
export const MOUNTAIN = 0xc8322b;
export const VALLEY = 0x1f5fbf;

/** CSS colour of a share (0 to 1) of a field's range; red is pulled and blue is compressed. */
function colour(field, share) {
  return field.low < 0 ? interpolateRdBu(1 - share) : interpolateViridis(share);
}

/** The 256 colours of a field as (256, 3) linear RGB. */
export function ramp(field) {
  const table = new Float32Array(256 * 3);
  const mixed = new Color();
  for (let i = 0; i < 256; i++) {
    mixed.setStyle(colour(field, i / 255), SRGBColorSpace).toArray(table, 3 * i);
  }
  return table;
}

/** Draws the colours of a field into a canvas of one row. */
export function drawRamp(canvas, field) {
  const context = canvas.getContext("2d");
  for (let i = 0; i < canvas.width; i++) {
    context.fillStyle = colour(field, i / (canvas.width - 1));
    context.fillRect(i, 0, 1, 1);
  }
}
