// SPDX-License-Identifier: GPL-2.0-or-later
// The sail in 3-D: film, fold lines, tethers, tip masses and spool, with a camera to turn.

import {
  AmbientLight,
  BackSide,
  BoxGeometry,
  BufferAttribute,
  BufferGeometry,
  Color,
  CylinderGeometry,
  DirectionalLight,
  DynamicDrawUsage,
  FrontSide,
  Group,
  MathUtils,
  Mesh,
  MeshLambertMaterial,
  MeshStandardMaterial,
  PerspectiveCamera,
  Scene,
  SphereGeometry,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { LineMaterial } from "three/addons/lines/LineMaterial.js";
import { LineSegments2 } from "three/addons/lines/LineSegments2.js";
import { LineSegmentsGeometry } from "three/addons/lines/LineSegmentsGeometry.js";

import { BOTTOM, MARK, MOUNTAIN, ramp, SPOOL, TETHER, TIP, TIP_ON_DARK, TOP, VALLEY } from "./colours.js";

const ELEVATION = (32 * Math.PI) / 180; // of the first view, as in shapes.png
const AZIMUTH = (-65 * Math.PI) / 180;
const FIELD_OF_VIEW = 28; // degrees, of the shorter side of the picture
const { clamp } = MathUtils;
const TIP_SIZE = 0.0155; // radius as drawn, over the sail's reach; a tip mass has no size in the model

/** Lines between pairs of nodes, a few pixels wide. */
class Segments {
  constructor(pairs, width) {
    this.pairs = pairs;
    this.geometry = new LineSegmentsGeometry();
    this.geometry.setPositions(new Float32Array(3 * pairs.length));
    this.geometry.setColors(new Float32Array(3 * pairs.length));
    this.material = new LineMaterial({ linewidth: width, vertexColors: true });
    this.object = new LineSegments2(this.geometry, this.material);
    this.object.frustumCulled = false;
  }

  /** Moves the lines to the nodes at `positions` (N, 3). */
  move(positions) {
    const { data } = this.geometry.attributes.instanceStart;
    gather(positions, this.pairs, data.array);
    data.needsUpdate = true;
  }

  /** Colours each line by `of(i, colour)`, which sets a Color. */
  paint(of) {
    const { data } = this.geometry.attributes.instanceColorStart;
    const colour = new Color();
    for (let i = 0; i < this.pairs.length / 2; i++) {
      of(i, colour);
      colour.toArray(data.array, 6 * i);
      colour.toArray(data.array, 6 * i + 3);
    }
    data.needsUpdate = true;
  }
}

/** Copies the rows `ids` of `positions` (N, 3) into `target`. */
function gather(positions, ids, target) {
  for (let i = 0; i < ids.length; i++) {
    for (let k = 0; k < 3; k++) target[3 * i + k] = positions[3 * ids[i] + k];
  }
}

export class Stage {
  /**
   * @param canvas element to draw in
   * @param run as from readRun
   * @param onView called after each drawing with the pixels of 1 m
   */
  constructor(canvas, run, onView) {
    this.canvas = canvas;
    this.run = run;
    this.onView = onView;
    this.renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true });
    this.scene = new Scene();
    this.sail = new Group();
    this.scene.add(this.sail);
    this.positions = new Float32Array(3 * run.nodes);
    this.frame = 0;
    this.field = null;
    this.corotating = false;
    this.addFilm();
    this.folds = new Segments(run.creases, 1.6);
    this.cables = new Segments(run.cables, 1.6);
    this.cables.paint((i, colour) => colour.set(TETHER));
    this.sail.add(this.folds.object, this.cables.object);
    this.measure();
    this.addMasses();
    if (run.spool) this.addSpool();
    this.addCamera();
    new ResizeObserver(() => this.resize()).observe(canvas);
    this.colourBy(null);
    this.resize();
  }

  /** The film twice, seen from above and from below. */
  addFilm() {
    this.film = new BufferGeometry();
    for (const name of ["position", "color"]) {
      const attribute = new BufferAttribute(new Float32Array(3 * this.run.triangles.length), 3);
      this.film.setAttribute(name, attribute.setUsage(DynamicDrawUsage));
    }
    const faces = [FrontSide, BackSide].map((side) => {
      // Without a sheen: it would mix white into colours that mean a value.
      const material = new MeshLambertMaterial({
        side,
        vertexColors: true,
        flatShading: true,
        polygonOffset: true, // lines on the film lie in front of it
        polygonOffsetFactor: 1,
        polygonOffsetUnits: 1,
      });
      const mesh = new Mesh(this.film, material);
      mesh.frustumCulled = false;
      return mesh;
    });
    [this.top, this.bottom] = faces.map((mesh) => mesh.material);
    this.sail.add(...faces);
  }

  /** Finds how far from the middle the sail gets [m]. */
  measure() {
    let far = 0;
    for (let i = 0; i < this.run.positions.length; i += 3) {
      const [x, y, z] = this.run.positions.subarray(i, i + 3);
      far = Math.max(far, x * x + y * y + z * z);
    }
    this.reach = this.run.unit * Math.sqrt(far);
  }

  addMasses() {
    const ball = new SphereGeometry(TIP_SIZE * this.reach, 20, 12);
    const material = new MeshStandardMaterial({ roughness: 0.5 });
    const dark = matchMedia("(prefers-color-scheme: dark)");
    const suit = () => material.color.set(dark.matches ? TIP_ON_DARK : TIP);
    dark.addEventListener("change", () => {
      suit();
      this.draw();
    });
    suit();
    this.tips = this.run.tips.map(() => new Mesh(ball, material));
    this.sail.add(...this.tips);
  }

  addSpool() {
    const { radius, height } = this.run.spool;
    const body = new CylinderGeometry(radius, radius, height, 48);
    body.rotateX(Math.PI / 2);
    const mark = new BoxGeometry(radius, radius / 8, height * 1.01);
    mark.translate(0.52 * radius, 0, 0);
    this.spool = new Group();
    this.spool.add(
      new Mesh(body, new MeshStandardMaterial({ color: SPOOL, roughness: 0.6 })),
      new Mesh(mark, new MeshStandardMaterial({ color: MARK, roughness: 0.6 })),
    );
    this.sail.add(this.spool);
  }

  addCamera() {
    this.camera = new PerspectiveCamera(FIELD_OF_VIEW, 1, 0.02 * this.reach, 60 * this.reach);
    this.camera.up.set(0, 0, 1);
    this.ambient = new AmbientLight(0xffffff);
    this.key = new DirectionalLight(0xffffff);
    const { key } = this;
    this.scene.add(this.camera, this.ambient);
    key.position.set(-1.2, 1, 0.6);
    key.target.position.set(0, 0, 0);
    this.camera.add(key, key.target); // light from beside the viewer, so that folds cast shade
    this.controls = new OrbitControls(this.camera, this.canvas);
    this.controls.minDistance = 0.3 * this.reach;
    this.controls.maxDistance = 20 * this.reach;
    this.controls.addEventListener("change", () => this.draw());
    this.reset();
  }

  /** Back to the first view. */
  reset() {
    const distance = (1.04 * this.reach) / Math.tan((FIELD_OF_VIEW * Math.PI) / 360);
    const across = distance * Math.cos(ELEVATION);
    this.camera.position.set(
      across * Math.cos(AZIMUTH),
      across * Math.sin(AZIMUTH),
      distance * Math.sin(ELEVATION),
    );
    this.controls.target.set(0, 0, 0);
    this.controls.update();
    this.draw();
  }

  /** Moves the camera about the axis and up by angles, and to `share` of its distance. */
  move(about, up, share) {
    const { minDistance, maxDistance, target } = this.controls;
    const offset = this.camera.position.clone().sub(target);
    const distance = offset.length();
    const azimuth = Math.atan2(offset.y, offset.x) + about;
    // Not quite to the poles, where there is no azimuth.
    const elevation = clamp(Math.asin(offset.z / distance) + up, -1.57, 1.57);
    const across = Math.cos(elevation);
    offset.set(across * Math.cos(azimuth), across * Math.sin(azimuth), Math.sin(elevation));
    const farther = clamp(share * distance, minDistance, maxDistance);
    this.camera.position.copy(target).addScaledVector(offset, farther);
    this.controls.update();
    this.draw();
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (!width || !height) return;
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2)); // changes with the page's zoom
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    const half = Math.tan((FIELD_OF_VIEW * Math.PI) / 360) / Math.min(1, this.camera.aspect);
    this.camera.fov = (2 * Math.atan(half) * 180) / Math.PI;
    this.camera.updateProjectionMatrix();
    this.draw();
  }

  /** Pixels of 1 m across the view at its centre. */
  pixelsPerMetre() {
    const distance = this.camera.position.distanceTo(this.controls.target);
    const height = 2 * distance * Math.tan((this.camera.fov * Math.PI) / 360);
    return this.canvas.clientHeight / height;
  }

  /** Shows shape number `frame`. */
  show(frame) {
    this.frame = frame;
    const { positions, nodes, unit, turned } = this.run;
    const first = 3 * nodes * frame;
    for (let i = 0; i < 3 * nodes; i++) this.positions[i] = unit * positions[first + i];
    const corners = this.film.attributes.position;
    gather(this.positions, this.run.triangles, corners.array);
    corners.needsUpdate = true;
    this.folds.move(this.positions);
    this.cables.move(this.positions);
    this.run.tips.forEach((node, i) => {
      this.tips[i].position.fromArray(this.positions, 3 * node);
    });
    if (this.spool) this.spool.rotation.z = turned[frame];
    this.sail.rotation.z = this.corotating ? -turned[frame] : 0;
    this.paint();
    this.draw();
  }

  /** Colours the film by a field of the run; null: by the side that one sees. */
  colourBy(field) {
    this.field = field;
    // Colours that mean a value are shaded less.
    this.ambient.intensity = field ? 2.0 : 0.75;
    this.key.intensity = field ? 1.3 : 2.9;
    this.table = field && ramp(field);
    this.top.color.set(field ? 0xffffff : TOP);
    this.bottom.color.set(field ? 0xffffff : BOTTOM);
    this.film.attributes.color.array.fill(1);
    this.film.attributes.color.needsUpdate = true;
    const { creaseSigns } = this.run;
    this.folds.paint((i, colour) => colour.set(creaseSigns[i] > 0 ? MOUNTAIN : VALLEY));
    this.show(this.frame);
  }

  /** Gives the triangles, and for the crease angle the fold lines, their colours at this time. */
  paint() {
    if (!this.field) return;
    const { values, size } = this.field;
    const colours = this.film.attributes.color;
    for (let i = 0; i < size; i++) {
      const level = 3 * values[this.frame * size + i];
      for (let k = 0; k < 9; k++) colours.array[9 * i + k] = this.table[level + (k % 3)];
    }
    colours.needsUpdate = true;
    if (this.field.name === "crease_angle") {
      const angles = this.run.creaseAngles;
      this.folds.paint((i, colour) => {
        colour.fromArray(this.table, 3 * angles.values[this.frame * angles.size + i]);
      });
    }
  }

  showFolds(visible) {
    this.folds.object.visible = visible;
    this.draw();
  }

  corotate(on) {
    this.corotating = on;
    this.show(this.frame);
  }

  /** Draws once before the screen is refreshed next, however often it is asked for. */
  draw() {
    if (this.pending) return;
    this.pending = requestAnimationFrame(() => {
      this.pending = 0;
      this.renderer.render(this.scene, this.camera);
      this.onView(this.pixelsPerMetre());
    });
  }
}
