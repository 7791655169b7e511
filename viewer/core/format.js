/** Numbers and sentences for people. */

const groups = new Intl.NumberFormat('en', { useGrouping: true });

/** 31970 -> "31 970", with a narrow space that does not break. */
export function formatCount(count) {
  return groups.format(count).replaceAll(',', '\u202f');
}

/** "1 body", "31 970 bodies" */
export function counted(count, one, many = `${one}s`) {
  return `${formatCount(count)} ${count === 1 ? one : many}`;
}

/** A whole number that may be negative, with a minus sign. */
export function formatWhole(number) {
  return formatCount(number).replace('-', '−');
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

/** An amplitude with three digits; null = there is none. */
export function formatAmplitude(value) {
  if (value === null || value === undefined) return '–';
  return String(Number(value.toPrecision(3))).replace('-', '−');
}

/** A volume in cubes of a unit, metres being the one that grows to kilometres. */
export function formatVolume(volume, unit = '') {
  if (unit === 'm' && volume >= 1e8) return `${Number((volume / 1e9).toPrecision(3))} km³`;
  return `${formatCount(Number(volume.toPrecision(3)))}${unit && ` ${unit}³`}`;
}

/** What a server said, with a capital and a full stop; a name with an underscore stays as it is written. */
export function asSentence(text) {
  const trimmed = text.trim();
  const begun = /^[a-z]+(?![\w./])/.test(trimmed) ? trimmed[0].toUpperCase() + trimmed.slice(1) : trimmed;
  return /[.!?…]$/.test(begun) ? begun : `${begun}.`;
}
