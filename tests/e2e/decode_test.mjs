// What the browser's Draco decoder makes of a running server's files (GEOSIS_URL): every part and every whole level decodes
// to the manifest's counts. The sample survey, cut into one part a level; and petrel_buildup_3d, whose finest level has
// several, where the shared data (GEOSIS_SHARED) is present.
import assert from 'node:assert/strict';
import { createHash } from 'node:crypto';
import { existsSync, readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { join } from 'node:path';
import { before, describe, it } from 'node:test';
import { fileURLToPath } from 'node:url';

import { decodePart } from '../../viewer/decode/draco.js';

const { createDecoderModule } = createRequire(new URL('../../viewer/package.json', import.meta.url))('draco3d');
const { GEOSIS_URL, GEOSIS_SHARED = fileURLToPath(new URL('../../../shared', import.meta.url)) } = process.env;
const PETREL = join(GEOSIS_SHARED, 'data/seismic/petrel_buildup_3d.sgy');

let draco;

async function answerOf(path, options) {
  const answer = await fetch(GEOSIS_URL + path, options);
  assert.ok(answer.ok, `${path}: ${answer.status}`);
  return answer;
}

const bytesOf = async (path) => new Uint8Array(await (await answerOf(path)).arrayBuffer());
const sha256 = (bytes) => createHash('sha256').update(bytes).digest('hex');

async function reconstruct(volume, range) {
  const headers = { 'Content-Type': 'application/json', Prefer: 'wait=60' };
  const posted = await answerOf(`/v1/volumes/${volume}/extractions`, { method: 'POST', headers, body: JSON.stringify({ range }) });
  const resource = await posted.json();
  assert.equal(resource.state, 'done');
  return resource;
}

/** Decodes all files of an extraction; the number of parts of its finest level. */
async function checkEveryFile(volume, range) {
  const { levels } = await reconstruct(volume, range);
  assert.equal(levels.length, 5);
  for (const level of levels) {
    let triangles = 0;
    for (const part of level.parts) {
      const bytes = await bytesOf(part.url);
      assert.equal(bytes.length, part.bytes);
      assert.equal(sha256(bytes), part.sha256);
      const decoded = decodePart(draco, bytes);
      assert.equal(decoded.triangles.length / 3, part.triangles);
      triangles += part.triangles;
    }
    assert.equal(triangles, level.triangles);
    const whole = decodePart(draco, await bytesOf(level.url));
    assert.equal(whole.triangles.length / 3, level.triangles);
    assert.equal(whole.positions.length / 3, level.vertices);
  }
  return levels.find((level) => level.level === 0).parts.length;
}

describe('the decoder of browsers', () => {
  before(async () => {
    draco = await createDecoderModule();
  });

  it('reads every file of the sample survey', async () => {
    const { volumes } = await (await answerOf('/v1/volumes')).json();
    assert.equal(await checkEveryFile(volumes[0].id, [0.55, null]), 1);
  });

  it('reads every file of a survey whose finest level has several parts', { skip: !existsSync(PETREL) }, async () => {
    const uploaded = await answerOf('/v1/volumes?name=petrel', { method: 'POST', body: readFileSync(PETREL) });
    assert.ok((await checkEveryFile((await uploaded.json()).id, [0.5, null])) > 1);
  });
});
