import { BufferAttribute, BufferGeometry, LineBasicMaterial, LineSegments } from 'three';

import { BOX_EDGES, cornersBetween, cornersOf, toDisplay } from '../core/placement.js';

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
    const corners = cornersBetween(bounds);
    replaceLines(this, BOX_EDGES.flat().flatMap((corner) => corners[corner]));
  }
}

function replaceLines(lines, positions) {
  lines.geometry.dispose();
  lines.geometry = new BufferGeometry();
  lines.geometry.setAttribute('position', new BufferAttribute(new Float32Array(positions), 3));
}
