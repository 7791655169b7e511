// Decodes parts off the page's thread, in the order in which they come.
// in   {ticket, bytes: Uint8Array, display: 12 numbers}
// out  {ticket, positions, triangles, normals, body, reliability, agreement} in display coordinates, or {ticket, error}
import createDraco from 'draco3d/draco_decoder_nodejs.js';

import { reversedTriangles, transformPositions, vertexNormals } from '../core/mesh.js';
import { decodePart } from './draco.js';

// The module is itself thenable: resolving a promise with it would never end.
const ready = new Promise((resolve, reject) => {
  createDraco({
    locateFile: () => new URL('draco_decoder.wasm', self.location.href).href,
    onModuleLoaded: (draco) => resolve({ draco }),
    onAbort: reject,
  });
});

function prepare(draco, { bytes, display }) {
  const decoded = decodePart(draco, bytes);
  const positions = transformPositions(decoded.positions, display);
  // The way to the display is a mirror: seen there, the triangles turn the other way round.
  const triangles = reversedTriangles(decoded.triangles);
  return { ...decoded, positions, triangles, normals: vertexNormals(positions, triangles) };
}

self.onmessage = async ({ data }) => {
  try {
    const { draco } = await ready;
    const mesh = prepare(draco, data);
    const arrays = Object.values(mesh).filter((array) => array !== null);
    self.postMessage({ ticket: data.ticket, ...mesh }, arrays.map(({ buffer }) => buffer));
  } catch (error) {
    self.postMessage({ ticket: data.ticket, error: String(error?.message ?? error) });
  }
};
