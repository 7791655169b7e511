/** Runs tasks of which only the newest matters: starting one aborts the one before. */
export class Latest {
  #controller = null;

  /** task   async (signal) => ...; its AbortError, once a newer task has begun, is not an error. */
  async run(task) {
    this.#controller?.abort();
    const controller = new AbortController();
    this.#controller = controller;
    try {
      return await task(controller.signal);
    } catch (error) {
      if (controller.signal.aborted) return undefined;
      throw error;
    }
  }

  abort() {
    this.#controller?.abort();
    this.#controller = null;
  }
}

/** A function that calls `action` once, `delayMs` after its last call. */
export function debounced(action, delayMs, timers = globalThis) {
  let timer;
  return (...args) => {
    timers.clearTimeout(timer);
    timer = timers.setTimeout(() => action(...args), delayMs);
  };
}
