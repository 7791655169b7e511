/** Numbers for people. */

const groups = new Intl.NumberFormat('en', { useGrouping: true });

/** 31970 -> "31 970", with a narrow space that does not break. */
export function formatCount(count) {
  return groups.format(count).replaceAll(',', '\u202f');
}

export function formatBytes(bytes) {
  if (bytes < 1000) return `${bytes} B`;
  const exponent = Math.min(4, Math.floor(Math.log10(bytes) / 3));
  return `${(bytes / 1000 ** exponent).toPrecision(3)} ${['B', 'kB', 'MB', 'GB', 'TB'][exponent]}`;
}

/** A distance in voxels; null = not measured yet. */
export function formatDistance(voxels) {
  if (voxels === null || voxels === undefined) return '…';
  return voxels === 0 ? '0' : voxels.toFixed(voxels < 0.1 ? 3 : 2);
}

export function formatShare(share) {
  const percent = 100 * share;
  if (percent > 0 && percent < 0.01) return 'under 0.01 %';
  return `${Number(percent.toPrecision(2))} %`;
}
