import { describeDropped, levelCells } from '../core/levels.js';
import { RowButtons, rowButton } from './row_buttons.js';

/**
 * The levels, coarsest first; the one on the screen is marked.
 *
 * onChoose(level)   somebody wants to see another one.
 */
export class LevelsTable {
  #table;
  #rows;
  #shown = ''; // what the rows were made of

  constructor(table, { onChoose }) {
    this.#table = table;
    this.#rows = new RowButtons(table.tBodies[0], (row) => onChoose(Number(row.dataset.level)));
  }

  /** Rows of what was there before are pale until the first level of what comes is known; also while a preview is on the screen. */
  show({ phase, levels, here, shown, manifest }, isPreview) {
    const isOld = isPreview || ((phase === 'waiting' || phase === 'running') && levels.length === 0);
    this.#table.classList.toggle('old', isOld);
    this.#table.inert = isOld;
    if (isOld) return;
    const isMeasured = manifest !== null;
    const content = JSON.stringify([levels, here, shown, isMeasured]);
    if (content === this.#shown) return;
    this.#shown = content;
    const rows = levels.map((entry) => {
      const { level } = entry;
      return rowOf(entry, { isShown: level === shown, isHere: here.includes(level), isMeasured });
    });
    const withNotes = rows.flatMap((row, at) => [row, ...noteOf(levels[at])]);
    this.#rows.fill(withNotes, ({ dataset }) => dataset.level, rows.find(({ ariaCurrent }) => ariaCurrent === 'true'));
  }
}

function rowOf(level, { isShown, isHere, isMeasured }) {
  const row = document.createElement('tr');
  row.dataset.level = level.level;
  if (isShown) row.setAttribute('aria-current', 'true');
  const button = rowButton(`Level ${level.level}: show`, isShown, String(level.level));
  button.disabled = !isHere;
  row.insertCell().append(button);
  for (const text of levelCells(level, isMeasured)) row.insertCell().textContent = text;
  return row;
}

/** A line below the row where the level leaves something out. */
function noteOf(level) {
  const text = describeDropped(level);
  if (text === '') return [];
  const row = document.createElement('tr');
  row.className = 'note';
  const cell = row.insertCell();
  cell.colSpan = 7;
  cell.textContent = text;
  return [row];
}
