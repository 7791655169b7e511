/**
 * Reads a multipart/mixed answer while it arrives.
 *
 * The bytes of one answer are kept in one growing array only as long as the part they belong to is incomplete, so memory
 * is bounded by the largest part. A part that states its Content-Length is not searched for the delimiter.
 */

/** The boundary named in a Content-Type, or null when it is not a multipart type. */
export function multipartBoundary(contentType) {
  const match = /^multipart\/[\w.+-]+\s*;(?:.*;)?\s*boundary=(?:"([^"]+)"|([^\s;"]+))/i.exec(contentType ?? '');
  return match ? match[1] ?? match[2] : null;
}

const CRLF = '\r\n';
const encoder = new TextEncoder();
const decoder = new TextDecoder();

/** Position of the pattern in bytes[from, to), or -1. */
function find(bytes, pattern, from, to) {
  for (let at = bytes.indexOf(pattern[0], from); at >= 0 && at + pattern.length <= to; at = bytes.indexOf(pattern[0], at + 1)) {
    let matched = 1;
    while (matched < pattern.length && bytes[at + matched] === pattern[matched]) ++matched;
    if (matched === pattern.length) return at;
  }
  return -1;
}

/** Header lines to a Map from lower-case name to value. */
function parseHeaders(text) {
  const headers = new Map();
  for (const line of text.split(CRLF)) {
    const colon = line.indexOf(':');
    if (colon > 0) headers.set(line.slice(0, colon).trim().toLowerCase(), line.slice(colon + 1).trim());
  }
  return headers;
}

export class MultipartReader {
  #delimiter;
  #headersEnd = encoder.encode(CRLF + CRLF);
  // The first delimiter has no line end before it: this one stands in for it.
  #bytes = encoder.encode(CRLF);
  #size = 2;
  #scanned = 0;
  #headers = null; // of the part whose body is being read; null before the first delimiter
  #state = 'body';

  constructor(boundary) {
    this.#delimiter = encoder.encode(`${CRLF}--${boundary}`);
  }

  /** True after the closing delimiter. An answer that ends before it was cut short. */
  get finished() {
    return this.#state === 'end';
  }

  /** Takes the next bytes; returns the parts they complete: [{headers: Map, body: Uint8Array}]. */
  push(chunk) {
    this.#append(chunk);
    const parts = [];
    while (this.#step(parts));
    return parts;
  }

  #append(chunk) {
    if (this.#size + chunk.length > this.#bytes.length) {
      const larger = new Uint8Array(Math.max(2 * this.#bytes.length, this.#size + chunk.length));
      larger.set(this.#bytes.subarray(0, this.#size));
      this.#bytes = larger;
    }
    this.#bytes.set(chunk, this.#size);
    this.#size += chunk.length;
  }

  /** One move of the state machine; false when more bytes are needed. */
  #step(parts) {
    switch (this.#state) {
      case 'body':
        return this.#readBody(parts);
      case 'delimiter':
        return this.#readAfterDelimiter();
      case 'headers':
        return this.#readHeaders();
      default:
        return false;
    }
  }

  #readBody(parts) {
    const end = find(this.#bytes, this.#delimiter, this.#scanned, this.#size);
    if (end < 0) {
      this.#scanned = Math.max(this.#scanned, this.#size - this.#delimiter.length + 1);
      return false;
    }
    if (this.#headers) parts.push({ headers: this.#headers, body: this.#bytes.slice(0, end) });
    this.#drop(end + this.#delimiter.length);
    this.#state = 'delimiter';
    return true;
  }

  #readAfterDelimiter() {
    if (this.#size < 2) return false;
    this.#state = this.#bytes[0] === 0x2d && this.#bytes[1] === 0x2d ? 'end' : 'headers';
    return true;
  }

  #readHeaders() {
    const end = find(this.#bytes, this.#headersEnd, 0, this.#size);
    if (end < 0) return false;
    this.#headers = parseHeaders(decoder.decode(this.#bytes.subarray(0, end)));
    this.#drop(end + this.#headersEnd.length);
    const length = this.#headers.get('content-length') ?? '';
    this.#scanned = /^\d{1,15}$/.test(length) ? Number(length) : 0;
    this.#state = 'body';
    return true;
  }

  #drop(count) {
    this.#bytes.copyWithin(0, count, this.#size);
    this.#size -= count;
    this.#scanned = 0;
  }
}
