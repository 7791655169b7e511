/** Meshes as flat arrays: positions (n, 3) float32, triangles (m, 3) uint32, normals (n, 3) float32. */

/** Maps positions by 12 numbers (three rows of a row-major 4 x 4), computed in double. */
export function transformPositions(positions, rows) {
  const mapped = new Float32Array(positions.length);
  for (let at = 0; at < positions.length; at += 3) {
    const [x, y, z] = [positions[at], positions[at + 1], positions[at + 2]];
    for (let row = 0; row < 3; ++row) {
      mapped[at + row] = rows[4 * row] * x + rows[4 * row + 1] * y + rows[4 * row + 2] * z + rows[4 * row + 3];
    }
  }
  return mapped;
}

/** The triangles seen from the other side. */
export function reversedTriangles(triangles) {
  const reversed = triangles.slice();
  for (let at = 0; at < reversed.length; at += 3) {
    reversed[at + 1] = triangles[at + 2];
    reversed[at + 2] = triangles[at + 1];
  }
  return reversed;
}

/** Unit normals of the vertices: the sum of the triangles around each, weighted by area. */
export function vertexNormals(positions, triangles) {
  const sums = new Float64Array(positions.length);
  for (let at = 0; at < triangles.length; at += 3) addTriangle(sums, positions, triangles, at);
  const normals = new Float32Array(positions.length);
  for (let at = 0; at < normals.length; at += 3) {
    const length = Math.hypot(sums[at], sums[at + 1], sums[at + 2]) || 1;
    for (let axis = 0; axis < 3; ++axis) normals[at + axis] = sums[at + axis] / length;
  }
  return normals;
}

function addTriangle(sums, positions, triangles, at) {
  const [a, b, c] = [3 * triangles[at], 3 * triangles[at + 1], 3 * triangles[at + 2]];
  const [ux, uy, uz] = [positions[b] - positions[a], positions[b + 1] - positions[a + 1], positions[b + 2] - positions[a + 2]];
  const [vx, vy, vz] = [positions[c] - positions[a], positions[c + 1] - positions[a + 1], positions[c + 2] - positions[a + 2]];
  const [nx, ny, nz] = [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
  for (const vertex of [a, b, c]) {
    sums[vertex] += nx;
    sums[vertex + 1] += ny;
    sums[vertex + 2] += nz;
  }
}

/**
 * The triangles of one body behind all the others: what is drawn differently lies in one piece.
 *
 * bodies   (n) the body of each vertex; a triangle's vertices are of one body.
 * returns  {triangles (m, 3), others: how many indices come before the body's}
 */
export function bodyLast(triangles, bodies, body) {
  const ordered = new Uint32Array(triangles.length);
  let front = 0;
  let back = triangles.length;
  for (let at = 0; at < triangles.length; at += 3) {
    const to = bodies[triangles[at]] === body ? (back -= 3) : (front += 3) - 3;
    ordered[to] = triangles[at];
    ordered[to + 1] = triangles[at + 1];
    ordered[to + 2] = triangles[at + 2];
  }
  return { triangles: ordered, others: front };
}

/** The box around the vertices of one body in all parts, {low: [x, y, z], high: [x, y, z]}; null when it has none. */
export function boundsOfBody(parts, body) {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (const { positions, body: bodies } of parts) {
    for (let vertex = 0; vertex < (bodies?.length ?? 0); ++vertex) {
      if (bodies[vertex] !== body) continue;
      for (let axis = 0; axis < 3; ++axis) {
        low[axis] = Math.min(low[axis], positions[3 * vertex + axis]);
        high[axis] = Math.max(high[axis], positions[3 * vertex + axis]);
      }
    }
  }
  return low[0] <= high[0] ? { low, high } : null;
}

/** The box made so large around its middle that no side is shorter than `least`: what marks a speck has to be seen. */
export function enlarged({ low, high }, least) {
  const missing = low.map((end, axis) => Math.max(0, least - (high[axis] - end)) / 2);
  return { low: low.map((end, axis) => end - missing[axis]), high: high.map((end, axis) => end + missing[axis]) };
}

export function longestSide({ low, high }) {
  return Math.max(...high.map((end, axis) => end - low[axis]));
}

/** The heights between which the vertices of all parts lie, {bottom, top}; null when there are none. */
export function heightsOf(parts) {
  let [bottom, top] = [Infinity, -Infinity];
  for (const { positions } of parts) {
    for (let at = 1; at < positions.length; at += 3) {
      bottom = Math.min(bottom, positions[at]);
      top = Math.max(top, positions[at]);
    }
  }
  return bottom <= top ? { bottom, top } : null;
}
