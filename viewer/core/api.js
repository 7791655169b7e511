import { EventReader } from './event_stream.js';
import { MultipartReader, multipartBoundary } from './multipart.js';
import { Problem, problemFromText } from './problem.js';

/** The calls of the service that the page makes. Failures are thrown as Problem; aborts as AbortError. */
export class GeosisApi {
  #base;
  #fetch;
  /** What is sent with every call, for servers that ask for a key; '' = none. */
  key = '';

  /** base   where the service is, without a slash at the end: '' for the page's own server. */
  constructor(base = '', fetchFunction = globalThis.fetch.bind(globalThis)) {
    this.#base = base;
    this.#fetch = fetchFunction;
  }

  /** Every volume, page by page. */
  async volumes(signal) {
    const all = [];
    let token = '';
    do {
      const page = await this.#json(`/v1/volumes?page_size=100${token && `&page_token=${encodeURIComponent(token)}`}`, { signal });
      all.push(...page.volumes);
      token = page.next_page_token ?? '';
    } while (token);
    return all;
  }

  volume(id, signal) {
    return this.#json(`/v1/volumes/${encodeURIComponent(id)}`, { signal });
  }

  /** The grids that somebody has placed for a volume. */
  async grids(id, signal) {
    const { grids } = await this.#json(`/v1/volumes/${encodeURIComponent(id)}/grids?page_size=100`, { signal });
    return grids;
  }

  histogram(id, bins, signal) {
    return this.#json(`/v1/volumes/${encodeURIComponent(id)}/histogram?bins=${bins}`, { signal });
  }

  /** Asks for an extraction; the answer is its resource, which may be done already. */
  createExtraction(volume, request, signal) {
    return this.#json(`/v1/volumes/${encodeURIComponent(volume)}/extractions`, {
      method: 'POST',
      headers: { 'Content-Type': 'application/json' },
      body: JSON.stringify(request),
      signal,
    });
  }

  /** The bodies of a finished extraction, largest first. */
  async bodies(extraction, signal) {
    const { bodies } = await this.#json(`/v1/extractions/${encodeURIComponent(extraction)}/bodies`, { signal });
    if (!Array.isArray(bodies)) throw new Problem({ detail: 'The server answered with something else.' });
    return bodies;
  }

  /** Tells that nobody waits for it here any more. Never fails: it is a courtesy. */
  async withdraw(extraction) {
    try {
      const path = `/v1/extractions/${encodeURIComponent(extraction)}`;
      await this.#fetch(this.#url(path), this.#withKey({ method: 'DELETE', keepalive: true }));
    } catch {
      // The server is gone, and the interest with it.
    }
  }

  /** What becomes known of an extraction, {event, data}, until it is done or has failed. */
  async *events(extraction, signal) {
    const answer = await this.#answer(`/v1/extractions/${encodeURIComponent(extraction)}/events`, { signal });
    const reader = new EventReader();
    for await (const chunk of chunksOf(answer)) {
      for (const { event, data } of reader.push(chunk)) yield { event, data: JSON.parse(data) };
    }
  }

  /** A whole level as a file: drc, glb, ply, obj or stl. */
  async level(extraction, level, format, signal) {
    const answer = await this.#answer(`/v1/extractions/${encodeURIComponent(extraction)}/lods/${level}.${format}`, { signal });
    return answer.blob();
  }

  /** options   import options by name, where the file alone does not tell. */
  uploadUrl(name, options = {}) {
    return this.#url(`/v1/volumes?${new URLSearchParams({ format: 'auto', name, ...options })}`);
  }

  /**
   * The levels of an extraction as they come, coarsest first, and the manifest last:
   * {kind: 'part', level, part, count (parts of that level), bytes: Uint8Array} ... {kind: 'manifest', manifest}.
   */
  async *stream(extraction, signal) {
    const answer = await this.#answer(`/v1/extractions/${encodeURIComponent(extraction)}/stream`, { signal });
    const boundary = multipartBoundary(answer.headers.get('Content-Type'));
    if (!boundary) throw new Problem({ detail: 'The stream of levels is not multipart.' });
    const reader = new MultipartReader(boundary);
    for await (const chunk of chunksOf(answer)) {
      for (const part of reader.push(chunk)) yield streamItem(part);
    }
    if (!reader.finished) cutShort();
  }

  #url(path) {
    return this.#base + path;
  }

  #withKey(options) {
    return this.key ? { ...options, headers: { ...options?.headers, ...this.headers } } : options;
  }

  /** The headers that calls made elsewhere have to send. */
  get headers() {
    return this.key ? { Authorization: `Bearer ${this.key}` } : {};
  }

  async #json(path, options) {
    const answer = await this.#answer(path, options);
    return answer.json();
  }

  async #answer(path, options) {
    let answer;
    try {
      answer = await this.#fetch(this.#url(path), this.#withKey(options));
    } catch (error) {
      if (error.name === 'AbortError') throw error;
      throw new Problem({ detail: 'The server cannot be reached.', code: 'unavailable' });
    }
    if (!answer.ok) throw problemFromText(answer.status, await answer.text());
    return answer;
  }
}

/** The body of an answer as it comes. */
async function* chunksOf(answer) {
  const body = answer.body.getReader();
  for (;;) {
    const { value, done } = await body.read().catch(cutShort);
    if (done) return;
    yield value;
  }
}

/** What ends a stream early: the reader's own abort, or a server that stopped in the middle. */
function cutShort(error) {
  if (error?.name === 'AbortError') throw error;
  throw new Problem({ detail: 'The stream of levels was cut short.', code: 'unavailable' });
}

function streamItem({ headers, body }) {
  if (headers.has('x-geosis-level')) {
    return {
      kind: 'part',
      level: Number(headers.get('x-geosis-level')),
      part: Number(headers.get('x-geosis-part') ?? 0),
      count: Number(headers.get('x-geosis-parts') ?? 1),
      bytes: body,
    };
  }
  const document = JSON.parse(new TextDecoder().decode(body));
  if (/problem\+json/.test(headers.get('content-type') ?? '')) throw new Problem(document);
  return { kind: 'manifest', manifest: document };
}
