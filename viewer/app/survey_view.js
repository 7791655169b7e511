import {
  cornersOf, displayTransform, EXAGGERATIONS, extentOf, middleOf, suggestedExaggeration, toDisplay,
} from '../core/placement.js';
import { AxisLabels } from '../three/axis_labels.js';
import { SurveyBox } from '../three/survey_box.js';

/**
 * The survey's box with its axes, and the tools of the view: exaggeration, triangles, the whole survey again.
 *
 * elements      {labels, tools, overlays: what lies over the view}
 * onWireframe   (isOn) when somebody wants to see triangles, or not any more.
 */
export class SurveyView {
  #stage;
  #tools;
  #box = new SurveyBox();
  #labels;
  #frame = null;
  #display = null;

  constructor(stage, { labels, tools, overlays }, { onWireframe }) {
    this.#stage = stage;
    this.#tools = tools;
    this.#labels = new AxisLabels(labels, overlays);
    stage.world.add(this.#box);
    stage.afterDraw((camera, width, height) => this.#labels.follow(camera, stage.world, width, height));
    tools.querySelector('#exaggeration').addEventListener('input', ({ target }) => this.#exaggerate(EXAGGERATIONS[target.value]));
    tools.querySelector('#wireframe').addEventListener('change', ({ target }) => onWireframe(target.checked));
    tools.querySelector('#reset').addEventListener('click', () => this.#showAll());
  }

  get frame() {
    return this.#frame;
  }

  set color(color) {
    this.#box.color = color;
  }

  /** Draws in this frame from now on; returns the survey's extent, or null where it is the frame that it was. */
  place(frame) {
    if (JSON.stringify(frame) === JSON.stringify(this.#frame)) return null;
    this.#frame = frame;
    this.#display = displayTransform(frame.transform, middleOf(frame));
    this.#box.place(frame.dims, this.#display);
    this.#labels.place(frame, this.#display);
    const extent = extentOf(this.#display, frame.dims);
    this.#exaggerate(suggestedExaggeration(extent));
    this.#showAll();
    return extent;
  }

  #showAll() {
    if (!this.#frame) this.#stage.resetView();
    else this.#stage.frame(cornersOf(this.#frame.dims).map((corner) => toDisplay(this.#display, corner)));
  }

  #exaggerate(factor) {
    this.#stage.world.scale.y = factor;
    const slider = this.#tools.querySelector('#exaggeration');
    slider.max = EXAGGERATIONS.length - 1;
    slider.value = EXAGGERATIONS.indexOf(factor);
    slider.setAttribute('aria-valuetext', `× ${factor}`);
    this.#tools.querySelector('#exaggeration-value').textContent = `× ${factor}`;
    this.#stage.draw();
  }
}
