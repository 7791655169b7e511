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

/** The 8 corners of a box, numbered in the same way. */
export function cornersBetween({ low, high }) {
  return Array.from({ length: 8 }, (_, corner) => low.map((end, axis) => ((corner >> axis) & 1 ? high[axis] : end)));
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
export function surveyFrame({ dims, axes, geometry }, velocity = null) {
  const metres = metresPerMillisecond(velocity);
  const { first, step, unit } = axes.sample;
  const sample = { first: (first ?? 0) * metres, step: (step ?? 1) * metres, unit: velocity ? 'm' : unit };
  return {
    dims, axes: { ...axes, sample }, names: ['Inline', 'Crossline', verticalName(sample.unit)],
    transform: geometry.transform?.map((number, at) => (at >= 8 && at < 12 ? number * metres : number)),
    unit: geometry.unit, verticalUnit: sample.unit, isPlaced: false,
  };
}

/** The same around a grid whose nodes somebody has placed: the box of its nodes. */
export function gridFrame({ box, times }, { geometry }, velocity = null) {
  const metres = metresPerMillisecond(times ? velocity : null);
  const [low, high] = box.map(([x, y, z]) => [x, y, z * metres]);
  const verticalUnit = times && !velocity ? 'ms' : geometry.unit;
  const sides = high.map((end, axis) => end - low[axis]);
  const axis = (number) => ({ first: low[number], step: sides[number] });
  const transform = [0, 1, 2].flatMap((row) => [...[0, 1, 2].map((column) => (row === column ? sides[row] : 0)), low[row]]);
  return {
    dims: [2, 2, 2], axes: { inline: axis(0), crossline: axis(1), sample: axis(2) }, names: ['x', 'y', verticalName(verticalUnit)],
    transform: [...transform, 0, 0, 0, 1], unit: geometry.unit, verticalUnit, isPlaced: true,
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

/** The vertical exaggerations that can be chosen. */
export const EXAGGERATIONS = Object.freeze([
  0.01, 0.02, 0.03, 0.05, 0.07, 0.1, 0.15, 0.2, 0.3, 0.5, 0.7, 1, 1.5, 2, 2.5, 3, 3.5, 4, 5, 6, 7, 8, 10, 12, 15, 20,
]);

/** Heights in widths: flat surveys are raised to the first, and what is taller than the second is lowered to it. */
const FLAT = 0.4;
const TALL = 1.25;

/** Which of the exaggerations shows a survey best. */
export function suggestedExaggeration({ horizontal, vertical }) {
  if (!(vertical > 0) || !(horizontal > 0)) return 1;
  const height = vertical / horizontal;
  return nearestExaggeration(height < FLAT ? FLAT / height : Math.min(1, TALL / height));
}

function nearestExaggeration(factor) {
  const distance = (other) => Math.abs(Math.log(other / factor));
  return EXAGGERATIONS.reduce((best, other) => (distance(other) < distance(best) ? other : best));
}

/** Two-way time to depth. */
function metresPerMillisecond(velocity) {
  return velocity ? velocity / 2000 : 1;
}

function verticalName(unit) {
  if (unit === 'ms') return 'Time, ms';
  return unit ? `Depth, ${unit}` : 'Sample';
}
