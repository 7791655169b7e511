/** What went wrong, as the service tells it (problem+json) or as the network does, in a sentence for people. */
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
  not_found: 'It may have been deleted meanwhile; reload the page.',
  limit_exceeded: 'It is larger than this server accepts.',
  unavailable: 'The server is busy; try again in a moment.',
  deadline_exceeded: 'It took too long; try again.',
};

function sentence({ title, detail, code, candidates }) {
  const parts = [detail || title || 'The server did not answer as expected.'];
  if (ADVICE[code]) parts.push(ADVICE[code]);
  if (candidates?.length) parts.push(`It could be read as ${candidates.map(describeCandidate).join(' or ')}.`);
  return parts.join(' ');
}

/** One way to read a refused survey: "160 × 200 × 160 (inline at byte 189, crossline at byte 193)". */
export function describeCandidate({ dims, inline_byte, crossline_byte }) {
  return `${dims.join(' × ')} (inline at byte ${inline_byte}, crossline at byte ${crossline_byte})`;
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
