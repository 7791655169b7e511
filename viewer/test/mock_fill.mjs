/**
 * Filling, as far as the page can tell: the mock has the whole survey beside the one with holes, so what is "filled in"
 * is what was left out. Both are files that geosis synth wrote.
 */
import { readFile } from 'node:fs/promises';

const [FIRST_TRACE, TRACE_HEADER, INLINE, CROSSLINE] = [3600, 240, 188, 192];

/** returns  (i, j) -> whether the trace is there. */
export async function tracesOf({ path, document }) {
  const bytes = await readFile(path);
  const { dims, axes } = document;
  const present = new Set();
  for (let trace = FIRST_TRACE; trace < bytes.length; trace += TRACE_HEADER + 4 * dims[2]) {
    const i = (bytes.readInt32BE(trace + INLINE) - axes.inline.first) / axes.inline.step;
    const j = (bytes.readInt32BE(trace + CROSSLINE) - axes.crossline.first) / axes.crossline.step;
    present.add(i * dims[1] + j);
  }
  return (i, j) => present.has(i * dims[1] + j);
}

/** Of each vertex: 255 between traces that are there, less the farther the nearest one is. */
export function reliabilityOf({ positions }, isThere) {
  const known = new Map();
  return Uint8Array.from({ length: positions.length / 3 }, (_, vertex) => {
    const [i, j] = [positions[3 * vertex], positions[3 * vertex + 1]];
    const corners = [[Math.floor(i), Math.floor(j)], [Math.ceil(i), Math.floor(j)], [Math.floor(i), Math.ceil(j)], [Math.ceil(i), Math.ceil(j)]];
    return Math.min(...corners.map(([ci, cj]) => {
      const key = `${ci},${cj}`;
      if (!known.has(key)) known.set(key, reliabilityAt(ci, cj, isThere));
      return known.get(key);
    }));
  });
}

function reliabilityAt(i, j, isThere) {
  const away = distanceToTrace(i, j, isThere);
  return away === 0 ? 255 : Math.round(254 / (1 + (away / 1.2) ** 3));
}

function distanceToTrace(i, j, isThere) {
  for (let away = 0; away < 16; ++away) {
    for (let side = -away; side <= away; ++side) {
      for (const [di, dj] of [[side, -away], [side, away], [-away, side], [away, side]]) if (isThere(i + di, j + dj)) return away;
    }
  }
  return 16;
}
