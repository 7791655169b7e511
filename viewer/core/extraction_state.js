import { asSentence, counted, formatCount, formatShare } from './format.js';

/**
 * What is known of the extraction on the screen. A value: every change makes a new one.
 *
 * phase     idle | waiting | running | done | failed
 * levels    the manifest's level entries known so far, coarsest first
 * here      the levels that are decoded; shown: the one on the screen; chosen: by somebody, null = the finest that is here
 * bodies    the entries of its bodies, largest first; null until they are here, and when they could not be had
 */
export const idle = Object.freeze({
  phase: 'idle', stage: '', progress: 0, levels: [], manifest: null, here: [], shown: null, chosen: null, problem: '',
  bodies: null, bodiesProblem: '',
});

export function started() {
  return { ...idle, phase: 'waiting', stage: 'queued' };
}

export function progressed(state, { stage, progress }) {
  if (state.phase === 'done' || state.phase === 'failed') return state;
  const fraction = Number.isFinite(progress) ? Math.min(1, Math.max(0, progress)) : state.progress;
  return { ...state, phase: 'running', stage: stage ?? state.stage, progress: fraction };
}

/** A level's entry came, without its distance yet. */
export function levelKnown(state, entry) {
  if (state.manifest) return state;
  const others = state.levels.filter(({ level }) => level !== entry.level);
  return { ...state, levels: [...others, entry].sort((a, b) => b.level - a.level) };
}

/** A level is decoded, a finer one than those before: it is shown, unless somebody has chosen another. */
export function levelCame(state, level) {
  return { ...state, here: [...state.here, level], shown: state.chosen ?? level };
}

/** Somebody chose a level that is here. Whoever chooses the finest sees those that are still to come, too. */
export function levelChosen(state, level) {
  if (!state.here.includes(level)) return state;
  return { ...state, shown: level, chosen: level === Math.min(...state.here) ? null : level };
}

export function manifestCame(state, manifest) {
  const levels = [...manifest.levels].sort((a, b) => b.level - a.level);
  return { ...state, phase: 'done', stage: '', progress: 1, manifest, levels };
}

export function bodiesCame(state, bodies) {
  return { ...state, bodies, bodiesProblem: '' };
}

/** The surface stays: only the list of its bodies is not to be had. */
export function bodiesFailed(state, problem) {
  return { ...state, bodies: null, bodiesProblem: problem };
}

export function failed(state, problem) {
  return { ...state, phase: 'failed', problem };
}

/** One sentence for people on where it stands. */
export function describe(state) {
  switch (state.phase) {
    case 'idle':
      return 'Choose a range and reconstruct.';
    case 'waiting':
      return 'Waiting for a free worker …';
    case 'running':
      return `${STAGES[state.stage] ?? 'Working'} …`;
    case 'done':
      return state.manifest.empty ? describeNothing(state.manifest) : describeSurface(state.levels.at(-1), state.bodies);
    default:
      return state.problem;
  }
}

/** The same sentence while a preview is on the screen. */
export function describePreview(isEmpty) {
  return isEmpty ? 'Preview: nothing lies in this range.' : 'Preview: rough, topology not promised.';
}

const STAGES = {
  queued: 'Waiting for a free worker',
  load: 'Reading the survey',
  fill: 'Filling missing samples',
  grid: 'Following the reflectors',
  extract: 'Extracting the surface',
  simplify: 'Making levels of detail',
  encode: 'Encoding',
  certify: 'Measuring distances',
};

function describeNothing({ request }) {
  const dropped = request?.bodies?.min_voxels > 0;
  return dropped ? 'No body in this range is that large.' : 'Nothing of the survey lies in this range.';
}

/** One sentence for the section of the bodies. */
export function describeBodies({ phase, manifest, bodies, bodiesProblem }) {
  if (bodiesProblem) return `The list of bodies is not to be had: ${bodiesProblem}`;
  if (phase === 'waiting' || phase === 'running') return 'They are listed when the last level is here.';
  if (phase !== 'done') return 'Nothing reconstructed yet.';
  if (manifest.empty) return 'None.';
  if (!bodies) return 'Counting …';
  const count = bodies.length === 1 ? 'One body' : `${formatCount(bodies.length)} bodies`;
  const surfaces = bodies.reduce((sum, { components }) => sum + (components ?? 1), 0);
  const inside = surfaces > bodies.length ? `, and cavities inside: ${formatCount(surfaces)} surfaces` : '';
  return `${count}${inside}.${bodies.length > 1 ? ' Click one, here or in the view, to single it out.' : ''}`;
}

/** Which grid it lies on, why, and how far that is to be trusted; nothing to say on the survey's own. */
export function describeGrid({ manifest }) {
  const grid = manifest?.grid;
  if (!grid) return '';
  if (grid.chosen === 'curvilinear') return `Where the grid's nodes are placed.${describeFolds(grid)}`;
  const what = grid.chosen === 'structural' ? 'Joined along the reflectors' : 'Joined along the axes';
  const why = grid.asked === 'auto' ? `: ${grid.because}` : '';
  const doubt = grid.chosen === 'structural' && grid.unreliable_share > 0
    ? ` ${asSentence(`${formatShare(grid.unreliable_share)} of the samples lie where traces hardly agree`)}` : '';
  return `${what}${why}.${doubt}`;
}

function describeFolds({ folded_share: folded }) {
  return folded > 0 ? ` ${formatShare(folded)} of its cells are folded: the surface may cross itself there.` : '';
}

/** Bodies, once they are counted; surfaces until then, which may be more: one around each body and one around each cavity. */
function describeSurface({ components, genus, manifold }, bodies) {
  const count = bodies ? counted(bodies.length, 'body', 'bodies') : counted(components, 'surface');
  const tunnels = genus > 0 ? `, ${counted(genus, 'tunnel')}` : '';
  return `Done: ${count}${tunnels}${manifold ? '' : '; not a manifold'}.`;
}
