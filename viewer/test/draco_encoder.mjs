import { createRequire } from 'node:module';

const { createDecoderModule, createEncoderModule } = createRequire(import.meta.url)('draco3d');
const LATTICE_STEP = 1 / 64;
const POSITION_BITS = 17;

export const dracoDecoder = await createDecoderModule();
const draco = await createEncoderModule();

/**
 * A part as the service encodes it: positions on the lattice, and per vertex what `attributes` names: Uint8Array or
 * Uint32Array, a GENERIC attribute each, with its name as metadata.
 */
export function encodePart({ positions, triangles }, attributes = {}) {
  const mesh = new draco.Mesh();
  const builder = new draco.MeshBuilder();
  const points = positions.length / 3;
  builder.AddFloatAttributeToMesh(mesh, draco.POSITION, points, 3, positions);
  builder.AddFacesToMesh(mesh, triangles.length / 3, triangles);
  for (const [name, values] of Object.entries(attributes)) {
    const add = values instanceof Uint8Array ? 'AddUInt8Attribute' : 'AddUInt32Attribute';
    nameAttribute(builder, mesh, builder[add](mesh, draco.GENERIC, points, 1, values), name);
  }
  return encode(mesh);
}

function nameAttribute(builder, mesh, id, name) {
  const entries = new draco.MetadataBuilder();
  const metadata = new draco.Metadata();
  entries.AddStringEntry(metadata, 'name', name);
  builder.SetMetadataForAttribute(mesh, id, metadata);
}

function encode(mesh) {
  const encoder = new draco.Encoder();
  encoder.SetAttributeExplicitQuantization(draco.POSITION, POSITION_BITS, 3, [0, 0, 0], (2 ** POSITION_BITS - 1) * LATTICE_STEP);
  const output = new draco.DracoInt8Array();
  const length = encoder.EncodeMeshToDracoBuffer(mesh, output);
  const bytes = Uint8Array.from({ length }, (_, at) => output.GetValue(at));
  for (const owned of [output, encoder, mesh]) draco.destroy(owned);
  return bytes;
}
