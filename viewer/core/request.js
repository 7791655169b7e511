import { parseEnd } from './range.js';

/**
 * What the page asks for: a range and the choices beside it.
 *
 * fill       none | linear | rbf: what happens to missing traces inside the survey
 * minVoxels  bodies smaller than this are left out; 0 keeps all
 * velocity   m/s, which turns the times of a survey into depths; null leaves them times
 * grid       given | structural | auto: what joins the samples of neighbouring traces, depth or reflectors; or the id of a
 *            grid whose nodes somebody has placed
 */
export const FILLS = Object.freeze(['none', 'linear', 'rbf']);
export const GRIDS = Object.freeze(['given', 'structural', 'auto']);
export const noChoices = Object.freeze({ fill: 'none', minVoxels: 0, velocity: null, grid: 'given' });

/** m/s; the service takes no more. */
const FASTEST = 20_000;

const ATTRIBUTES = Object.freeze(['reliability', 'body']);

/**
 * The coarse levels leave out specks of which no point is farther than one voxel from the middle: nobody sees them from
 * afar, and they take up to a fifth of such a level (a real survey: the same mean error, 6, 15 and 19 % fewer bytes).
 * The two finest levels have everything.
 */
const SPECKS = Object.freeze({ max_error: 1 });
const LEVELS = Object.freeze([
  { ratio: 1 },
  { ratio: 1 / 4 },
  { ratio: 1 / 16, drop: SPECKS },
  { ratio: 1 / 64, drop: SPECKS },
  { ratio: 1 / 256, drop: SPECKS },
]);

/** The request's JSON. */
export function requestOf({ low, high }, { fill, minVoxels, velocity, grid } = noChoices) {
  const request = {
    range: [low, high], missing: { method: fill }, attributes: ATTRIBUTES, levels: LEVELS, ...bodiesOf(minVoxels, velocity),
  };
  if (grid === 'given') return request;
  return { ...request, grid, attributes: isPlaced(grid) ? ATTRIBUTES : [...ATTRIBUTES, 'agreement'] };
}

/** The request for a coarse look at the same body; null where there is none. */
export function previewOf({ low, high }, { minVoxels, velocity, grid } = noChoices) {
  if (isPlaced(grid)) return null;
  return { range: [low, high], attributes: ['body'], preview: true, ...bodiesOf(minVoxels, velocity) };
}

function bodiesOf(minVoxels, velocity) {
  return { ...(minVoxels > 0 && { bodies: { min_voxels: minVoxels } }), ...(velocity && { velocity }) };
}

/** Whether a choice of a grid names one that somebody has placed. */
export function isPlaced(grid) {
  return !GRIDS.includes(grid);
}

/** Whether there is anything to fill in a volume. */
export function hasMissing(volume) {
  return (volume?.missing?.samples ?? 0) > 0;
}

/** Whether a velocity gives a volume lengths: it is in time, metres lie beside, and no placed grid has depths already. */
export function takesVelocity(volume, placed) {
  return volume?.axes.sample.unit === 'ms' && volume.geometry.unit === 'm' && (placed?.times ?? true);
}

/** The velocity that somebody typed; null when the field is empty, undefined when it is none that rock has. */
export function parseVelocity(text) {
  const number = parseEnd(text ?? '');
  return number === null || (number > 0 && number <= FASTEST) ? number : undefined;
}

/** The count that somebody typed; 0 when the field is empty, undefined when it is not a count. */
export function parseMinVoxels(text) {
  const digits = (text ?? '').replace(/[\s\u202f]/g, '');
  if (digits === '') return 0;
  return /^\d{1,15}$/.test(digits) ? Number(digits) : undefined;
}

/** The choices that an address remembers; what it does not say, or says wrongly, is the default. */
export function choicesFromAddress(parameters) {
  const known = (values, value) => (values.includes(value) ? value : values[0]);
  const grid = parameters.get('grid');
  return {
    fill: known(FILLS, parameters.get('missing')),
    minVoxels: parseMinVoxels(parameters.get('min_voxels')) ?? 0,
    velocity: parseVelocity(parameters.get('velocity')) ?? null,
    grid: /^[0-9a-f]{64}$/.test(grid) ? grid : known(GRIDS, grid),
  };
}

/** What the address is to remember: name -> text, null for a default. */
export function choicesToAddress({ fill, minVoxels, velocity, grid }) {
  const unlessFirst = (values, value) => (value === values[0] ? null : value);
  return {
    missing: unlessFirst(FILLS, fill),
    min_voxels: minVoxels > 0 ? String(minVoxels) : null,
    velocity: velocity ? String(velocity) : null,
    grid: unlessFirst(GRIDS, grid),
  };
}
