import assert from 'node:assert/strict';
import { describe, it } from 'node:test';

import { axisTexts, placeTexts } from '../core/labels.js';
import { reversedTriangles, transformPositions, vertexNormals } from '../core/mesh.js';
import {
  BOX_EDGES, cornersBetween, cornersOf, displayTransform, distanceToSee, extentOf, gridFrame, middleOf, suggestedExaggeration, surveyFrame, toDisplay,
} from '../core/placement.js';

const DIMS = [101, 201, 51];
// Inlines go north, crosslines go east, samples go down; far from the origin, as surveys are.
const TRANSFORM = [0, 10, 0, 456000, 20, 0, 0, 6781000, 0, 0, 4, 1000, 0, 0, 0, 1];

describe('displayTransform', () => {
  const display = displayTransform(TRANSFORM, middleOf({ transform: TRANSFORM, dims: DIMS }));

  it('puts the middle of the survey at the origin', () => {
    assert.deepEqual(toDisplay(display, [50, 100, 25]).map(Math.abs), [0, 0, 0]);
  });

  it('has east to the right, north away from the eye and depth downwards', () => {
    const at = (index) => toDisplay(display, index);
    assert.ok(at([50, 200, 25])[0] > 0);
    assert.ok(at([100, 100, 25])[2] < 0);
    assert.ok(at([50, 100, 50])[1] < 0);
  });

  it('keeps the differences that float32 would lose at world coordinates', () => {
    const near = transformPositions(new Float32Array([0, 0, 0, 1 / 64, 0, 0]), display);
    assert.equal(near[2] - near[5], 20 / 64);
  });
});

describe('survey box', () => {
  it('has twelve edges along one axis each', () => {
    const corners = cornersOf(DIMS);
    assert.equal(BOX_EDGES.length, 12);
    for (const [from, to] of BOX_EDGES) {
      assert.equal(corners[from].filter((coordinate, axis) => coordinate !== corners[to][axis]).length, 1);
    }
  });

  it('is labelled with the numbers of the axes', () => {
    const axes = { inline: { first: 1001, step: 2 }, crossline: { first: 5, step: 1 }, sample: { first: 1000, step: 4, unit: 'ms' } };
    const volume = { dims: DIMS, axes, geometry: { transform: TRANSFORM, unit: 'm' } };
    assert.deepEqual(axisTexts(surveyFrame(volume)).flat(), ['1001', 'Inline', '1201', '5', 'Crossline', '205', '1000', 'Time, ms', '1200']);
    const deep = surveyFrame(volume, 2500);
    assert.deepEqual(axisTexts(deep)[2], ['1250', 'Depth, m', '1500']);
    assert.deepEqual(middleOf(deep)[2], 1.25 * middleOf(surveyFrame(volume))[2]);
  });

  it('has numbers as fine as its length asks for', () => {
    const axis = (first, step) => ({ first, step });
    const frame = { dims: [5, 5, 5], names: ['a', 'b', 'c'], axes: { inline: axis(0.123, 0.5), crossline: axis(1.6, 333), sample: axis(null, null) } };
    assert.deepEqual(axisTexts(frame), [['0.12', 'a', '2.12'], ['2', 'b', '1334'], ['0', 'c', '4']]);
  });

  it('exaggerates flat surveys, and lowers those that are taller than wide', () => {
    const extent = extentOf(displayTransform(TRANSFORM, middleOf({ transform: TRANSFORM, dims: DIMS })), DIMS);
    assert.deepEqual(extent, { horizontal: 2000, vertical: 200 });
    assert.equal(suggestedExaggeration(extent), 4);
    assert.equal(suggestedExaggeration({ horizontal: 1, vertical: 1.2 }), 1);
    assert.equal(suggestedExaggeration({ horizontal: 2, vertical: 1 }), 1);
    assert.equal(suggestedExaggeration({ horizontal: 4, vertical: 10 }), 0.5);
    assert.equal(suggestedExaggeration({ horizontal: 4, vertical: 196 }), 0.03);
    assert.equal(suggestedExaggeration({ horizontal: 1e6, vertical: 1 }), 20);
    assert.equal(suggestedExaggeration({ horizontal: 1, vertical: 0 }), 1);
  });
});

describe('distanceToSee', () => {
  it('is the least from which every point lies within the view', () => {
    assert.equal(distanceToSee([[0, 0, -5], [3, 0, 1]], 0.5, 0.25), 7);
    assert.equal(distanceToSee([[3, 2, 1]], 0.5, 0.25), 9);
  });
});

describe('the frame of a placed grid', () => {
  const box = [[456000, 6781000, 1500], [458000, 6783000, 2500]];
  const frame = gridFrame({ box, times: false }, { geometry: { unit: 'm' } });

  it('is the box around its nodes', () => {
    assert.deepEqual(middleOf(frame), [457000, 6782000, 2000]);
    const display = displayTransform(frame.transform, middleOf(frame));
    assert.deepEqual(toDisplay(display, [0, 0, 0]), [-1000, 500, 1000]);
    assert.deepEqual(toDisplay(display, [1, 1, 1]), [1000, -500, -1000]);
    assert.deepEqual(axisTexts(frame).flat(),
      ['456000', 'x', '458000', '6781000', 'y', '6783000', '1500', 'Depth, m', '2500']);
  });

  it('has depths where its times meet a velocity', () => {
    const times = gridFrame({ box, times: true }, { geometry: { unit: 'm' } }, 4000);
    assert.deepEqual(axisTexts(times)[2], ['3000', 'Depth, m', '5000']);
    assert.deepEqual(gridFrame({ box, times: false }, { geometry: { unit: 'm' } }, 4000), frame);
  });

  it('takes levels in by the transform of their manifest', () => {
    const unit = 8;
    const transform = [unit, 0, 0, 456992, 0, unit, 0, 6781992, 0, 0, unit, 1992, 0, 0, 0, 1];
    assert.deepEqual(toDisplay(displayTransform(transform, middleOf(frame)), [1, 1, 1]).map(Math.abs), [0, 0, 0]);
  });
});

describe('mesh', () => {
  //  2
  //  | \      in the plane z = 0, counter-clockwise seen from above
  //  0--1
  const positions = new Float32Array([0, 0, 0, 1, 0, 0, 0, 1, 0]);
  const triangles = new Uint32Array([0, 1, 2]);

  it('has normals towards the side from which triangles are counter-clockwise', () => {
    assert.deepEqual([...vertexNormals(positions, triangles)], [0, 0, 1, 0, 0, 1, 0, 0, 1]);
    assert.deepEqual([...vertexNormals(positions, reversedTriangles(triangles))].slice(0, 3).map(Math.sign), [0, 0, -1]);
  });

  it('has no NaN in the normals of a vertex without area', () => {
    assert.deepEqual([...vertexNormals(positions, new Uint32Array([0, 0, 1]))], new Array(9).fill(0));
  });
});

describe('the texts around the box', () => {
  const corners = cornersBetween({ low: [-2, -0.5, -1], high: [2, 0.5, 1] });
  const sizes = [0, 1, 2].map(() => [[30, 14], [52, 14], [30, 14]]);
  const view = [900, 700];

  /** The corners seen from a place, looking at the origin. */
  function seenFrom(eye) {
    const length = (v) => Math.hypot(...v);
    const scaled = (v, factor) => v.map((c) => c * factor);
    const cross = ([a, b, c], [d, e, f]) => [b * f - c * e, c * d - a * f, a * e - b * d];
    const back = scaled(eye, 1 / length(eye));
    const sideways = cross([0, 1, 0], back);
    const right = scaled(sideways, 1 / length(sideways));
    const up = cross(back, right);
    const dot = (a, b) => a.reduce((sum, c, axis) => sum + c * b[axis], 0);
    return corners.map((corner) => {
      const from = corner.map((c, axis) => c - eye[axis]);
      const depth = -dot(from, back);
      return depth > 0 ? [450 + (900 * dot(from, right)) / depth, 350 - (900 * dot(from, up)) / depth] : null;
    });
  }

  const boxesOf = (places) => places.flatMap((texts, axis) => texts.map((middle, at) => middle && { middle, size: sizes[axis][at] })).filter(Boolean);
  const isInside = ([x, y], { middle, size }) => Math.abs(x - middle[0]) < size[0] / 2 && Math.abs(y - middle[1]) < size[1] / 2;

  /** Points of the box all over. */
  const points = [...Array(11 ** 3).keys()].map((n) => [n % 11, Math.floor(n / 11) % 11, Math.floor(n / 121)].map((c) => c / 10));
  const mixed = (screen, [u, v, w]) => screen.reduce(([x, y], corner, at) => {
    const weight = (at & 1 ? u : 1 - u) * (at & 2 ? v : 1 - v) * (at & 4 ? w : 1 - w);
    return [x + weight * corner[0], y + weight * corner[1]];
  }, [0, 0]);

  const eyes = [];
  for (let around = 0.1; around < 6.2; around += 0.37) {
    for (const height of [-6, -2, 0.2, 2, 6]) eyes.push([9 * Math.cos(around), height, 9 * Math.sin(around)]);
  }

  it('never lie over the survey or over each other, and always on the canvas', () => {
    let placed = 0;
    for (const eye of eyes) {
      const screen = seenFrom(eye);
      const boxes = boxesOf(placeTexts({ corners, eye, screen, sizes, view }));
      placed += boxes.length;
      for (const box of boxes) {
        for (const axis of [0, 1]) assert.ok(box.middle[axis] >= box.size[axis] / 2 && box.middle[axis] <= view[axis] - box.size[axis] / 2);
        assert.ok(!points.some((point) => isInside(mixed(screen, point), box)), `over the survey from ${eye}`);
        const others = boxes.filter((other) => other !== box);
        const isApart = (other) => [0, 1].some((axis) => Math.abs(box.middle[axis] - other.middle[axis]) >= (box.size[axis] + other.size[axis]) / 2);
        assert.ok(others.every(isApart), `over each other from ${eye}`);
      }
    }
    assert.ok(placed > 7.5 * eyes.length, `${placed / eyes.length} texts of 9`);
  });

  it('leave out what lies beside the canvas, behind the eye or under something else', () => {
    const eye = [5, 4, 9];
    const screen = seenFrom(eye);
    const away = screen.map(([x, y]) => [x + 5000, y]);
    assert.equal(boxesOf(placeTexts({ corners, eye, screen: away, sizes, view })).length, 0);
    assert.equal(boxesOf(placeTexts({ corners, eye, screen: screen.map(() => null), sizes, view })).length, 0);
    const taken = [{ left: 0, top: 0, right: view[0], bottom: view[1] }];
    assert.equal(boxesOf(placeTexts({ corners, eye, screen, sizes, view, taken })).length, 0);
  });

  it('name the axes of a survey of one inline, too', () => {
    const flat = cornersBetween({ low: [0, -0.5, -1], high: [0, 0.5, 1] });
    const screen = flat.map(([, y, z]) => [450 + 200 * z, 350 - 200 * y]);
    const places = placeTexts({ corners: flat, eye: [9, 1, 0], screen, sizes, view });
    assert.deepEqual(places.map((texts) => texts[1] !== null), [false, true, true]);
  });
});
