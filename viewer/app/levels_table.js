import { formatBytes, formatCount, formatDistance } from '../core/format.js';

/** Fills the table's body with the levels, coarsest first; the one on the screen is marked. */
export function showLevels(body, { levels, shown, manifest }) {
  body.replaceChildren(...levels.map((level) => rowOf(level, shown, manifest !== null)));
}

function rowOf(level, shown, isMeasured) {
  const row = document.createElement('tr');
  row.dataset.level = level.level;
  if (level.level === shown) row.setAttribute('aria-current', 'true');
  for (const text of textsOf(level, isMeasured)) row.insertCell().textContent = text;
  return row;
}

function textsOf({ level, triangles, components, euler, genus, bytes, distance }, isMeasured) {
  const measured = isMeasured
    ? `${formatDistance(distance.mean_voxels)} / ${formatDistance(distance.max_voxels)}`
    : formatDistance(null);
  return [String(level), formatCount(triangles), formatCount(components), String(euler).replace('-', '−'), String(genus ?? '–'),
    formatBytes(bytes), measured];
}
