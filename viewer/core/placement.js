/**
 * Where things are drawn.
 *
 * Index coordinates (inline, crossline, sample) -> world by the volume's transform (row-major 4 x 4, doubles, around
 * millions of metres) -> display: x east, y up, z south, around the survey's middle, small enough for float32. The
 * vertical axis points down in the world and up on the screen, so the way to the display is a mirror, and the triangles
 * have to be turned round.
 */

/** The survey's 8 corners as index coordinates; bit 0 of the position: last inline, bit 1: crossline, bit 2: sample. */
export function cornersOf(dims) {
  return Array.from({ length: 8 }, (_, corner) => dims.map((count, axis) => ((corner >> axis) & 1) * (count - 1)));
}

/** The 12 edges of the box as pairs of corner numbers. */
export const BOX_EDGES = Object.freeze(
  [0, 1, 2].flatMap((axis) =>
    [...Array(8).keys()].filter((corner) => !((corner >> axis) & 1)).map((corner) => [corner, corner | (1 << axis)]),
  ),
);

export function toWorld(transform, [i, j, k]) {
  return [0, 4, 8].map((row) => transform[row] * i + transform[row + 1] * j + transform[row + 2] * k + transform[row + 3]);
}

/**
 * What the page draws in: an outline of dims nodes an axis, which transform takes to the world, its axes' names and numbers.
 *
 * isPlaced   levels have coordinates of their own, and only their manifest's transform takes them to the world.
 */
export function surveyFrame({ dims, axes, geometry }) {
  return {
    dims, axes, names: ['Inline', 'Crossline', verticalName(axes.sample.unit)], transform: geometry.transform, unit: geometry.unit, isPlaced: false,
  };
}

/** The same around a grid whose nodes somebody has placed: the box of its nodes. */
export function gridFrame({ box: [low, high], times }, { geometry }) {
  const sides = high.map((end, axis) => end - low[axis]);
  const axis = (number) => ({ first: low[number], step: sides[number] });
  const transform = [0, 1, 2].flatMap((row) => [...[0, 1, 2].map((column) => (row === column ? sides[row] : 0)), low[row]]);
  return {
    dims: [2, 2, 2], axes: { inline: axis(0), crossline: axis(1), sample: axis(2) }, names: ['x', 'y', verticalName(times ? 'ms' : geometry.unit)],
    transform: [...transform, 0, 0, 0, 1], unit: geometry.unit, isPlaced: true,
  };
}

export function middleOf({ transform, dims }) {
  return toWorld(transform, dims.map((count) => (count - 1) / 2));
}

/**
 * A level's coordinates to the display as 12 numbers, the first three rows of a row-major 4 x 4, around a middle in the
 * world. The subtraction of the middle is done here, in double.
 */
export function displayTransform(transform, middle) {
  const row = (number, sign) => [
    ...[0, 1, 2].map((column) => sign * transform[4 * number + column]),
    sign * (transform[4 * number + 3] - middle[number]),
  ];
  return [...row(0, 1), ...row(2, -1), ...row(1, -1)];
}

export function toDisplay(display, [i, j, k]) {
  return [0, 4, 8].map((row) => display[row] * i + display[row + 1] * j + display[row + 2] * k + display[row + 3]);
}

/** Longest horizontal and the vertical extent of the survey on the display. */
export function extentOf(display, dims) {
  const corners = cornersOf(dims).map((corner) => toDisplay(display, corner));
  const span = (axis) => Math.max(...corners.map((p) => p[axis])) - Math.min(...corners.map((p) => p[axis]));
  return { horizontal: Math.max(span(0), span(2)), vertical: span(1) };
}

/**
 * How far from the origin an eye has to be that looks at it along -z, so that it sees all points.
 *
 * halfWidth, halfHeight   of what it sees, at distance 1.
 */
export function distanceToSee(points, halfWidth, halfHeight) {
  return Math.max(...points.map(([x, y, z]) => z + Math.max(Math.abs(x) / halfWidth, Math.abs(y) / halfHeight)));
}

/** A vertical exaggeration that shows flat surveys at two fifths of their width: 1, 1.5, 2, 2.5 ... 20. */
export function suggestedExaggeration({ horizontal, vertical }) {
  if (!(vertical > 0) || !(horizontal > 0)) return 1;
  return Math.min(20, Math.max(1, Math.round((0.8 * horizontal) / vertical) / 2));
}

/**
 * Texts of the box: each axis' name at the middle of one edge, its first and last number at the ends; `at` in index
 * coordinates, a little outside of the box, so that the texts of two axes do not meet at a corner.
 */
export function axisLabels({ dims, axes, names }) {
  const last = dims.map((count) => count - 1);
  const before = last.map((end) => -LABEL_MARGIN * end);
  const after = last.map((end) => (1 + LABEL_MARGIN) * end);
  return [
    ...labelsOf(names[0], axes.inline, 0, [0, after[1], last[2]], last[0]),
    ...labelsOf(names[1], axes.crossline, 1, [before[0], 0, last[2]], last[1]),
    ...labelsOf(names[2], axes.sample, 2, [before[0], before[1], 0], last[2]),
  ];
}

const LABEL_MARGIN = 0.06;

function verticalName(unit) {
  if (unit === 'ms') return 'Time, ms';
  return unit ? `Depth, ${unit}` : 'Sample';
}

function labelsOf(name, { first, step }, axis, edge, last) {
  const place = (index) => edge.map((coordinate, other) => (other === axis ? index : coordinate));
  const number = (index) => String(Number(((first ?? 0) + index * (step ?? 1)).toFixed(2)));
  return [
    { text: number(0), at: place(0), kind: 'tick' },
    { text: name, at: place(last / 2), kind: 'name' },
    { text: number(last), at: place(last), kind: 'tick' },
  ];
}
