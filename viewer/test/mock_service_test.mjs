// The calls of the page and the decoder against the mock service: needs the built binary (environment variable GEOSIS).
import assert from 'node:assert/strict';
import { createRequire } from 'node:module';
import { after, before, describe, it } from 'node:test';

import { GeosisApi } from '../core/api.js';
import { Problem } from '../core/problem.js';
import { decodePart } from '../decode/draco.js';
import { startMock, synthesize } from './mock_server.mjs';

const GEOSIS = process.env.GEOSIS;
const createDraco = createRequire(import.meta.url)('draco3d').createDecoderModule;

describe('GeosisApi', { skip: GEOSIS ? false : 'GEOSIS is not set' }, () => {
  let service;
  let volume;
  let api;

  before(async () => {
    service = await startMock({ geosis: GEOSIS });
    volume = await service.mock.addVolume('small.sgy', await synthesize(GEOSIS, '--dims', '48,56,64'));
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

  it('throws the problem of a refused call', async () => {
    await assert.rejects(api.volume('ffff'), (error) => error instanceof Problem && error.code === 'not_found');
  });

  it('refuses bytes that are no mesh', async () => {
    const draco = await createDraco();
    assert.throws(() => decodePart(draco, new Uint8Array([1, 2, 3])));
  });
});
