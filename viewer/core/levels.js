import { counted, formatBytes, formatCount, formatDistance, formatWhole } from './format.js';

/** Triangles, surfaces, Euler characteristic, tunnels, size and distance of a level; no distance is known before the manifest. */
export function levelCells({ triangles, components, euler, genus, bytes, distance }, isMeasured) {
  const distances = isMeasured ? [distance.mean_voxels, distance.max_voxels] : [null];
  const measured = distances.map(formatDistance).join(' / ');
  const tunnels = genus === null || genus === undefined ? '–' : formatCount(genus);
  return [formatCount(triangles), formatCount(components), formatWhole(euler), tunnels, formatBytes(bytes), measured];
}

/** What a level leaves out, or ''. */
export function describeDropped({ dropped_components: dropped }) {
  return dropped > 0 ? `${counted(dropped, 'speck')} left out; the distance includes ${dropped === 1 ? 'it' : 'them'}` : '';
}
