/**
 * What the command line does not tell yet, made up well enough for the page: which body each vertex is of, and the list
 * of bodies. A piece of the surface counts as a body; parts of a level meet at equal positions.
 *
 * levels   {level, parts: [{positions, triangles}]}, index coordinates.
 */

/** Adds body: Uint32Array to each part; returns the bodies, largest first. */
export function findBodies(levels) {
  const [finest, ...coarser] = [...levels].sort((a, b) => a.level - b.level);
  const pieces = piecesOf(finest.parts).sort((a, b) => b.measured.volume - a.measured.volume);
  pieces.forEach((piece, body) => label(piece, body));
  for (const { parts } of coarser) for (const piece of piecesOf(parts)) label(piece, nearest(pieces, piece));
  return pieces.map(({ measured }, body) => ({ body, ...measured }));
}

function label({ vertices }, body) {
  for (const [part, vertex] of vertices) part.body[vertex] = body;
}

function nearest(pieces, { measured: { bbox } }) {
  const away = pieces.map(({ measured }) => [0, 1].reduce((sum, end) => sum + distance(measured.bbox[end], bbox[end]), 0));
  return away.indexOf(Math.min(...away));
}

function distance(a, b) {
  return Math.hypot(...a.map((value, axis) => value - b[axis]));
}

/** [{vertices: [[part, vertex]], measured}] of one level. */
function piecesOf(parts) {
  const { rootOf, total } = joined(parts);
  const pieces = new Map();
  let first = 0;
  for (const part of parts) {
    part.body = new Uint32Array(part.positions.length / 3);
    for (let vertex = 0; vertex < part.body.length; ++vertex) {
      const root = rootOf(first + vertex);
      if (!pieces.has(root)) pieces.set(root, { vertices: [], triangles: [] });
      pieces.get(root).vertices.push([part, vertex]);
    }
    for (let at = 0; at < part.triangles.length; at += 3) pieces.get(rootOf(first + part.triangles[at])).triangles.push([part, at]);
    first += part.body.length;
  }
  if (first !== total) throw new Error('vertices were lost');
  return [...pieces.values()].map((piece) => ({ ...piece, measured: measure(piece) }));
}

/** Union-find over the vertices of all parts, joined along triangles and at equal positions. */
function joined(parts) {
  const total = parts.reduce((sum, { positions }) => sum + positions.length / 3, 0);
  const parent = Uint32Array.from({ length: total }, (_, vertex) => vertex);
  const rootOf = (vertex) => {
    while (parent[vertex] !== vertex) vertex = parent[vertex] = parent[parent[vertex]];
    return vertex;
  };
  const join = (a, b) => (parent[rootOf(a)] = rootOf(b));
  const seen = new Map();
  let first = 0;
  for (const { positions, triangles } of parts) {
    for (let vertex = 0; parts.length > 1 && vertex < positions.length / 3; ++vertex) {
      const key = positions.slice(3 * vertex, 3 * vertex + 3).join();
      if (seen.has(key)) join(first + vertex, seen.get(key));
      seen.set(key, first + vertex);
    }
    for (let at = 0; at < triangles.length; at += 3) {
      join(first + triangles[at], first + triangles[at + 1]);
      join(first + triangles[at], first + triangles[at + 2]);
    }
    first += positions.length / 3;
  }
  return { rootOf, total };
}

function measure({ vertices, triangles }) {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (const [{ positions }, vertex] of vertices) {
    for (let axis = 0; axis < 3; ++axis) {
      low[axis] = Math.min(low[axis], positions[3 * vertex + axis]);
      high[axis] = Math.max(high[axis], positions[3 * vertex + axis]);
    }
  }
  const filled = vertices.filter(([{ reliability }, vertex]) => reliability && reliability[vertex] < 255).length;
  const volume = Math.abs(triangles.reduce((sum, [part, at]) => sum + coneOf(part, at), 0));
  const euler = vertices.length - triangles.length / 2;
  return { volume, bbox: [low, high], genus: Math.max(0, Math.round(1 - euler / 2)), filled: filled / vertices.length };
}

/** Signed volume between a triangle and the origin. */
function coneOf({ positions, triangles }, at) {
  const [[ax, ay, az], [bx, by, bz], [cx, cy, cz]] = [0, 1, 2].map((corner) =>
    positions.subarray(3 * triangles[at + corner], 3 * triangles[at + corner] + 3));
  return (ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)) / 6;
}

/** What is left of a part without the bodies that are too small. */
export function keepBodies(part, isKept) {
  const triangles = [];
  for (let at = 0; at < part.triangles.length; at += 3) {
    if (isKept(part.body[part.triangles[at]])) triangles.push(...part.triangles.subarray(at, at + 3));
  }
  const used = [...new Set(triangles)];
  const place = new Map(used.map((vertex, at) => [vertex, at]));
  return {
    positions: Float32Array.from(used.flatMap((vertex) => [...part.positions.subarray(3 * vertex, 3 * vertex + 3)])),
    triangles: Uint32Array.from(triangles, (vertex) => place.get(vertex)),
    body: Uint32Array.from(used, (vertex) => part.body[vertex]),
    reliability: part.reliability && Uint8Array.from(used, (vertex) => part.reliability[vertex]),
  };
}

/** A body as the service lists it; the amplitudes are made up. */
export function documentOf({ body, volume, bbox, genus, filled }, low) {
  const mean = low + 0.3 / (2 + (body % 5));
  return {
    body, voxels: Math.round(volume), volume: null, area: null, bbox, centroid: bbox[0].map((end, axis) => (end + bbox[1][axis]) / 2),
    genus, cavities: 0, components: 1, amplitude: { mean, min: low, max: 2 * mean - low }, interpolated_share: filled,
    volume_voxels: volume,
  };
}
