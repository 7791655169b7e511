import { bodiesTable, describeSmaller } from '../core/bodies.js';
import { describeBodies } from '../core/extraction_state.js';

/**
 * The table of bodies. A row is chosen by clicking it or by its button; arrow keys go from row to row.
 *
 * onChoose(body)   the number of the row.
 */
export class BodiesSection {
  #section;
  #rows;
  #onChoose;
  #shown = null; // what the rows were made of

  constructor(section, { onChoose }) {
    this.#section = section;
    this.#rows = section.querySelector('tbody');
    this.#onChoose = onChoose;
    this.#rows.addEventListener('click', ({ target }) => this.#choose(target.closest('tr')));
    this.#rows.addEventListener('keydown', (event) => this.#onKey(event));
  }

  /** state, selected and a function from a body to its swatch's colour. */
  show(state, selected, swatchOf) {
    const note = describeBodies(state);
    this.#text('#bodies-note', note);
    this.#section.querySelector('#bodies-note').classList.toggle('problem', state.bodiesProblem !== '');
    this.#section.querySelector('.table-frame').hidden = !state.bodies?.length;
    if (this.#shown?.bodies !== state.bodies || this.#shown?.selected !== selected) this.#fill(state.bodies ?? [], selected);
    this.#shown = { bodies: state.bodies, selected };
    for (const row of this.#rows.rows) row.querySelector('i').style.background = swatchOf(Number(row.dataset.body));
  }

  #fill(bodies, selected) {
    const focused = this.#rows.contains(document.activeElement) ? document.activeElement.closest('tr').dataset.body : null;
    const { rows, smaller } = bodiesTable(bodies, selected);
    this.#rows.replaceChildren(...rows.map(rowOf));
    this.#text('#bodies-smaller', describeSmaller(smaller));
    const reachable = this.#row(focused) ?? this.#row(selected) ?? this.#rows.rows[0];
    if (reachable) buttonOf(reachable).tabIndex = 0;
    if (focused !== null && reachable) buttonOf(reachable).focus();
    this.#row(selected)?.scrollIntoView({ block: 'nearest' });
  }

  #row(body) {
    return body === null ? null : this.#rows.querySelector(`tr[data-body="${body}"]`);
  }

  #text(selector, text) {
    const element = this.#section.querySelector(selector);
    if (element.textContent !== text) element.textContent = text;
    element.hidden = text === '';
  }

  #choose(row) {
    if (row) this.#onChoose(Number(row.dataset.body));
  }

  #onKey(event) {
    const row = event.target.closest('tr');
    const targets = {
      ArrowUp: row.previousElementSibling, ArrowDown: row.nextElementSibling,
      Home: this.#rows.firstElementChild, End: this.#rows.lastElementChild,
    };
    const target = targets[event.key];
    if (!target) return;
    event.preventDefault();
    buttonOf(row).tabIndex = -1;
    buttonOf(target).tabIndex = 0;
    buttonOf(target).focus();
  }
}

const buttonOf = (row) => row.querySelector('button');

function rowOf({ body, isSelected, cells }) {
  const row = document.createElement('tr');
  row.dataset.body = body;
  if (isSelected) row.setAttribute('aria-current', 'true');
  const button = document.createElement('button');
  button.type = 'button';
  button.tabIndex = -1;
  button.setAttribute('aria-pressed', String(isSelected));
  button.setAttribute('aria-label', `Body ${body}: single out`);
  button.append(document.createElement('i'), String(body));
  row.insertCell().append(button);
  for (const text of cells) row.insertCell().textContent = text;
  return row;
}
