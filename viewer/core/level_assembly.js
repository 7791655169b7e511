/**
 * Collects the parts of the levels as they arrive, coarsest level first, and decides which level to draw: each complete
 * one that is finer than the one on the screen.
 */
export class LevelAssembly {
  #level = Infinity;
  #parts = new Map(); // part -> mesh
  #shown = Infinity;

  /**
   * count    parts of this level, as the part itself says.
   * returns  {level, parts: [mesh]} when this part made the level complete, otherwise null.
   */
  add({ level, part, count }, mesh) {
    if (level !== this.#level) this.#parts = new Map();
    this.#level = level;
    this.#parts.set(part, mesh);
    if (this.#parts.size < count || level >= this.#shown) return null;
    this.#shown = level;
    const ordered = [...this.#parts].sort(([a], [b]) => a - b);
    return { level, parts: ordered.map(([, mesh]) => mesh) };
  }
}
