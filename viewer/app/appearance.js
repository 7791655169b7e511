import { describeBody, toggled } from '../core/bodies.js';
import { COLOURINGS, colouringFor, colouringsOf, RAMP, swatchColour } from '../core/colours.js';
import { idle } from '../core/extraction_state.js';
import { formatWhole } from '../core/format.js';
import { boundsOfBody, enlarged, heightsOf, longestSide } from '../core/mesh.js';
import { cornersBetween, middleOf } from '../core/placement.js';
import { LevelView } from '../three/level_view.js';
import { BodyBox } from '../three/survey_box.js';
import { BodiesSection } from './bodies_section.js';

/** Shortest side of the box around a body, as a share of the survey's extent; a body this much larger needs none. */
const LEAST_BOX = 0.02;
const NEEDS_NO_BOX = 20;

/** What the plain colour and the pale one mean. */
const LEGENDS = { reliability: ['measured', 'filled in'], agreement: ['traces agree', 'layers may be mis-tied'] };

/**
 * How the surface looks: its colours, and the body that is singled out in the view and in the table.
 *
 * elements     {colouring, legend, ramp, selection, bodies}
 * onColouring  (name) when somebody chose another colouring.
 */
export class Appearance {
  #stage;
  #elements;
  #level = new LevelView();
  #box = new BodyBox();
  #section;
  #wanted = 'plain';
  #plain = '#cf8a35';
  #selected = null;
  #isPreview = false;
  #state = idle;
  #unit = '';
  #leastBox = 0;
  #bounds = null; // of the body that is singled out
  #vertical = { unit: '', at: () => 0 };

  constructor(stage, elements, { onColouring }) {
    this.#stage = stage;
    this.#elements = elements;
    stage.world.add(this.#level, this.#box);
    // Before the first level is here, the view still shows another extraction's bodies; those of a preview are in no table.
    stage.onClick((raycaster) => this.#state.shown !== null && !this.#isPreview && this.#select(this.#level.bodyAt(raycaster)));
    this.#section = new BodiesSection(elements.bodies, { onChoose: (body) => this.#select(body) });
    elements.selection.querySelector('#release').addEventListener('click', () => this.#select(null));
    elements.selection.querySelector('#zoom-to').addEventListener('click', () => {
      if (this.#bounds) stage.lookAt(cornersBetween(this.#bounds));
    });
    addEventListener('keydown', ({ key }) => key === 'Escape' && this.#select(null));
    elements.colouring.addEventListener('change', ({ target }) => {
      this.colouring = target.value;
      onColouring(target.value);
    });
  }

  /** What is wanted; where its attribute is absent the surface is plain. */
  set colouring(name) {
    this.#wanted = COLOURINGS.includes(name) ? name : 'plain';
    this.#recolour();
  }

  set wireframe(on) {
    this.#level.wireframe = on;
    this.#stage.draw();
  }

  /** What it is drawn in, as core/placement.js has it, and its horizontal extent on the display. */
  placeIn(frame, extent) {
    const [, , middle] = middleOf(frame);
    this.#unit = frame.unit;
    this.#leastBox = LEAST_BOX * extent;
    this.#vertical = { unit: frame.verticalUnit, at: (height) => middle - height };
    const name = this.#elements.colouring.querySelector('#vertical-name');
    name.textContent = frame.verticalUnit === 'ms' ? 'Time' : 'Depth';
  }

  /** '#rrggbb' of the measured surface and of the filled one, and of lines. */
  set theme({ plain, pale, line }) {
    this.#plain = plain;
    this.#level.look = { plain, pale };
    this.#box.color = line;
    this.#recolour();
  }

  /** Draws these parts; a selection stays, for bodies have the same numbers at every level. */
  draw(parts) {
    this.#isPreview = false;
    this.#level.replace(parts);
    this.#placeBox();
    this.#recolour();
  }

  /** Draws a preview, whose bodies have other numbers than those in the table. */
  drawPreview(parts) {
    if (this.#selected !== null) this.#select(null);
    this.draw(parts);
    this.#isPreview = true;
  }

  show(state) {
    const isNew = state.phase === 'waiting' || state.phase === 'idle';
    this.#state = state;
    if (isNew && this.#selected !== null) this.#select(null);
    if (state.phase === 'idle' || state.manifest?.empty) this.draw([]);
    this.#showSection();
  }

  /** The same body again, or none, lets it go. */
  #select(body) {
    const selected = body === null ? null : toggled(this.#selected, body);
    if (selected === this.#selected) return;
    this.#selected = selected;
    this.#level.selected = selected;
    this.#placeBox();
    this.#showSection();
    this.#stage.draw();
  }

  #placeBox() {
    const bounds = this.#selected === null ? null : boundsOfBody(this.#level.parts, this.#selected);
    this.#bounds = bounds && enlarged(bounds, this.#leastBox);
    this.#box.place(this.#bounds);
    if (bounds && longestSide(bounds) > NEEDS_NO_BOX * this.#leastBox) this.#box.visible = false;
  }

  #recolour() {
    const available = colouringsOf(this.#level.parts);
    const colouring = colouringFor(this.#wanted, available);
    const heights = colouring === 'depth' ? heightsOf(this.#level.parts) : null;
    this.#level.look = { colouring, ...heights };
    for (const input of this.#elements.colouring.querySelectorAll('input')) {
      input.checked = input.value === colouring;
      input.parentElement.hidden = !available.includes(input.value);
    }
    this.#elements.colouring.hidden = available.length < 2;
    this.#showLegend(colouring, heights);
    this.#showSection();
    this.#stage.draw();
  }

  #showLegend(colouring, heights) {
    const texts = LEGENDS[colouring];
    this.#elements.legend.hidden = !texts;
    this.#elements.legend.querySelectorAll('span').forEach((span, at) => { span.textContent = texts?.[at] ?? ''; });
    const { ramp } = this.#elements;
    ramp.hidden = !heights;
    if (!heights) return;
    const { at, unit } = this.#vertical;
    const [top, bottom] = [heights.top, heights.bottom].map((height) => formatWhole(Math.round(at(height))));
    ramp.querySelectorAll('span').forEach((span, end) => { span.textContent = end === 0 ? top : `${bottom} ${unit}`; });
    ramp.querySelector('i').style.background = `linear-gradient(to right, ${RAMP.join(', ')})`;
  }

  #showSection() {
    const colouring = colouringFor(this.#wanted, colouringsOf(this.#level.parts));
    this.#section.show(this.#state, this.#selected, this.#unit, (body) => swatchColour(colouring, body, this.#plain));
    const entry = this.#state.bodies?.find(({ body }) => body === this.#selected);
    const { selection } = this.#elements;
    selection.hidden = this.#selected === null;
    const isLeftOut = this.#bounds === null;
    selection.querySelector('span').textContent = (entry ? describeBody(entry, this.#unit) : `Body ${this.#selected}`) +
      (isLeftOut ? '; this level leaves it out' : '');
    selection.querySelector('#zoom-to').disabled = isLeftOut;
  }
}
