import { formatAmplitude, formatCount, formatShare, formatVolume } from './format.js';

/** The bodies of an extraction as the service lists them, largest first, and the one that is singled out (its number, or null). */

export const ROWS = 50;

/** Clicking a body singles it out; clicking it again, or nothing, lets it go. */
export function toggled(selected, body) {
  return body === selected ? null : body;
}

/**
 * The table: the first bodies, and the selected one wherever it stands.
 *
 * returns  {rows: [{body, isSelected, cells: [samples, mean amplitude, tunnels, filled]}], smaller: how many are not in it}
 */
export function bodiesTable(bodies, selected, limit = ROWS) {
  const listed = bodies.slice(0, limit);
  const beyond = bodies.slice(limit).find(({ body }) => body === selected);
  if (beyond) listed.push(beyond);
  return { rows: listed.map((entry) => rowOf(entry, selected)), smaller: bodies.length - listed.length };
}

function rowOf(entry, selected) {
  const { body, voxels, amplitude, genus, interpolated_share: filled } = entry;
  const cells = [formatCount(voxels), formatAmplitude(amplitude?.mean), String(genus ?? '–'), formatShare(filled ?? 0)];
  return { body, isSelected: body === selected, cells };
}

/** "and 1 234 smaller ones", or '' when all are listed. */
export function describeSmaller(smaller) {
  if (smaller === 0) return '';
  return `and ${formatCount(smaller)} smaller ${smaller === 1 ? 'one' : 'ones'}`;
}

/** One line about one body: what the table says, and what it has no room for. */
export function describeBody(entry, unit) {
  const { body, voxels, volume, amplitude, genus, cavities, interpolated_share: filled } = entry;
  const facts = [`${counted(voxels, 'sample')}`];
  if (volume !== null && volume !== undefined) facts.push(formatVolume(volume, unit));
  if (amplitude) facts.push(`amplitude ${formatAmplitude(amplitude.min)} to ${formatAmplitude(amplitude.max)}`);
  if (genus > 0) facts.push(counted(genus, 'tunnel'));
  if (cavities > 0) facts.push(counted(cavities, 'cavity', 'cavities'));
  if (filled > 0) facts.push(`${formatShare(filled)} filled in`);
  return `Body ${body}: ${facts.join(', ')}`;
}

function counted(count, one, many = `${one}s`) {
  return `${formatCount(count)} ${count === 1 ? one : many}`;
}
