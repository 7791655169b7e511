import { bodiesTable, describeSmaller } from '../core/bodies.js';
import { describeBodies } from '../core/extraction_state.js';
import { RowButtons, rowButton } from './row_buttons.js';

/**
 * The table of bodies.
 *
 * onChoose(body)   the number of the row.
 */
export class BodiesSection {
  #section;
  #body;
  #rows;
  #shown = null; // what the rows were made of

  constructor(section, { onChoose }) {
    this.#section = section;
    this.#body = section.querySelector('tbody');
    this.#rows = new RowButtons(this.#body, (row) => onChoose(Number(row.dataset.body)));
  }

  /** state, selected, the unit of lengths and a function from a body to its swatch's colour. */
  show(state, selected, unit, swatchOf) {
    this.#text('#bodies-note', describeBodies(state));
    this.#section.querySelector('#bodies-note').classList.toggle('problem', state.bodiesProblem !== '');
    this.#section.querySelector('.table-frame').hidden = !state.bodies?.length;
    if (this.#shown?.bodies !== state.bodies || this.#shown?.selected !== selected) this.#fill(state.bodies ?? [], selected, unit);
    this.#shown = { bodies: state.bodies, selected };
    for (const row of this.#body.rows) row.querySelector('i').style.background = swatchOf(Number(row.dataset.body));
  }

  #fill(bodies, selected, unit) {
    const { unit: shown, rows, smaller } = bodiesTable(bodies, selected, unit);
    const elements = rows.map(rowOf);
    const current = elements.find((row) => row.ariaCurrent === 'true');
    this.#rows.fill(elements, ({ dataset }) => dataset.body, current);
    this.#text('#bodies-smaller', describeSmaller(smaller));
    this.#section.querySelector('#volume-unit').textContent = shown;
    current?.scrollIntoView({ block: 'nearest' });
  }

  #text(selector, text) {
    const element = this.#section.querySelector(selector);
    if (element.textContent !== text) element.textContent = text;
    element.hidden = text === '';
  }
}

function rowOf({ body, isSelected, cells }) {
  const row = document.createElement('tr');
  row.dataset.body = body;
  if (isSelected) row.setAttribute('aria-current', 'true');
  row.insertCell().append(rowButton(`Body ${body}: single out`, isSelected, document.createElement('i'), String(body)));
  for (const text of cells) row.insertCell().textContent = text;
  return row;
}
