import {
  bodiesCame, bodiesFailed, failed, idle, levelCame, levelChosen, levelKnown, manifestCame, progressed, started,
} from '../core/extraction_state.js';
import { asSentence } from '../core/format.js';
import { Latest } from '../core/latest.js';
import { LevelAssembly } from '../core/level_assembly.js';
import { displayTransform, middleOf } from '../core/placement.js';
import { Problem } from '../core/problem.js';

/**
 * Asks for a body and follows it until its last level is drawn. A new request takes the place of the running one.
 *
 * onState(state)  after every change.     onLevel(parts)  another level is to be drawn.
 */
export class Reconstruction {
  #api;
  #decoder;
  #newest = new Latest();
  #state = idle;
  #levels = new Map(); // level -> its decoded parts
  #onState;
  #onLevel;

  constructor(api, decoder, { onState, onLevel }) {
    this.#api = api;
    this.#decoder = decoder;
    this.#onState = onState;
    this.#onLevel = onLevel;
  }

  /** request   as requestOf() makes it.  frame   what to draw in. */
  async start(volume, request, frame) {
    this.#levels = new Map();
    this.#set(started());
    try {
      await this.#newest.run((signal) => this.#follow(volume, request, frame, signal));
    } catch (error) {
      this.#set(failed(this.#state, error instanceof Problem ? error.message : asSentence(`Something went wrong: ${error.message}`)));
    }
  }

  /** Forgets what is running and what is shown. */
  stop() {
    this.#newest.abort();
    this.#levels = new Map();
    this.#set(idle);
  }

  /** Shows a level that is here. */
  choose(level) {
    const before = this.#state.shown;
    this.#set(levelChosen(this.#state, level));
    if (this.#state.shown !== before) this.#onLevel(this.#levels.get(level));
  }

  #set(state) {
    this.#state = state;
    this.#onState(state);
  }

  async #follow(volume, request, frame, signal) {
    const { id } = await this.#api.createExtraction(volume, request, signal);
    let isComplete = false;
    signal.addEventListener('abort', () => isComplete || this.#api.withdraw(id));
    this.#listen(id, signal);
    const assembly = new LevelAssembly();
    const middle = middleOf(frame);
    const held = []; // parts whose way to the world only the manifest tells
    for await (const item of this.#api.stream(id, signal)) {
      if (item.kind === 'part') {
        if (frame.isPlaced) held.push(item);
        else await this.#decode(item, displayTransform(frame.transform, middle), assembly, signal);
        continue;
      }
      for (const part of held) await this.#decode(part, displayTransform(item.manifest.transform, middle), assembly, signal);
      this.#set(manifestCame(this.#state, item.manifest));
    }
    isComplete = true;
    if (!this.#state.manifest?.empty) await this.#listBodies(id, signal);
  }

  /** The list is an addition: without it everything else stays. */
  async #listBodies(id, signal) {
    try {
      this.#set(bodiesCame(this.#state, await this.#api.bodies(id, signal)));
    } catch (error) {
      if (signal.aborted) throw error;
      this.#set(bodiesFailed(this.#state, error.message));
    }
  }

  async #decode(part, display, assembly, signal) {
    const mesh = await this.#decoder.decode(part.bytes, display);
    const complete = assembly.add(part, mesh);
    if (!complete || signal.aborted) return;
    this.#levels.set(complete.level, complete.parts);
    const next = levelCame(this.#state, complete.level);
    if (next.shown === complete.level) this.#onLevel(complete.parts);
    this.#set(next);
  }

  /** Numbers and progress come beside the meshes. When this channel fails, the stream still carries everything. */
  async #listen(id, signal) {
    const changes = { progress: progressed, level: levelKnown };
    try {
      for await (const { event, data } of this.#api.events(id, signal)) {
        if (signal.aborted) return;
        if (changes[event]) this.#set(changes[event](this.#state, data));
      }
    } catch {
      // The stream tells in the end what matters.
    }
  }
}
