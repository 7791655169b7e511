import { counted, formatAmplitude, formatCount, formatShare, formatVolume } from './format.js';

/** The bodies of an extraction as the service lists them, largest first, and the one that is singled out (its number, or null). */

export const ROWS = 50;

/** Clicking a body singles it out; clicking it again, or nothing, lets it go. */
export function toggled(selected, body) {
  return body === selected ? null : body;
}

/**
 * The table: the first bodies, and the selected one wherever it stands.
 *
 * returns  {unit: of the volumes, rows: [{body, isSelected, cells: [volume, mean amplitude, tunnels, filled]}],
 *           smaller: how many are not in it}
 */
export function bodiesTable(bodies, selected, unit = '', limit = ROWS) {
  const listed = bodies.slice(0, limit);
  const beyond = bodies.slice(limit).find(({ body }) => body === selected);
  if (beyond) listed.push(beyond);
  const hasLengths = unit !== '' && bodies.every(({ volume }) => isThere(volume));
  const rows = listed.map((entry) => rowOf(entry, selected, hasLengths));
  return { unit: hasLengths ? `${unit}³` : 'voxels', rows, smaller: bodies.length - listed.length };
}

const isThere = (value) => value !== null && value !== undefined;

function rowOf(entry, selected, hasLengths) {
  const { body, volume, volume_voxels: voxels, amplitude, genus, interpolated_share: filled } = entry;
  const cells = [
    formatVolume(hasLengths ? volume : voxels), formatAmplitude(amplitude?.mean), isThere(genus) ? formatCount(genus) : '–',
    formatShare(filled ?? 0),
  ];
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
  if (isThere(volume)) facts.push(formatVolume(volume, unit));
  if (amplitude) facts.push(`amplitude ${formatAmplitude(amplitude.min)} to ${formatAmplitude(amplitude.max)}`);
  if (genus > 0) facts.push(counted(genus, 'tunnel'));
  if (cavities > 0) facts.push(counted(cavities, 'cavity', 'cavities'));
  if (filled > 0) facts.push(`${formatShare(filled)} filled in`);
  return `Body ${body}: ${facts.join(', ')}`;
}
