import { BufferAttribute, BufferGeometry, LineBasicMaterial, LineSegments, Vector3 } from 'three';

import { axisLabels, BOX_EDGES, cornersOf, toDisplay } from '../core/placement.js';

/** The survey's outline. */
export class SurveyBox extends LineSegments {
  constructor() {
    super(new BufferGeometry(), new LineBasicMaterial({ transparent: true, opacity: 0.55 }));
  }

  set color(color) {
    this.material.color.set(color);
  }

  place(dims, display) {
    const corners = cornersOf(dims).map((corner) => toDisplay(display, corner));
    replaceLines(this, BOX_EDGES.flat().flatMap((corner) => corners[corner]));
  }
}

/** The outline of the body that is singled out, so that a small one is found. */
export class BodyBox extends LineSegments {
  constructor() {
    super(new BufferGeometry(), new LineBasicMaterial());
    this.visible = false;
  }

  set color(color) {
    this.material.color.set(color);
  }

  /** bounds   {low, high} on the display, or null for none. */
  place(bounds) {
    this.visible = bounds !== null;
    if (!bounds) return;
    const corner = (number) => [0, 1, 2].map((axis) => ((number >> axis) & 1 ? bounds.high : bounds.low)[axis]);
    replaceLines(this, BOX_EDGES.flat().flatMap(corner));
  }
}

function replaceLines(lines, positions) {
  lines.geometry.dispose();
  lines.geometry = new BufferGeometry();
  lines.geometry.setAttribute('position', new BufferAttribute(new Float32Array(positions), 3));
}

/** The axes' names and numbers as text over the canvas, so that they stay sharp and follow the page's colours. */
export class AxisLabels {
  #layer;
  #labels = [];

  /** layer   an element that covers the canvas. */
  constructor(layer) {
    this.#layer = layer;
  }

  place(frame, display) {
    this.#labels = axisLabels(frame).map(({ text, at, kind }) => {
      const element = document.createElement('span');
      element.className = `axis-${kind}`;
      element.textContent = text;
      return { element, point: new Vector3(...toDisplay(display, at)) };
    });
    this.#layer.replaceChildren(...this.#labels.map(({ element }) => element));
  }

  /** Puts the texts where their points are. */
  follow(camera, world, width, height) {
    for (const { element, point } of this.#labels) {
      const seen = world.localToWorld(point.clone()).project(camera);
      const x = ((seen.x + 1) / 2) * width;
      const y = ((1 - seen.y) / 2) * height;
      element.style.transform = `translate(-50%, -50%) translate(${x.toFixed(1)}px, ${y.toFixed(1)}px)`;
      element.hidden = seen.z > 1;
    }
  }
}
