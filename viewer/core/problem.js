import { asSentence, formatCount } from './format.js';

/** What went wrong, as the service tells it (problem+json) or as the network does, in sentences for people. */
export class Problem extends Error {
  /** fields  a problem document: {title, status, detail, code, pointer, candidates}; all may be absent. */
  constructor(fields) {
    super(sentence(fields));
    this.name = 'Problem';
    this.status = fields.status ?? 0;
    this.code = fields.code ?? 'unknown';
    this.candidates = fields.candidates ?? [];
  }
}

const ADVICE = {
  not_found: 'It may have been deleted meanwhile.',
  limit_exceeded: 'It is larger than this server accepts.',
  unavailable: 'The server is busy; try again in a moment.',
  deadline_exceeded: 'It took too long; try again.',
};

const CHOICE = 'This file can be read in more than one way. Which trace header bytes number its inlines and crosslines?';

function sentence({ title, detail, code, candidates }) {
  if (candidates?.length > 1) return CHOICE;
  const said = asSentence(detail || title || 'The server did not answer as expected.');
  return ADVICE[code] ? `${said} ${ADVICE[code]}` : said;
}

/** One way to read a refused survey: "Inlines at byte 189, crosslines at 193: 160 × 200 × 160, 12 traces missing". */
export function describeCandidate({ dims, inline_byte: inline, crossline_byte: crossline, missing_traces: missing }) {
  const holes = missing > 0 ? `, ${formatCount(missing)} ${missing === 1 ? 'trace' : 'traces'} missing` : '';
  return `Inlines at byte ${inline}, crosslines at ${crossline}: ${dims.map(formatCount).join(' × ')}${holes}`;
}

/** The problem in the body of a failed answer, whatever that body is. */
export function problemFromText(status, text) {
  try {
    const fields = JSON.parse(text);
    if (fields && typeof fields === 'object') return new Problem({ ...fields, status });
  } catch {
    // Not JSON: a proxy's page, or nothing at all.
  }
  return new Problem({ status, title: `The server answered with status ${status}.` });
}
