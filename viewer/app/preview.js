import { displayTransform, middleOf } from '../core/placement.js';

/**
 * Shows previews while somebody moves the ends of the range: one at a time, and after it the newest that was asked for.
 *
 * onParts(parts)   a preview is decoded; none where nothing lies in the range.
 */
export class Preview {
  #api;
  #decoder;
  #onParts;
  #wanted = null;
  #running = null; // AbortController
  #isActive = false;
  #isShown = false;

  constructor(api, decoder, { onParts }) {
    this.#api = api;
    this.#decoder = decoder;
    this.#onParts = onParts;
  }

  /** Whether previews are what is to be seen, since show() and until stop(). */
  get isActive() {
    return this.#isActive;
  }

  /** Whether one is on the screen. */
  get isShown() {
    return this.#isShown;
  }

  /** request   as previewOf() makes it.  frame   what to draw in. */
  show(volume, request, frame) {
    this.#isActive = true;
    this.#wanted = { volume, request, frame };
    if (!this.#running) this.#run();
  }

  /** What is on its way is not shown any more. */
  stop() {
    this.#isActive = false;
    this.#isShown = false;
    this.#wanted = null;
    this.#running?.abort();
    this.#running = null;
  }

  async #run() {
    const controller = new AbortController();
    this.#running = controller;
    while (this.#wanted && !controller.signal.aborted) {
      const wanted = this.#wanted;
      this.#wanted = null;
      try {
        const parts = await this.#follow(wanted, controller.signal);
        if (controller.signal.aborted) continue;
        this.#isShown = true;
        this.#onParts(parts);
      } catch {
        // The body itself comes when the handle is released, and tells what is wrong.
      }
    }
    if (this.#running === controller) this.#running = null;
  }

  async #follow({ volume, request, frame }, signal) {
    const { id } = await this.#api.createExtraction(volume, request, signal);
    const parts = [];
    let manifest = null;
    for await (const item of this.#api.stream(id, signal)) {
      if (item.kind === 'part') parts.push(item);
      else ({ manifest } = item);
    }
    const display = displayTransform(manifest.transform, middleOf(frame));
    return Promise.all(parts.map(({ bytes }) => this.#decoder.decode(bytes, display)));
  }
}
