import assert from 'node:assert/strict';
import { describe, it } from 'node:test';

import { multipartBoundary, MultipartReader } from '../core/multipart.js';

const text = new TextDecoder();
const ANSWER =
  'preamble\r\n--b\r\nContent-Type: text/plain\r\nX-Geosis-Level: 4\r\n\r\none\r\n--other\r\n' +
  '--b\r\nContent-Length: 11\r\n\r\ntwo\r\n--b\r\nx\r\n--b\r\n\r\n\r\n--b--\r\nepilogue';

/** What a reader makes of the answer cut into pieces of this size. */
function readInPieces(answer, size) {
  const bytes = new TextEncoder().encode(answer);
  const reader = new MultipartReader('b');
  const parts = [];
  for (let from = 0; from < bytes.length; from += size) parts.push(...reader.push(bytes.subarray(from, from + size)));
  return { reader, parts };
}

describe('MultipartReader', () => {
  it('finds the same parts however the answer is cut', () => {
    for (let size = 1; size <= ANSWER.length; ++size) {
      const { reader, parts } = readInPieces(ANSWER, size);
      assert.deepEqual(parts.map(({ body }) => text.decode(body)), ['one\r\n--other', 'two\r\n--b\r\nx', ''], `pieces of ${size}`);
      assert.ok(reader.finished);
    }
  });

  it('gives headers by lower-case name', () => {
    const [first] = readInPieces(ANSWER, 7).parts;
    assert.equal(first.headers.get('x-geosis-level'), '4');
    assert.equal(first.headers.get('content-type'), 'text/plain');
  });

  it('knows that an answer was cut short', () => {
    assert.equal(readInPieces(ANSWER.slice(0, ANSWER.indexOf('--b--')), 64).reader.finished, false);
  });

  it('does not take a length for granted that the bytes contradict', () => {
    const { parts } = readInPieces('--b\r\nContent-Length: 1e3\r\n\r\nabc\r\n--b--', 64);
    assert.equal(text.decode(parts[0].body), 'abc');
  });
});

describe('multipartBoundary', () => {
  it('reads plain and quoted boundaries', () => {
    assert.equal(multipartBoundary('multipart/mixed; boundary=a-b_c'), 'a-b_c');
    assert.equal(multipartBoundary('Multipart/Mixed; charset=x; boundary="a b"'), 'a b');
  });

  it('is null for other types', () => {
    assert.equal(multipartBoundary('application/json'), null);
    assert.equal(multipartBoundary(null), null);
  });
});
