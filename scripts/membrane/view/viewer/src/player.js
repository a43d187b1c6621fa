// SPDX-License-Identifier: GPL-2.0-or-later
// Which shape is shown: clock, slider, play and pause.

import { nearest } from "./data.js";

export class Player {
  /**
   * @param times of the shapes, rising [s]
   * @param onFrame called with the number of the shape to show
   * @param onState called with whether it plays
   */
  constructor(times, onFrame, onState) {
    this.times = times;
    this.onFrame = onFrame;
    this.onState = onState;
    this.frame = 0;
    this.speed = 1;
    this.playing = false;
  }

  /** Shows shape number `frame`, kept within what there is. */
  show(frame) {
    this.frame = Math.min(Math.max(frame, 0), this.times.length - 1);
    this.time = this.times[this.frame];
    this.onFrame(this.frame);
  }

  /** Shows the shape nearest to `time` [s]. */
  showTime(time) {
    this.show(nearest(this.times, time));
  }

  /** Plays on from the present shape, or from the first one if it is the last. */
  play() {
    if (this.playing) return;
    this.playing = true;
    if (this.frame === this.times.length - 1) this.show(0);
    this.onState(true);
    let before = null;
    const tick = (now) => {
      if (!this.playing) return;
      if (before !== null) this.advance((this.speed * (now - before)) / 1000);
      before = now;
      requestAnimationFrame(tick);
    };
    requestAnimationFrame(tick);
  }

  /** Goes on by `step` [s]; shapes between those of the run are not made up. */
  advance(step) {
    this.time += step;
    let frame = this.frame;
    while (frame < this.times.length - 1 && this.times[frame + 1] <= this.time) frame++;
    if (frame !== this.frame) {
      this.frame = frame;
      this.onFrame(frame);
    }
    if (frame === this.times.length - 1) this.pause();
  }

  pause() {
    this.playing = false;
    this.onState(false);
  }

  toggle() {
    if (this.playing) this.pause();
    else this.play();
  }
}
