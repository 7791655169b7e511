import assert from 'node:assert/strict';
import { describe, it } from 'node:test';

import { bodiesTable, describeBody, describeSmaller, toggled } from '../core/bodies.js';
import {
  bodyColour, colouringFor, colouringsOf, doubtfulShare, filledShare, linearOf, palenessOf, RAMP, swatchColour, vertexColours,
} from '../core/colours.js';
import {
  bodiesCame, bodiesFailed, describe as sentenceOf, describeBodies, idle, manifestCame, progressed, started,
} from '../core/extraction_state.js';
import { formatAmplitude, formatVolume } from '../core/format.js';
import { bodyLast, boundsOfBody, enlarged, heightsOf, longestSide } from '../core/mesh.js';
import {
  choicesFromAddress, choicesToAddress, hasMissing, noChoices, parseMinVoxels, parseVelocity, previewOf, requestOf, takesVelocity,
} from '../core/request.js';
import { colourDifference, luminanceOf, VISIONS } from './colour_vision.mjs';

const entry = (body, more = {}) => ({
  body, voxels: 1234, volume: null, volume_voxels: 1100, genus: 0, cavities: 0, components: 1, amplitude: { mean: 0.5678, min: 0.5, max: 0.75 }, interpolated_share: 0, ...more,
});

const GRID = '0123456789abcdef'.repeat(4);

describe('request', () => {
  it('asks for both attributes and leaves missing traces open', () => {
    const { levels, ...request } = requestOf({ low: 0.5, high: null });
    assert.deepEqual(request, { range: [0.5, null], missing: { method: 'none' }, attributes: ['reliability', 'body'] });
    assert.equal(levels.length, 5);
  });

  it('leaves specks out of the coarse levels only', () => {
    const { levels } = requestOf({ low: 0.5, high: null });
    assert.deepEqual(levels.map(({ drop }) => drop?.max_error ?? 0), [0, 0, 1, 1, 1]);
    assert.deepEqual(levels.map(({ ratio }) => ratio), [1, 1 / 4, 1 / 16, 1 / 64, 1 / 256]);
  });

  it('has the way of filling and the smallest body', () => {
    const { missing, bodies } = requestOf({ low: null, high: 1 }, { ...noChoices, fill: 'rbf', minVoxels: 20 });
    assert.deepEqual([missing, bodies], [{ method: 'rbf' }, { min_voxels: 20 }]);
  });

  it('asks for the grid that follows reflectors, and how well traces agree on it', () => {
    const { grid, attributes } = requestOf({ low: 0, high: 1 }, { ...noChoices, grid: 'auto' });
    assert.deepEqual([grid, attributes], ['auto', ['reliability', 'body', 'agreement']]);
    assert.equal(requestOf({ low: 0, high: 1 }).grid, undefined);
    const placed = requestOf({ low: 0, high: 1 }, { ...noChoices, grid: GRID });
    assert.deepEqual([placed.grid, placed.attributes], [GRID, ['reliability', 'body']]);
  });

  it('has previews, but for placed grids', () => {
    assert.deepEqual(previewOf({ low: 0.5, high: null }), { range: [0.5, null], attributes: ['body'], preview: true });
    assert.deepEqual(previewOf({ low: 0, high: 1 }, { ...noChoices, minVoxels: 9 }).bodies, { min_voxels: 9 });
    assert.equal(previewOf({ low: 0, high: 1 }, { ...noChoices, grid: GRID }), null);
  });

  it('comes back from the page address', () => {
    for (const choices of [noChoices, { ...noChoices, fill: 'linear', grid: 'structural' }, { fill: 'rbf', minVoxels: 7, velocity: 2500.5, grid: 'auto' },
      { ...noChoices, grid: GRID }]) {
      const kept = Object.entries(choicesToAddress(choices)).filter(([, value]) => value !== null);
      assert.deepEqual(choicesFromAddress(new URLSearchParams(kept)), choices);
    }
  });

  it('takes the default for what an address says wrongly', () => {
    assert.deepEqual(choicesFromAddress(new URLSearchParams('missing=magic&min_voxels=-3&grid=round&velocity=fast')), noChoices);
  });

  it('reads counts, and refuses what is none', () => {
    assert.equal(parseMinVoxels(' 1\u202f200 '), 1200);
    assert.equal(parseMinVoxels(''), 0);
    for (const text of ['-1', '2.5', 'few', '1e3']) assert.equal(parseMinVoxels(text), undefined, text);
  });

  it('turns times into depths by a velocity, in previews too', () => {
    assert.equal(requestOf({ low: 0, high: 1 }, { ...noChoices, velocity: 2500 }).velocity, 2500);
    assert.equal(previewOf({ low: 0, high: 1 }, { ...noChoices, velocity: 2500 }).velocity, 2500);
    assert.ok(!('velocity' in requestOf({ low: 0, high: 1 })));
  });

  it('reads velocities, and refuses what is none', () => {
    assert.deepEqual([parseVelocity(''), parseVelocity(undefined), parseVelocity(' 2500,5 ')], [null, null, 2500.5]);
    for (const text of ['0', '-1', '20001', 'fast']) assert.equal(parseVelocity(text), undefined, text);
  });

  it('takes a velocity where there are times, and lengths beside them', () => {
    const volume = (sample, unit) => ({ axes: { sample: { unit: sample } }, geometry: { unit } });
    assert.ok(takesVelocity(volume('ms', 'm')));
    assert.ok(takesVelocity(volume('ms', 'm'), { times: true }));
    for (const other of [volume('m', 'm'), volume('ms', 'ft'), volume('ms', '')]) assert.ok(!takesVelocity(other));
    assert.ok(!takesVelocity(volume('ms', 'm'), { times: false }));
    assert.ok(!takesVelocity(null));
  });

  it('knows surveys with something to fill', () => {
    assert.ok(hasMissing({ missing: { samples: 1, traces: 0 } }));
    assert.ok(!hasMissing({ missing: { samples: 0, traces: 0 } }));
    assert.ok(!hasMissing(null));
  });
});

describe('body colours', () => {
  const SKIES = { light: '#e9ecec', dark: '#101417' };
  const numbers = (count) => [...Array(count).keys()];

  it('are the same for the same number, and differ from those before and after', () => {
    for (const body of numbers(200)) {
      assert.match(bodyColour(body), /^#[0-9a-f]{6}$/);
      assert.equal(bodyColour(body), bodyColour(body));
      for (const later of [1, 2, 3, 4, 5, 6, 7]) assert.notEqual(bodyColour(body), bodyColour(body + later));
    }
    assert.match(bodyColour(2 ** 32 - 1), /^#[0-9a-f]{6}$/);
  });

  it('of the eight largest bodies stay apart for every kind of colour vision', () => {
    for (const vision of Object.keys(VISIONS)) {
      for (const a of numbers(8)) {
        for (const b of numbers(a)) assert.ok(colourDifference(bodyColour(a), bodyColour(b), vision) > 0.06, `${vision}: ${a}, ${b}`);
      }
    }
  });

  it('stand out from the sky of both themes', () => {
    for (const [theme, sky] of Object.entries(SKIES)) {
      for (const body of numbers(24)) {
        const [darker, brighter] = [luminanceOf(sky), luminanceOf(bodyColour(body))].sort((a, b) => a - b);
        assert.ok((brighter + 0.05) / (darker + 0.05) > 1.3, `${theme}: ${body}`);
      }
    }
  });
});

describe('vertex colours', () => {
  const part = { positions: new Float32Array(9), body: Uint32Array.of(0, 3, 0), reliability: Uint8Array.of(255, 0, 51) };
  const look = { plain: '#ffffff', pale: '#000000' };
  const colourOf = (colours, vertex) => [...colours.subarray(3 * vertex, 3 * vertex + 3)];
  const near = (actual, expected) => actual.forEach((value, at) => assert.ok(Math.abs(value - expected[at]) < 1e-6));

  it('are left to the material in the plain colouring', () => {
    assert.equal(vertexColours(part, { ...look, colouring: 'plain' }), null);
  });

  it('are those of the bodies', () => {
    const colours = vertexColours(part, { ...look, colouring: 'bodies' });
    for (const [vertex, body] of part.body.entries()) near(colourOf(colours, vertex), linearOf(bodyColour(body)));
  });

  it('fade from plain to pale with the reliability', () => {
    const colours = vertexColours(part, { ...look, colouring: 'reliability' });
    for (const [vertex, value] of part.reliability.entries()) near(colourOf(colours, vertex), new Array(3).fill(1 - filledShare(value)));
    assert.deepEqual([...palenessOf(part, 'reliability')], [0, 255, Math.round(255 * filledShare(51))]);
  });

  it('show all that was filled in, the least reliable most', () => {
    assert.deepEqual([filledShare(255), filledShare(0)], [0, 1]);
    assert.ok(filledShare(254) >= 0.5);
    for (let value = 1; value < 256; ++value) assert.ok(filledShare(value) < filledShare(value - 1));
  });

  it('fade where traces do not agree along the reflectors', () => {
    const tied = { ...part, agreement: Uint8Array.of(255, 0, 102) };
    const colours = vertexColours(tied, { ...look, colouring: 'agreement' });
    for (const [vertex, value] of tied.agreement.entries()) near(colourOf(colours, vertex), new Array(3).fill(1 - doubtfulShare(value)));
    assert.deepEqual([...palenessOf(tied, 'agreement')], [0, 255, 153]);
    assert.deepEqual(colouringsOf([tied]), ['plain', 'bodies', 'depth', 'reliability', 'agreement']);
  });

  it('go down the ramp from the top of the surface to its bottom', () => {
    const tall = { positions: Float32Array.of(0, 30, 0, 0, 10, 0, 0, -10, 0) };
    const { top, bottom } = heightsOf([tall, { positions: new Float32Array(0) }]);
    assert.deepEqual([top, bottom, heightsOf([])], [30, -10, null]);
    const colours = vertexColours(tall, { ...look, colouring: 'depth', top, bottom });
    near(colourOf(colours, 0), linearOf(RAMP[0]));
    near(colourOf(colours, 2), linearOf(RAMP.at(-1)));
    const red = [0, 1, 2].map((vertex) => colourOf(colours, vertex)[0]);
    assert.ok(red[0] > red[1] && red[1] > red[2], red.join());
    const flat = vertexColours(tall, { ...look, colouring: 'depth', top: 10, bottom: 10 });
    near(colourOf(flat, 0), linearOf(RAMP[0]));
  });

  it('of the depth fall in lightness all the way, and stand out from both skies', () => {
    const lightness = RAMP.map(luminanceOf);
    for (let at = 1; at < RAMP.length; ++at) assert.ok(lightness[at] < lightness[at - 1], RAMP[at]);
    for (const sky of ['#e9ecec', '#101417'].map(luminanceOf)) {
      for (const colour of lightness) assert.ok((Math.max(sky, colour) + 0.05) / (Math.min(sky, colour) + 0.05) > 1.2);
    }
  });

  it('are plain in a part where everything was measured', () => {
    const measured = { ...part, reliability: null };
    near([...vertexColours(measured, { ...look, colouring: 'reliability' })], new Array(9).fill(1));
    assert.equal(palenessOf(measured, 'reliability'), null);
    assert.equal(palenessOf(part, 'bodies'), null);
  });

  it('are offered where the parts have what they need', () => {
    const bare = { ...part, body: null, reliability: null };
    assert.deepEqual(colouringsOf([bare, part]), ['plain', 'bodies', 'depth', 'reliability']);
    assert.deepEqual(colouringsOf([{ ...part, reliability: null }]), ['plain', 'bodies', 'depth']);
    assert.deepEqual(colouringsOf([]), ['plain']);
    assert.equal(colouringFor('reliability', ['plain', 'bodies']), 'plain');
  });

  it('are the swatches of the table', () => {
    assert.equal(swatchColour('bodies', 4, '#111111'), bodyColour(4));
    assert.equal(swatchColour('reliability', 4, '#111111'), '#111111');
  });
});

describe('table of bodies', () => {
  const many = Array.from({ length: 1300 }, (_, body) => entry(body));

  it('has the largest bodies and counts the others', () => {
    const { rows, smaller } = bodiesTable(many, null);
    assert.deepEqual(rows.map(({ body }) => body), [...Array(50).keys()]);
    assert.equal(describeSmaller(smaller), 'and 1\u202f250 smaller ones');
    assert.equal(describeSmaller(1), 'and 1 smaller one');
    assert.equal(describeSmaller(0), '');
  });

  it('has the selected body wherever it stands', () => {
    const { rows, smaller } = bodiesTable(many, 900);
    assert.deepEqual(rows.filter(({ isSelected }) => isSelected).map(({ body }) => body), [900]);
    assert.equal(rows.length + smaller, many.length);
    assert.equal(bodiesTable(many, 3).rows.length, 50);
  });

  it('says what is not known', () => {
    const { unit, rows } = bodiesTable([entry(0, { amplitude: null, genus: null }), entry(1, { volume_voxels: 0.25, genus: 2, interpolated_share: 0.125 })], null);
    assert.equal(unit, 'voxels');
    assert.deepEqual(rows[0].cells, ['1\u202f100', '–', '–', '0 %']);
    assert.deepEqual(rows[1].cells, ['0.25', '0.568', '2', '13 %']);
  });

  it('has lengths where all bodies and the survey have them', () => {
    const measured = [entry(0, { volume: 21585113 }), entry(1, { volume: 7 })];
    const { unit, rows } = bodiesTable(measured, null, 'm');
    assert.deepEqual([unit, ...rows.map(({ cells }) => cells[0])], ['m³', '21\u202f600\u202f000', '7']);
    assert.equal(bodiesTable(measured, null, '').unit, 'voxels');
    assert.equal(bodiesTable([...measured, entry(2)], null, 'm').unit, 'voxels');
  });

  it('lets the selected body go when it is clicked again', () => {
    assert.equal(toggled(null, 0), 0);
    assert.equal(toggled(0, 3), 3);
    assert.equal(toggled(3, 3), null);
  });

  it('tells in a line what it has no room for', () => {
    assert.equal(describeBody(entry(2)), 'Body 2: 1\u202f234 samples, amplitude 0.5 to 0.75');
    const full = entry(0, { voxels: 1, volume: 2.5e9, genus: 1, cavities: 2, interpolated_share: 0.5 });
    assert.equal(describeBody(full, 'm'), 'Body 0: 1 sample, 2.5 km³, amplitude 0.5 to 0.75, 1 tunnel, 2 cavities, 50 % filled in');
  });
});

describe('numbers of bodies', () => {
  it('are written for people', () => {
    assert.equal(formatAmplitude(-0.012345), '−0.0123');
    assert.equal(formatAmplitude(0), '0');
    assert.equal(formatVolume(1234.5, 'm'), '1\u202f230 m³');
    assert.equal(formatVolume(8), '8');
  });
});

describe('bodies in the extraction state', () => {
  const done = manifestCame(started(), { levels: [{ level: 0, components: 1, genus: 0, manifold: true }], empty: false });

  it('are counted after the last level', () => {
    assert.match(describeBodies(idle), /Nothing/);
    assert.match(describeBodies(started()), /when the last level/);
    assert.match(describeBodies(done), /Counting/);
    assert.match(describeBodies(bodiesCame(done, [entry(0), entry(1)])), /^2 bodies/);
    assert.equal(describeBodies(bodiesCame(done, [entry(0)])), 'One body.');
    assert.match(describeBodies(bodiesCame(done, [entry(0, { components: 3 }), entry(1)])), /^2 bodies, and cavities inside: 4 surfaces\./);
  });

  it('are what the sentence counts, surfaces until they are here', () => {
    const many = manifestCame(started(), { levels: [{ level: 0, components: 1331, genus: 1234, manifold: true }], empty: false });
    assert.equal(sentenceOf(many), 'Done: 1\u202f331 surfaces, 1\u202f234 tunnels.');
    assert.equal(sentenceOf(bodiesCame(many, [entry(0)])), 'Done: 1 body, 1\u202f234 tunnels.');
  });

  it('may fail without the surface', () => {
    const state = bodiesFailed(done, 'no such page');
    assert.equal(state.phase, 'done');
    assert.match(describeBodies(state), /no such page/);
  });

  it('are what was asked to be large', () => {
    const nothing = { levels: [], empty: true, request: { bodies: { min_voxels: 5 } } };
    assert.match(sentenceOf(manifestCame(started(), nothing)), /that large/);
  });

  it('come after filling, which has a name', () => {
    assert.equal(sentenceOf(progressed(started(), { stage: 'fill', progress: 0.1 })), 'Filling missing samples …');
  });
});

describe('one body of a mesh', () => {
  const triangles = Uint32Array.of(0, 1, 2, 3, 4, 5, 2, 1, 0);
  const body = Uint32Array.of(7, 7, 7, 8, 8, 8);
  const positions = Float32Array.from({ length: 18 }, (_, at) => at);

  it('lies behind the others, each triangle as it was', () => {
    const { triangles: ordered, others } = bodyLast(triangles, body, 7);
    assert.deepEqual([...ordered.subarray(0, others)], [3, 4, 5]);
    assert.deepEqual([...ordered.subarray(others)].sort(), [0, 0, 1, 1, 2, 2]);
    assert.equal(bodyLast(triangles, body, 9).others, triangles.length);
  });

  it('has a box, which is never too small to be seen', () => {
    const bounds = boundsOfBody([{ positions, body }, { positions: new Float32Array(3), body: null }], 8);
    assert.deepEqual(bounds, { low: [9, 10, 11], high: [15, 16, 17] });
    assert.deepEqual(enlarged(bounds, 10), { low: [7, 8, 9], high: [17, 18, 19] });
    assert.deepEqual(enlarged(bounds, 1), bounds);
    assert.equal(boundsOfBody([{ positions, body }], 1), null);
    assert.equal(longestSide({ low: [0, 0, 0], high: [1, 5, 2] }), 5);
  });
});
