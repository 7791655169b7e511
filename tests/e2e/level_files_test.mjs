// What readers that are not ours make of the codec's files: node level_files_test.mjs, with the program that writes them
// in the environment variable WRITE_LEVEL_FILES.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe, it } from 'node:test';

import { BufferAttribute, BufferGeometry, Vector3 } from '../../viewer/node_modules/three/build/three.module.js';
import { GLTFLoader } from '../../viewer/node_modules/three/examples/jsm/loaders/GLTFLoader.js';

const require = createRequire(new URL('../../viewer/package.json', import.meta.url));
const { createDecoderModule } = require('draco3d');
const validator = require('gltf-validator');
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

describe('glTF readers', () => {
  for (const name of ['turned', 'sheared']) {
    it(`find no fault with a ${name} survey`, async () => {
      const { issues, info } = await validator.validateBytes(readFileSync(join(folder, `${name}.glb`)));
      const faults = issues.messages.filter(({ severity }) => severity < 2);
      assert.deepEqual(faults, []);
      assert.equal(info.drawCallCount, 1);
    });

    it(`place a ${name} survey where its extras say, and see it from outside`, async () => {
      const { scene } = await loader().parseAsync(arrayBufferOf(join(folder, `${name}.glb`)), '');
      scene.updateMatrixWorld(true);
      const mesh = scene.getObjectByProperty('isMesh', true);
      const { origin, transform } = scene.children[0].userData;
      const { position } = mesh.geometry.attributes;
      const corners = [];
      for (let v = 0; v < position.count; ++v) {
        const [i, j, k] = [position.getX(v), position.getY(v), position.getZ(v)];
        const [x, y, z] = [0, 4, 8].map((row) => transform[row] * i + transform[row + 1] * j + transform[row + 2] * k);
        const shown = new Vector3(i, j, k).applyMatrix4(mesh.matrixWorld);
        assert.ok(shown.distanceTo(new Vector3(x, -z, -y)) < 1e-9 * 6e3);
        corners.push(shown);
      }
      assert.deepEqual(origin, [transform[3], transform[7], transform[11]]);
      assert.ok(signedVolume(corners, mesh.geometry.index.array) * Math.sign(mesh.matrixWorld.determinant()) > 0);
    });
  }

  it('find what vertices carry', async () => {
    const { scene } = await loader().parseAsync(arrayBufferOf(join(folder, 'sheared.glb')), '');
    const mesh = scene.getObjectByProperty('isMesh', true);
    const { position, normal, _reliability, _body, _value } = mesh.geometry.attributes;
    const missing = mesh.userData.missing_value ?? mesh.geometry.userData.missing_value;
    for (let v = 0; v < position.count; ++v) {
      assert.equal(_reliability.getX(v), ((64 * position.getX(v)) % 256) / 255);
      assert.equal(_body.getX(v), 64 * position.getY(v));
      assert.equal(_value.getX(v), position.getZ(v) < 32 ? missing : Math.fround(-position.getZ(v) / 3));
      const outwards = new Vector3().fromBufferAttribute(position, v).sub(new Vector3(32, 32, 32)).normalize();
      assert.ok(outwards.distanceTo(new Vector3().fromBufferAttribute(normal, v)) < 0.0044);
    }
  });
});

function arrayBufferOf(path) {
  const bytes = readFileSync(path);
  return bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength);
}

/** three's loader; its DRACOLoader decodes in a worker of browsers, which node lacks, so this does the same here. */
function loader() {
  const decodeDracoFile = (buffer, onLoad, ids, types) => onLoad(geometryOf(new Uint8Array(buffer), ids, types));
  const preload = () => {};
  return new GLTFLoader().setDRACOLoader({ preload, decodeDracoFile });
}

/** ids and types by the geometry's names of attributes, as GLTFLoader hands them to DRACOLoader. */
function geometryOf(bytes, ids, types) {
  const decoder = new draco.Decoder();
  const buffer = new draco.DecoderBuffer();
  buffer.Init(bytes, bytes.length);
  const mesh = new draco.Mesh();
  assert.ok(decoder.DecodeBufferToMesh(buffer, mesh).ok());
  const geometry = new BufferGeometry();
  const kinds = {
    Float32Array: [draco.DT_FLOAT32, Float32Array],
    Uint16Array: [draco.DT_UINT16, Uint16Array],
    Uint8Array: [draco.DT_UINT8, Uint8Array],
  };
  for (const [name, id] of Object.entries(ids)) {
    const [type, Numbers] = kinds[types[name]];
    const attribute = decoder.GetAttributeByUniqueId(mesh, id);
    assert.equal(attribute.data_type(), type, name);
    const size = mesh.num_points() * attribute.num_components() * Numbers.BYTES_PER_ELEMENT;
    const pointer = draco._malloc(size);
    assert.ok(decoder.GetAttributeDataArrayForAllPoints(mesh, attribute, type, size, pointer));
    const numbers = new Numbers(draco.HEAPU8.buffer.slice(pointer, pointer + size));
    geometry.setAttribute(name, new BufferAttribute(numbers, attribute.num_components()));
  }
  const size = 12 * mesh.num_faces();
  const pointer = draco._malloc(size);
  decoder.GetTrianglesUInt32Array(mesh, size, pointer);
  return geometry.setIndex(new BufferAttribute(new Uint32Array(draco.HEAPU8.buffer.slice(pointer, pointer + size)), 1));
}

function signedVolume(corners, triangles) {
  let sum = 0;
  for (let t = 0; t < triangles.length; t += 3) {
    const [a, b, c] = [0, 1, 2].map((corner) => corners[triangles[t + corner]]);
    sum += a.dot(b.clone().cross(c)) / 6;
  }
  return sum;
}
