import { counted, formatBytes, formatCount, formatDistance, formatWhole } from './format.js';

/** Triangles, surfaces, Euler characteristic, tunnels, size and distance of a level; no distance is known before the manifest. */
export function levelCells({ triangles, components, euler, genus, bytes, distance }, isMeasured) {
  const measured = isMeasured ? `${formatDistance(distance.mean_voxels)} / ${formatDistance(distance.max_voxels)}` : formatDistance(null);
  const tunnels = genus === null || genus === undefined ? '–' : formatCount(genus);
  return [formatCount(triangles), formatCount(components), formatWhole(euler), tunnels, formatBytes(bytes), measured];
}

/** What a level leaves out, or ''. */
export function describeDropped({ dropped_components: dropped }) {
  return dropped > 0 ? `${counted(dropped, 'speck')} left out; the distance includes ${dropped === 1 ? 'it' : 'them'}` : '';
}
