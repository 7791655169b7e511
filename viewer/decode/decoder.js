/** The page's side of the decoding worker: decode() answers in the order of the calls. */
export class PartDecoder {
  #worker;
  #tickets = new Map();
  #next = 0;

  constructor(worker) {
    this.#worker = worker;
    worker.onmessage = ({ data }) => this.#settle(data);
    worker.onerror = () => this.#failAll('the mesh decoder did not start');
  }

  /** bytes   a Draco part; its memory goes to the worker.  display   index -> display, 12 numbers. */
  decode(bytes, display) {
    const ticket = this.#next++;
    return new Promise((resolve, reject) => {
      this.#tickets.set(ticket, { resolve, reject });
      this.#worker.postMessage({ ticket, bytes, display }, [bytes.buffer]);
    });
  }

  #settle({ ticket, error, ...mesh }) {
    const waiting = this.#tickets.get(ticket);
    this.#tickets.delete(ticket);
    if (error === undefined) waiting?.resolve(mesh);
    else waiting?.reject(new Error(`a level could not be decoded: ${error}`));
  }

  #failAll(message) {
    for (const { reject } of this.#tickets.values()) reject(new Error(message));
    this.#tickets.clear();
  }
}
