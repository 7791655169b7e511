/**
 * What is known of the extraction on the screen. A value: every change makes a new one.
 *
 * phase     idle | waiting | running | done | failed
 * levels    the manifest's level entries known so far, coarsest first
 */
export const idle = Object.freeze({ phase: 'idle', stage: '', progress: 0, levels: [], manifest: null, shown: null, problem: '' });

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

export function levelShown(state, level) {
  return { ...state, shown: level };
}

export function manifestCame(state, manifest) {
  const levels = [...manifest.levels].sort((a, b) => b.level - a.level);
  return { ...state, phase: 'done', stage: '', progress: 1, manifest, levels };
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
      return state.manifest.empty ? 'Nothing of the survey lies in this range.' : describeBody(state.levels.at(-1));
    default:
      return state.problem;
  }
}

const STAGES = {
  queued: 'Waiting for a free worker',
  load: 'Reading the survey',
  extract: 'Extracting the surface',
  simplify: 'Making levels of detail',
  encode: 'Encoding',
  certify: 'Measuring distances',
};

function describeBody({ components, genus, manifold }) {
  const pieces = `${components} ${components === 1 ? 'piece' : 'pieces'}`;
  const tunnels = genus > 0 ? `, ${genus} ${genus === 1 ? 'tunnel' : 'tunnels'}` : '';
  return `Done: ${pieces}${tunnels}${manifold ? '' : '; not a manifold'}.`;
}
