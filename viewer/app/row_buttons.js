/**
 * A table's body whose rows have one button each. A row is chosen by clicking it or by its button; arrow keys go from
 * button to button, of which only one is reached by the tab key.
 *
 * onChoose(row)   somebody chose a row.
 */
export class RowButtons {
  #rows;

  constructor(rows, onChoose) {
    this.#rows = rows;
    rows.addEventListener('click', ({ target }) => {
      const row = target.closest('tr');
      if (buttonOf(row)?.disabled === false) onChoose(row);
    });
    rows.addEventListener('keydown', (event) => this.#onKey(event));
  }

  /**
   * Takes these rows instead of those before; the focus stays on the row of the same key.
   *
   * keyOf     the row's key.    reachable   the row that the tab key reaches first, or none.
   */
  fill(rows, keyOf, reachable) {
    const focused = this.#rows.contains(document.activeElement) ? keyOf(document.activeElement.closest('tr')) : null;
    this.#rows.replaceChildren(...rows);
    const same = focused === null ? null : rows.find((row) => buttonOf(row) && keyOf(row) === focused);
    const first = buttonOf(same ?? reachable) ?? this.#buttons()[0];
    if (!first) return;
    first.tabIndex = 0;
    if (focused !== null) first.focus();
  }

  #buttons() {
    return [...this.#rows.querySelectorAll('button:enabled')];
  }

  #onKey(event) {
    const buttons = this.#buttons();
    const here = buttons.indexOf(event.target);
    const places = { ArrowUp: here - 1, ArrowDown: here + 1, Home: 0, End: buttons.length - 1 };
    const target = here < 0 ? undefined : buttons[places[event.key]];
    if (!target) return;
    event.preventDefault();
    event.target.tabIndex = -1;
    target.tabIndex = 0;
    target.focus();
  }
}

/** A cell's button: pressed where it is the one that is shown. */
export function rowButton(label, isPressed, ...content) {
  const button = document.createElement('button');
  button.type = 'button';
  button.tabIndex = -1;
  button.setAttribute('aria-pressed', String(isPressed));
  button.setAttribute('aria-label', label);
  button.append(...content);
  return button;
}

function buttonOf(row) {
  return row?.querySelector('button') ?? null;
}
