/**
 * A server with the service's HTTP calls that the page uses, for working on the page without the service. It lets the
 * command line do the work, and keeps a moment between the levels so that they can be seen arriving.
 *
 *     GEOSIS=../build/release/geosis node test/mock_server.mjs [FILE.sgy ...]
 */
import { execFile } from 'node:child_process';
import { createHash } from 'node:crypto';
import { createServer } from 'node:http';
import { mkdtemp, readFile, rm, writeFile } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { basename, extname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { promisify } from 'node:util';

import { decodePart } from '../decode/draco.js';
import { dracoDecoder, encodePart } from './draco_encoder.mjs';
import { documentOf, findBodies, keepBodies } from './mock_bodies.mjs';
import { reliabilityOf, tracesOf } from './mock_fill.mjs';

const run = promisify(execFile);
const pause = (ms) => new Promise((resolve) => setTimeout(resolve, ms));
const DIST = fileURLToPath(new URL('../dist/', import.meta.url));
const TYPES = { '.html': 'text/html; charset=utf-8', '.js': 'text/javascript', '.css': 'text/css', '.wasm': 'application/wasm' };
const BOUNDARY = 'geosis-mock-boundary';

class Refusal extends Error {
  constructor(status, code, message) {
    super(message);
    this.document = { type: 'about:blank', title: code.replace('_', ' '), status, detail: message, code };
  }
}

/** Volumes and extractions in a folder of its own. */
class Mock {
  volumes = new Map();
  extractions = new Map();

  refusesBodies = false;
  /** What every call has to bring; '' = nothing. */
  key = '';

  constructor(geosis, folder, levelDelayMs) {
    Object.assign(this, { geosis, folder, levelDelayMs });
  }

  /** whole   the same survey without holes, which filling then gives. */
  async addVolume(name, bytes, whole = bytes) {
    const path = join(this.folder, `${this.volumes.size}.sgy`);
    await writeFile(path, bytes);
    await writeFile(`${path}.whole`, whole);
    const document = JSON.parse(await this.#geosis('info', path));
    this.volumes.set(document.id, { path, document: { ...document, name, state: 'ready' } });
    return this.volumes.get(document.id).document;
  }

  async extract(volumeId, request) {
    const volume = this.#find(this.volumes, volumeId);
    const id = createHash('sha256').update(JSON.stringify([volumeId, request])).digest('hex');
    if (!this.extractions.has(id)) this.extractions.set(id, await this.#compute(volume, id, request));
    return { id, volume: volumeId, state: 'done', request };
  }

  async #compute(volume, id, request) {
    const isFilled = (request.missing?.method ?? 'none') !== 'none';
    const input = isFilled ? `${volume.path}.whole` : volume.path;
    const ends = request.range.map((end, side) => String(end ?? ['-inf', 'inf'][side]));
    const out = join(this.folder, id);
    await this.#geosis('reconstruct', input, '--format', 'segy', '--range', ...ends, '--out', out);
    const manifest = JSON.parse(await readFile(join(out, 'manifest.json'), 'utf8'));
    return withBodies(out, { ...manifest, id, request }, isFilled ? await tracesOf(volume) : null);
  }

  volume(id) {
    return this.#find(this.volumes, id);
  }

  extraction(id) {
    return this.#find(this.extractions, id);
  }

  #find(all, id) {
    if (!all.has(id)) throw new Refusal(404, 'not_found', `there is nothing with the id ${id}`);
    return all.get(id);
  }

  async #geosis(...args) {
    try {
      return (await run(this.geosis, args)).stdout;
    } catch (error) {
      const [, code, message] = /^geosis: (\w+): (.*)$/m.exec(error.stderr) ?? [null, 'internal', String(error.stderr)];
      throw new Refusal(422, code, message);
    }
  }
}

/** Gives the levels their attributes, leaves out what is too small, and lists the bodies. */
async function withBodies(out, manifest, isThere) {
  const levels = await Promise.all(manifest.levels.map(async (entry) => ({
    ...entry, parts: await Promise.all(entry.parts.map(async ({ url }) => decodePart(dracoDecoder, await readFile(join(out, url))))),
  })));
  if (levels.length === 0) return { manifest, parts: new Map(), bodies: [] };
  if (isThere) for (const part of levels.flatMap(({ parts }) => parts)) part.reliability = reliabilityOf(part, isThere);
  const least = manifest.request.bodies?.min_voxels ?? 0;
  const kept = findBodies(levels).filter(({ volume }) => volume >= least);
  const isKept = (body) => body < kept.length;
  const parts = new Map(levels.map((level) => [level.level, level.parts.map((part) => keepBodies(part, isKept))]));
  const left = manifest.levels.map((entry) => ({
    ...entry, components: kept.length, triangles: parts.get(entry.level).reduce((sum, { triangles }) => sum + triangles.length / 3, 0),
  }));
  const empty = kept.length === 0;
  return {
    manifest: { ...manifest, empty, levels: empty ? [] : left },
    parts,
    bodies: kept.map((body) => documentOf(body, manifest.request.range[0] ?? 0)),
  };
}

function encodeWithAttributes({ body, reliability, ...mesh }) {
  return encodePart(mesh, reliability ? { reliability, body } : { body });
}

/** Counts of the samples of a file that geosis synth wrote: big-endian float32 after trace headers of 240 bytes. */
async function histogramOf({ path, document }, bins) {
  const bytes = await readFile(path);
  const samples = document.dims[2];
  const [min, max] = document.value_range;
  const counts = new Array(bins).fill(0);
  for (let trace = 3600; trace < bytes.length; trace += 240 + 4 * samples) {
    for (let k = 0; k < samples; ++k) {
      const value = bytes.readFloatBE(trace + 240 + 4 * k);
      ++counts[Math.min(bins - 1, Math.floor(((value - min) / (max - min)) * bins))];
    }
  }
  const edges = Array.from({ length: bins + 1 }, (_, bin) => min + ((max - min) * bin) / bins);
  return { edges, counts, missing: document.missing.samples };
}

async function readBody(request) {
  const chunks = [];
  for await (const chunk of request) chunks.push(chunk);
  return Buffer.concat(chunks);
}

function sendJson(response, status, document) {
  const type = status >= 400 ? 'application/problem+json' : 'application/json';
  response.writeHead(status, { 'Content-Type': type }).end(JSON.stringify(document));
}

async function sendStream(mock, response, { manifest, parts }) {
  response.writeHead(200, { 'Content-Type': `multipart/mixed; boundary=${BOUNDARY}` });
  for (const level of [...manifest.levels].reverse()) {
    for (const [number, part] of parts.get(level.level).entries()) {
      const bytes = encodeWithAttributes(part);
      response.write(`--${BOUNDARY}\r\nContent-Type: model/vnd.google.draco\r\nX-Geosis-Level: ${level.level}\r\n` +
        `X-Geosis-Part: ${number}\r\nX-Geosis-Parts: ${level.parts.length}\r\nContent-Length: ${bytes.length}\r\n\r\n`);
      response.write(bytes);
      response.write('\r\n');
    }
    await pause(mock.levelDelayMs);
  }
  response.write(`--${BOUNDARY}\r\nContent-Type: application/json\r\n\r\n${JSON.stringify(manifest)}`);
  response.end(`\r\n--${BOUNDARY}--\r\n`);
}

async function sendEvents(mock, response, { manifest }) {
  response.writeHead(200, { 'Content-Type': 'text/event-stream' });
  const send = (event, data) => response.write(`event: ${event}\ndata: ${JSON.stringify(data)}\n\n`);
  const levels = [...manifest.levels].reverse();
  for (const [position, level] of levels.entries()) {
    send('progress', { stage: 'encode', progress: position / levels.length });
    send('level', { ...level, distance: null });
    await pause(mock.levelDelayMs);
  }
  send('done', { id: manifest.id, state: 'done' });
  response.end();
}

function sendBodies(mock, response, { bodies }) {
  if (mock.refusesBodies) throw new Refusal(503, 'unavailable', 'the bodies are being counted');
  sendJson(response, 200, { bodies });
}

async function sendPage(response, path) {
  const file = path === '/' ? 'index.html' : basename(path);
  const bytes = await readFile(DIST + file).catch(() => {
    throw new Refusal(404, 'not_found', path);
  });
  response.writeHead(200, { 'Content-Type': TYPES[extname(file)] ?? 'application/octet-stream' }).end(bytes);
}

const CALLS = [
  ['GET', /^\/v1\/volumes$/, async (mock, { response }) =>
    sendJson(response, 200, { volumes: [...mock.volumes.values()].map(({ document }) => document), next_page_token: null })],
  ['POST', /^\/v1\/volumes$/, async (mock, { response, request, query }) =>
    sendJson(response, 201, await mock.addVolume(query.get('name') ?? '', await readBody(request)))],
  ['GET', /^\/v1\/volumes\/(\w+)$/, async (mock, { response, id }) => sendJson(response, 200, mock.volume(id).document)],
  ['GET', /^\/v1\/volumes\/(\w+)\/histogram$/, async (mock, { response, id, query }) =>
    sendJson(response, 200, await histogramOf(mock.volume(id), Number(query.get('bins') ?? 256)))],
  ['GET', /^\/v1\/volumes\/(\w+)\/grids$/, async (mock, { response, id }) =>
    sendJson(response, 200, { grids: mock.volume(id) && [], next_page_token: null })],
  ['POST', /^\/v1\/volumes\/(\w+)\/extractions$/, async (mock, { response, request, id }) =>
    sendJson(response, 202, await mock.extract(id, JSON.parse(await readBody(request))))],
  ['GET', /^\/v1\/extractions\/(\w+)\/stream$/, async (mock, { response, id }) => sendStream(mock, response, mock.extraction(id))],
  ['GET', /^\/v1\/extractions\/(\w+)\/events$/, async (mock, { response, id }) => sendEvents(mock, response, mock.extraction(id))],
  ['GET', /^\/v1\/extractions\/(\w+)\/bodies$/, async (mock, { response, id }) => sendBodies(mock, response, mock.extraction(id))],
  ['DELETE', /^\/v1\/extractions\/(\w+)$/, async (mock, { response }) => response.writeHead(204).end()],
  ['GET', /^\/[\w.]*$/, async (mock, { response, path }) => sendPage(response, path)],
];

async function answer(mock, request, response) {
  const { pathname: path, searchParams: query } = new URL(request.url, 'http://localhost');
  try {
    const [, pattern, call] = CALLS.find(([method, form]) => method === request.method && form.test(path)) ?? [];
    if (!call) throw new Refusal(404, 'not_found', path);
    const isOpen = mock.key === '' || !path.startsWith('/v1/') || request.headers.authorization === `Bearer ${mock.key}`;
    if (!isOpen) throw new Refusal(401, 'unauthenticated', request.headers.authorization ? 'the key is not known here' : 'this needs a key');
    await call(mock, { request, response, path, query, id: pattern.exec(path)[1] });
  } catch (error) {
    if (!(error instanceof Refusal)) throw error;
    sendJson(response, error.document.status, error.document);
  }
}

/** returns  {url, mock, close()}; geosis is the path of the binary. */
export async function startMock({ geosis, port = 0, levelDelayMs = 0 }) {
  const folder = await mkdtemp(join(tmpdir(), 'geosis-mock-'));
  const mock = new Mock(geosis, folder, levelDelayMs);
  const server = createServer((request, response) => answer(mock, request, response));
  await new Promise((resolve) => server.listen(port, '127.0.0.1', resolve));
  const close = async () => {
    server.closeAllConnections();
    server.close();
    await rm(folder, { recursive: true });
  };
  return { url: `http://127.0.0.1:${server.address().port}`, mock, close };
}

/** A sample survey's bytes. */
export async function synthesize(geosis, ...options) {
  const folder = await mkdtemp(join(tmpdir(), 'geosis-mock-'));
  const path = join(folder, 'sample.sgy');
  await run(geosis, ['synth', path, ...options]);
  const bytes = await readFile(path);
  await rm(folder, { recursive: true });
  return bytes;
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const geosis = process.env.GEOSIS ?? 'geosis';
  const { url, mock } = await startMock({ geosis, port: Number(process.env.PORT ?? 0), levelDelayMs: 400 });
  const files = process.argv.slice(2);
  if (files.length === 0) {
    await mock.addVolume('sample.sgy', await synthesize(geosis), await synthesize(geosis, '--missing', 'none'));
  }
  for (const file of files) await mock.addVolume(basename(file), await readFile(file));
  console.log(`listening on ${url}`);
}
