import { Vector3 } from 'three';

import { axisTexts, placeTexts } from '../core/labels.js';
import { cornersOf, toDisplay } from '../core/placement.js';

/** The axes' names and numbers as text over the canvas, so that they stay sharp and follow the page's colours. */
export class AxisLabels {
  #layer;
  #obstacles;
  #corners = [];
  #texts = []; // of each axis three elements
  #sizes = [];

  /** layer   an element that covers the canvas.  obstacles   elements over it that nothing may stand under. */
  constructor(layer, obstacles) {
    this.#layer = layer;
    this.#obstacles = obstacles;
  }

  place(frame, display) {
    this.#corners = cornersOf(frame.dims).map((corner) => new Vector3(...toDisplay(display, corner)));
    this.#texts = axisTexts(frame).map((texts) => texts.map((text, at) => {
      const element = document.createElement('span');
      element.className = at === 1 ? 'axis-name' : 'axis-tick';
      element.textContent = text;
      return element;
    }));
    this.#layer.replaceChildren(...this.#texts.flat());
    this.#sizes = this.#texts.map((texts) => texts.map(({ offsetWidth, offsetHeight }) => [offsetWidth, offsetHeight]));
  }

  /** Puts the texts where there is room for them. */
  follow(camera, world, width, height) {
    const corners = this.#corners.map((corner) => world.localToWorld(corner.clone()));
    const screen = corners.map((corner) => {
      const isBehind = corner.clone().applyMatrix4(camera.matrixWorldInverse).z > -camera.near;
      const { x, y } = corner.clone().project(camera);
      return isBehind ? null : [((x + 1) / 2) * width, ((1 - y) / 2) * height];
    });
    if (this.#texts.length === 0) return;
    const places = placeTexts({
      corners: corners.map((corner) => corner.toArray()), eye: camera.position.toArray(), screen, sizes: this.#sizes,
      view: [width, height], taken: this.#taken(),
    });
    for (const [axis, texts] of this.#texts.entries()) {
      for (const [at, element] of texts.entries()) show(element, places[axis][at]);
    }
  }

  #taken() {
    const { left: x, top: y } = this.#layer.getBoundingClientRect();
    return this.#obstacles.filter(({ hidden }) => !hidden).map((element) => {
      const { left, top, right, bottom } = element.getBoundingClientRect();
      return { left: left - x, top: top - y, right: right - x, bottom: bottom - y };
    });
  }
}

/** By visibility, for what is not displayed has no size. */
function show(element, middle) {
  element.style.visibility = middle ? 'visible' : 'hidden';
  if (middle) element.style.transform = `translate(${middle.map((at) => `${at.toFixed(1)}px`).join(', ')}) translate(-50%, -50%)`;
}
