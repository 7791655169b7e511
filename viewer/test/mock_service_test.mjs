// The calls of the page and the decoder against the mock service: needs the built binary (environment variable GEOSIS).
import assert from 'node:assert/strict';
import { createRequire } from 'node:module';
import { after, before, describe, it } from 'node:test';

import { GeosisApi } from '../core/api.js';
import { Problem } from '../core/problem.js';
import { requestOf } from '../core/request.js';
import { decodePart } from '../decode/draco.js';
import { encodePart } from './draco_encoder.mjs';
import { startMock, synthesize } from './mock_server.mjs';

const GEOSIS = process.env.GEOSIS;
const createDraco = createRequire(import.meta.url)('draco3d').createDecoderModule;

describe('GeosisApi', { skip: GEOSIS ? false : 'GEOSIS is not set' }, () => {
  let service;
  let volume;
  let api;

  before(async () => {
    service = await startMock({ geosis: GEOSIS });
    const dims = ['--dims', '48,56,64'];
    volume = await service.mock.addVolume('small.sgy', await synthesize(GEOSIS, ...dims), await synthesize(GEOSIS, ...dims, '--missing', 'none'));
    api = new GeosisApi(service.url);
  });
  after(() => service.close());

  it('lists volumes and counts their samples', async () => {
    assert.deepEqual((await api.volumes()).map(({ id }) => id), [volume.id]);
    const { edges, counts, missing } = await api.histogram(volume.id, 16);
    assert.equal(edges.length, 17);
    assert.equal(counts.reduce((sum, count) => sum + count, missing), 48 * 56 * 64);
  });

  it('streams parts coarsest first that decode to the triangles of the manifest', async () => {
    const { id } = await api.createExtraction(volume.id, { range: [0.55, null] });
    const draco = await createDraco();
    const counted = new Map();
    let manifest;
    for await (const item of api.stream(id)) {
      if (item.kind === 'manifest') manifest = item.manifest;
      else counted.set(item.level, (counted.get(item.level) ?? 0) + decodePart(draco, item.bytes).triangles.length / 3);
    }
    assert.deepEqual([...counted.keys()], [4, 3, 2, 1, 0]);
    for (const { level, triangles } of manifest.levels) assert.equal(counted.get(level), triangles);
  });

  /** The decoded parts of a request, [{level, body, reliability, ...}]. */
  async function partsOf(range, choices) {
    const { id } = await api.createExtraction(volume.id, requestOf(range, choices));
    const draco = await createDraco();
    const parts = [];
    for await (const item of api.stream(id)) {
      if (item.kind === 'part') parts.push({ level: item.level, ...decodePart(draco, item.bytes) });
    }
    return { id, parts };
  }

  it('decodes which body each vertex is of, the same ones at every level', async () => {
    const { id, parts } = await partsOf({ low: 0.42, high: null });
    const bodies = await api.bodies(id);
    assert.ok(bodies.length > 2);
    assert.deepEqual(bodies.map(({ body }) => body), [...bodies.keys()]);
    for (const { level, body, positions, reliability } of parts) {
      assert.equal(body.length, positions.length / 3);
      assert.equal(reliability, null, `level ${level}: nothing was filled in`);
    }
    assert.deepEqual(new Set(parts.find(({ level }) => level === 0).body), new Set(bodies.keys()));
  });

  it('decodes the reliability of what was filled in', async () => {
    const { parts } = await partsOf({ low: 0.42, high: null }, { fill: 'linear', minVoxels: 0 });
    const { reliability } = parts.at(-1);
    assert.ok(reliability.includes(255));
    assert.ok(reliability.some((value) => value < 128));
  });

  it('leaves out bodies that are too small', async () => {
    const { id } = await partsOf({ low: 0.42, high: null }, { fill: 'none', minVoxels: 100 });
    assert.ok((await api.bodies(id)).every(({ volume_voxels: volume }) => volume >= 100));
  });

  it('decodes parts without attributes', async () => {
    const bare = decodePart(await createDraco(), encodePart({ positions: new Float32Array([0, 0, 0, 1, 0, 0, 0, 1, 0]), triangles: new Uint32Array([0, 1, 2]) }));
    assert.deepEqual([bare.triangles.length, bare.body, bare.reliability], [3, null, null]);
  });

  it('throws the problem of a refused call', async () => {
    await assert.rejects(api.volume('ffff'), (error) => error instanceof Problem && error.code === 'not_found');
  });

  it('refuses bytes that are no mesh', async () => {
    const draco = await createDraco();
    assert.throws(() => decodePart(draco, new Uint8Array([1, 2, 3])));
  });
});
