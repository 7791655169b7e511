// What readers that are not ours make of the codec's files: node level_files_test.mjs, with the program that writes them
// in the environment variable WRITE_LEVEL_FILES.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe, it } from 'node:test';

const require = createRequire(new URL('../../viewer/package.json', import.meta.url));
const { createDecoderModule } = require('draco3d');
const folder = mkdtempSync(join(tmpdir(), 'geosis-levels-'));

let draco;

before(async () => {
  execFileSync(process.env.WRITE_LEVEL_FILES, [folder]);
  draco = await createDecoderModule();
});

after(() => rmSync(folder, { recursive: true }));

/** A part as {attribute of a name, or of a type -> its numbers}. */
function decode(bytes) {
  const decoder = new draco.Decoder();
  const buffer = new draco.DecoderBuffer();
  buffer.Init(bytes, bytes.length);
  const mesh = new draco.Mesh();
  assert.ok(decoder.DecodeBufferToMesh(buffer, mesh).ok());
  const numbers = (id, components, type, Numbers) => {
    assert.ok(id >= 0);
    const bytesWanted = mesh.num_points() * components * Numbers.BYTES_PER_ELEMENT;
    const pointer = draco._malloc(bytesWanted);
    assert.ok(decoder.GetAttributeDataArrayForAllPoints(mesh, decoder.GetAttribute(mesh, id), type, bytesWanted, pointer));
    return new Numbers(draco.HEAPU8.buffer.slice(pointer, pointer + bytesWanted));
  };
  const named = (name, type, Numbers) => numbers(decoder.GetAttributeIdByMetadataEntry(mesh, 'name', name), 1, type, Numbers);
  return {
    positions: numbers(decoder.GetAttributeId(mesh, draco.POSITION), 3, draco.DT_FLOAT32, Float32Array),
    seam: named('seam', draco.DT_UINT32, Uint32Array),
    reliability: named('reliability', draco.DT_UINT8, Uint8Array),
    body: named('body', draco.DT_UINT32, Uint32Array),
    value: named('value', draco.DT_FLOAT32, Float32Array),
  };
}

describe('the Draco decoder of browsers', () => {
  it('finds what vertices carry by its name', () => {
    for (const part of [0, 1]) {
      const { positions, seam, reliability, body, value } = decode(readFileSync(join(folder, `torus.${part}.drc`)));
      assert.ok(seam.length > 300 && seam.some((id) => id > 0));
      for (let v = 0; v < seam.length; ++v) {
        const [x, y, z] = positions.subarray(3 * v);
        assert.equal(reliability[v], (64 * x) % 256);
        assert.equal(body[v], 64 * y);
        assert.ok(Object.is(value[v], z < 32 ? NaN : Math.fround(-z / 3)));
      }
    }
  });
});
