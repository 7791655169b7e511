/** A range of amplitudes: {low, high}, an open end being null. */

/** The number that somebody typed; null when the field is empty or says inf; undefined when it is not a number. */
export function parseEnd(text) {
  const trimmed = text.trim();
  if (trimmed === '' || /^[+-]?(inf(inity)?|∞)$/i.test(trimmed)) return null;
  const number = Number(trimmed.replace(',', '.'));
  return Number.isFinite(number) ? number : undefined;
}

/** Why the range cannot be asked for, or '' when it can. */
export function rangeMistake({ low, high }) {
  if (low === undefined || high === undefined) return 'Type a number, or leave the field empty for an open end.';
  if (low !== null && high !== null && low > high) return 'The lower end lies above the upper end.';
  return '';
}

/** The range as the page's address has it. */
export function rangeToText({ low, high }) {
  return `${low ?? '-inf'},${high ?? 'inf'}`;
}

/** The inverse of rangeToText; null when the text is not a range. */
export function rangeFromText(text) {
  const ends = (text ?? '').split(',');
  if (ends.length !== 2) return null;
  const range = { low: parseEnd(ends[0]), high: parseEnd(ends[1]) };
  return rangeMistake(range) === '' ? range : null;
}

/** The number with as many digits as tell two neighbouring steps apart. */
export function roundTo(value, step) {
  const digits = Math.min(12, Math.max(0, 1 - Math.floor(Math.log10(Math.abs(step) || 1))));
  return Number(value.toFixed(digits));
}
