/**
 * One Draco part to flat arrays. `draco` is a ready decoder module.
 *
 * returns  {positions: Float32Array (n, 3), triangles: Uint32Array (m, 3), body: Uint32Array (n) | null: its number, 0 =
 *          the largest, reliability: Uint8Array (n) | null: 255 = measured, agreement: Uint8Array (n) | null: 255 = wholly; null where the
 *          part has none}
 * throws   Error when the bytes are not a Draco triangle mesh.
 */
export function decodePart(draco, bytes) {
  const decoder = new draco.Decoder();
  const buffer = new draco.DecoderBuffer();
  const mesh = new draco.Mesh();
  try {
    buffer.Init(bytes, bytes.length);
    if (decoder.GetEncodedGeometryType(buffer) !== draco.TRIANGULAR_MESH) throw new Error('not a Draco triangle mesh');
    const status = decoder.DecodeBufferToMesh(buffer, mesh);
    if (!status.ok()) throw new Error(status.error_msg());
    return {
      positions: readPositions(draco, decoder, mesh),
      triangles: readTriangles(draco, decoder, mesh),
      body: readNamed(draco, decoder, mesh, 'body', Uint32Array, draco.DT_UINT32),
      reliability: readNamed(draco, decoder, mesh, 'reliability', Uint8Array, draco.DT_UINT8),
      agreement: readNamed(draco, decoder, mesh, 'agreement', Uint8Array, draco.DT_UINT8),
    };
  } finally {
    for (const owned of [mesh, buffer, decoder]) draco.destroy(owned);
  }
}

/** Lets `read` fill `count` numbers in the decoder's heap and copies them out. */
function copyFromHeap(draco, count, Numbers, read) {
  const bytes = Numbers.BYTES_PER_ELEMENT * count;
  const pointer = draco._malloc(bytes);
  try {
    read(bytes, pointer);
    return new Numbers(draco.HEAPU8.buffer, pointer, count).slice();
  } finally {
    draco._free(pointer);
  }
}

function readPositions(draco, decoder, mesh) {
  const attribute = decoder.GetAttribute(mesh, decoder.GetAttributeId(mesh, draco.POSITION));
  return copyFromHeap(draco, 3 * mesh.num_points(), Float32Array, (bytes, pointer) =>
    decoder.GetAttributeDataArrayForAllPoints(mesh, attribute, draco.DT_FLOAT32, bytes, pointer),
  );
}

function readTriangles(draco, decoder, mesh) {
  return copyFromHeap(draco, 3 * mesh.num_faces(), Uint32Array, (bytes, pointer) =>
    decoder.GetTrianglesUInt32Array(mesh, bytes, pointer),
  );
}

/** The attribute whose metadata gives it this name, one number a point; null when there is none or it is something else. */
function readNamed(draco, decoder, mesh, name, Numbers, type) {
  const id = decoder.GetAttributeIdByMetadataEntry(mesh, 'name', name);
  if (id < 0) return null;
  const attribute = decoder.GetAttribute(mesh, id);
  if (attribute.num_components() !== 1 || attribute.data_type() !== type) return null;
  return copyFromHeap(draco, mesh.num_points(), Numbers, (bytes, pointer) =>
    decoder.GetAttributeDataArrayForAllPoints(mesh, attribute, type, bytes, pointer),
  );
}
