import assert from 'node:assert/strict';
import { describe, it } from 'node:test';

import { reversedTriangles, transformPositions, vertexNormals } from '../core/mesh.js';
import {
  axisLabels, BOX_EDGES, cornersOf, displayTransform, distanceToSee, extentOf, gridFrame, middleOf, suggestedExaggeration, surveyFrame, toDisplay,
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
    const texts = axisLabels(surveyFrame({ dims: DIMS, axes, geometry: {} })).map(({ text }) => text);
    assert.deepEqual(texts, ['1001', 'Inline', '1201', '5', 'Crossline', '205', '1000', 'Time, ms', '1200']);
  });

  it('exaggerates flat surveys only', () => {
    const extent = extentOf(displayTransform(TRANSFORM, middleOf({ transform: TRANSFORM, dims: DIMS })), DIMS);
    assert.deepEqual(extent, { horizontal: 2000, vertical: 200 });
    assert.equal(suggestedExaggeration(extent), 4);
    assert.equal(suggestedExaggeration({ horizontal: 1, vertical: 5 }), 1);
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
    assert.deepEqual(axisLabels(frame).map(({ text }) => text),
      ['456000', 'x', '458000', '6781000', 'y', '6783000', '1500', 'Depth, m', '2500']);
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
