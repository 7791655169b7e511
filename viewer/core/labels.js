/**
 * The texts around the survey's box: each axis' name, and its first and last number. An axis is told along an edge of the
 * box that is at the rim of what is seen of it, and the texts stand outside of that edge: none lies over a body.
 */

/** [first number, name, last number] of each axis. */
export function axisTexts({ dims, axes, names }) {
  return [axes.inline, axes.crossline, axes.sample].map(({ first, step }, at) => {
    const length = (dims[at] - 1) * (step ?? 1);
    const number = (value) => String(Number(value.toFixed(Math.abs(length) < 100 ? 2 : 0)));
    return [number(first ?? 0), names[at], number((first ?? 0) + length)];
  });
}

/** Pixels between an edge and its texts, and between two texts. */
const GAP = 7;
const APART = 3;

/** Where a name may stand along what is seen of its edge, best first. */
const NAME_PLACES = Object.freeze([0.5, 0.38, 0.62, 0.26, 0.74]);

/**
 * Puts the texts on the screen.
 *
 * corners  the box's 8 corners and eye, both in the same space, numbered as cornersOf() does
 * screen   the corners' [x, y] in pixels, null behind the eye
 * sizes    [width, height] of each text, as axisTexts() orders them: 3 axes of 3
 * view     [width, height] of the canvas
 * taken    boxes {left, top, right, bottom} where nothing may stand
 * returns  the middle [x, y] of each text in the order of sizes, null where there is no place for it
 */
export function placeTexts({ corners, eye, screen, sizes, view, taken = [] }) {
  const places = sizes.map(() => sizes.map(() => null));
  const boxes = [...taken];
  const settle = (axis, which, middles) => {
    const size = sizes[axis][which];
    for (const middle of middles) {
      const inside = clamped(middle, size, view);
      const box = boxAround(inside, size);
      if (boxes.some((other) => overlap(box, other))) continue;
      boxes.push(box);
      places[axis][which] = inside;
      return;
    }
  };
  const edges = [0, 1, 2].map((axis) => sideOf(labelledEdge(axis, corners, eye, screen), screen, view));
  for (const axis of [0, 1, 2]) {
    if (edges[axis]) settle(axis, 1, NAME_PLACES.map((share) => beside(edges[axis], share, sizes[axis][1])));
  }
  for (const axis of [0, 1, 2]) {
    for (const end of [0, 1]) {
      if (edges[axis]?.[end ? 'to' : 'from'].isSeen) settle(axis, 2 * end, [atEnd(edges[axis], end, sizes[axis][2 * end])]);
    }
  }
  return places;
}

/** The corners of the edge that an axis is told along: the lowest at the rim, for the vertical axis the leftmost; or null. */
export function labelledEdge(axis, corners, eye, screen) {
  const starts = corners.map((_, corner) => corner).filter((corner) => !((corner >> axis) & 1));
  const edges = starts.map((corner) => [corner, corner | (1 << axis)]);
  const isSeen = facesTowards(corners, eye);
  const [left, right] = [0, 1, 2].filter((other) => other !== axis);
  const isAtRim = ([corner]) => !isSeen || isSeen[left][(corner >> left) & 1] !== isSeen[right][(corner >> right) & 1];
  const rim = edges.filter((edge) => edge.every((corner) => screen[corner]) && isAtRim(edge));
  const rank = ([from, to]) => (axis === 2 ? -(screen[from][0] + screen[to][0]) : screen[from][1] + screen[to][1]);
  return rim.reduce((best, edge) => (best && rank(best) >= rank(edge) ? best : edge), null);
}

/** For each axis whether its first and its last face are seen from the eye; null for a box without a volume. */
function facesTowards(corners, eye) {
  const sides = [0, 1, 2].map((axis) => minus(corners[1 << axis], corners[0]));
  const normals = [cross(sides[1], sides[2]), cross(sides[2], sides[0]), cross(sides[0], sides[1])];
  const volume = dot(normals[0], sides[0]);
  if (volume === 0) return null;
  return normals.map((normal, axis) => [0, 1].map((side) => {
    const height = dot(normal, minus(eye, corners[side << axis])) * Math.sign(volume);
    return side ? height > 0 : height < 0;
  }));
}

/** What is seen of an edge: its ends on the screen, its direction and the side of it that is outside of the box; null for nothing. */
function sideOf(edge, screen, view) {
  if (!edge) return null;
  const [from, to] = edge.map((corner) => screen[corner]);
  const clip = clipped(from, to, view);
  const length = Math.hypot(to[0] - from[0], to[1] - from[1]);
  if (!clip || length < 1) return null;
  const along = [(to[0] - from[0]) / length, (to[1] - from[1]) / length];
  const seen = screen.filter(Boolean);
  const middle = [0, 1].map((axis) => seen.reduce((sum, point) => sum + point[axis], 0) / seen.length);
  const side = [-along[1], along[0]];
  const isOutward = side[0] * (from[0] - middle[0]) + side[1] * (from[1] - middle[1]) > 0;
  const at = (share) => [from[0] + share * (to[0] - from[0]), from[1] + share * (to[1] - from[1])];
  return {
    from: { at: from, isSeen: clip[0] === 0 }, to: { at: to, isSeen: clip[1] === 1 }, seen: clip.map(at), length, along,
    outward: isOutward ? side : side.map((c) => -c),
  };
}

/** The middle of a text beside an edge, at a share of what is seen of it. */
function beside({ seen: [from, to], outward }, share, size) {
  const away = GAP + reach(size, outward);
  return [0, 1].map((axis) => from[axis] + share * (to[axis] - from[axis]) + away * outward[axis]);
}

/** The middle of a text beside an end of an edge: it begins where the edge does, so that texts of two axes do not meet there. */
function atEnd({ from, to, along, outward, length }, end, size) {
  const away = GAP + reach(size, outward);
  const inwards = Math.min(reach(size, along), length / 2) * (end ? -1 : 1);
  return [0, 1].map((axis) => (end ? to : from).at[axis] + inwards * along[axis] + away * outward[axis]);
}

/** How far a text of a size reaches from its middle into a direction. */
function reach([width, height], [x, y]) {
  return (Math.abs(x) * width + Math.abs(y) * height) / 2;
}

/** The shares of the line from a to b between which it lies on the canvas, [first, last]; null when it does not. */
function clipped(a, b, view) {
  let [first, last] = [0, 1];
  for (const axis of [0, 1]) {
    const length = b[axis] - a[axis];
    const ends = [-a[axis], view[axis] - a[axis]];
    if (length === 0) {
      if (ends[0] > 0 || ends[1] < 0) return null;
      continue;
    }
    const shares = ends.map((end) => end / length).sort((p, q) => p - q);
    first = Math.max(first, shares[0]);
    last = Math.min(last, shares[1]);
  }
  return first < last ? [first, last] : null;
}

function clamped(middle, size, view) {
  return middle.map((at, axis) => Math.min(view[axis] - size[axis] / 2 - APART, Math.max(size[axis] / 2 + APART, at)));
}

function boxAround([x, y], [width, height]) {
  return { left: x - width / 2 - APART, right: x + width / 2 + APART, top: y - height / 2, bottom: y + height / 2 };
}

function overlap(a, b) {
  return a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;
}

const minus = (a, b) => a.map((coordinate, axis) => coordinate - b[axis]);
const dot = (a, b) => a.reduce((sum, coordinate, axis) => sum + coordinate * b[axis], 0);
const cross = ([a, b, c], [d, e, f]) => [b * f - c * e, c * d - a * f, a * e - b * d];
