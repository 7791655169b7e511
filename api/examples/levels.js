// Uploads a survey, asks for the body of a range, and fetches its levels, in a browser or anything else that has fetch.
//
//     const geosis = new Geosis('http://127.0.0.1:8080');
//     const volume = await geosis.upload(file, 'survey.sgy');
//     for await (const { level, name, blob } of geosis.levels(volume, [0.5, null])) { ... }      coarsest first
//
// Pages of another origin need the server's --cors-origin.

export class Geosis {
  /** key: of a server that asks for one. */
  constructor(server, key = null) {
    this.server = server;
    this.headers = key ? { Authorization: `Bearer ${key}` } : {};
  }

  /** The volume's document. file: a File or Blob. */
  async upload(file, name) {
    const headers = { 'Content-Type': 'application/octet-stream' };
    return (await this.call(`/v1/volumes?name=${encodeURIComponent(name)}`, { method: 'POST', body: file, headers })).json();
  }

  /** The extraction's document once it is done. range: [low, high]; null is an open end. */
  async extract(volume, range) {
    const headers = { 'Content-Type': 'application/json', Prefer: 'wait=60' };
    const request = { method: 'POST', body: JSON.stringify({ range }), headers };
    for (;;) {
      const extraction = await (await this.call(`/v1/volumes/${volume.id}/extractions`, request)).json();
      if (extraction.state === 'done') return extraction;
      if (extraction.error) throw new Error(`${extraction.error.code}: ${extraction.error.detail}`);
    }
  }

  /** Yields {level, name, blob, entry}, coarsest first: whole levels as glTF, entry = what the manifest says of it. */
  async *levels(volume, range) {
    const extraction = await this.extract(volume, range);
    const manifest = await (await this.call(extraction.links.manifest)).json();
    for (const entry of manifest.levels.toReversed?.() ?? [...manifest.levels].reverse()) {
      const answer = await this.call(`${extraction.links.self}/lods/${entry.level}.glb`);
      yield { level: entry.level, name: `level${entry.level}.glb`, blob: await answer.blob(), entry };
    }
  }

  /** The answer; a problem is thrown with what the server says of it. */
  async call(path, { headers = {}, ...request } = {}) {
    const answer = await fetch(this.server + path, { ...request, headers: { ...this.headers, ...headers } });
    if (answer.ok) return answer;
    const problem = await answer.json();
    throw new Error(`${problem.code}: ${problem.detail}`);
  }
}
