/**
 * Reads a text/event-stream answer while it arrives: what EventSource does, for answers that need a key, which EventSource
 * cannot send.
 */
export class EventReader {
  #text = '';
  #decoder = new TextDecoder();

  /** Takes the next bytes; returns the events they complete: [{event, data}], data as text. */
  push(chunk) {
    this.#text += this.#decoder.decode(chunk, { stream: true });
    const blocks = this.#text.split(/\r?\n\r?\n/);
    this.#text = blocks.pop();
    return blocks.map(eventOf).filter(({ data }) => data !== null);
  }
}

function eventOf(block) {
  const fields = block.split(/\r?\n/).map((line) => /^(\w+):\s?(.*)$/.exec(line)).filter(Boolean);
  const valuesOf = (name) => fields.filter(([, field]) => field === name).map(([, , value]) => value);
  const data = valuesOf('data');
  return { event: valuesOf('event').at(-1) ?? 'message', data: data.length > 0 ? data.join('\n') : null };
}
