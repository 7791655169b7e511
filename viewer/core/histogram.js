import { roundTo } from './range.js';

/** A histogram as the service sends it, {edges: [n + 1], counts: [n], missing}, seen as bars over the interval [0, 1]. */
export class Histogram {
  constructor({ edges, counts }) {
    this.edges = edges;
    this.counts = counts;
    this.first = edges[0];
    this.last = edges.at(-1);
    this.step = (this.last - this.first) / counts.length;
    this.total = counts.reduce((sum, count) => sum + count, 0);
  }

  /** Heights in [0, 1]; square roots, or the few samples of a body would not be seen beside the many around zero. */
  bars() {
    const highest = Math.max(1, ...this.counts);
    return this.counts.map((count) => Math.sqrt(count / highest));
  }

  /** Where a value lies, clamped to [0, 1]; an open end lies outside of all values. */
  fractionOf(value, whenOpen) {
    if (value === null) return whenOpen;
    if (this.last === this.first) return 0.5;
    return Math.min(1, Math.max(0, (value - this.first) / (this.last - this.first)));
  }

  /** The value at a place; null beyond the ends. */
  valueAt(fraction) {
    if (fraction <= 0 || fraction >= 1) return null;
    return roundTo(this.first + fraction * (this.last - this.first), this.step);
  }

  /** Share of the samples in the range, whole bins counted in proportion. */
  share({ low, high }) {
    if (this.total === 0) return 0;
    let inside = 0;
    for (const [bin, count] of this.counts.entries()) inside += count * this.#overlap(bin, low ?? -Infinity, high ?? Infinity);
    return inside / this.total;
  }

  /** A range to begin with: the highest `share` of the samples, where bright bodies are. */
  brightest(share = 0.015) {
    let above = 0;
    for (let bin = this.counts.length - 1; bin > 0; --bin) {
      above += this.counts[bin];
      if (above >= share * this.total) return { low: roundTo(this.edges[bin], this.step), high: null };
    }
    return { low: null, high: null };
  }

  #overlap(bin, low, high) {
    const from = this.edges[bin];
    const to = this.edges[bin + 1];
    if (to <= from) return low <= from && from <= high ? 1 : 0;
    return Math.max(0, Math.min(high, to) - Math.max(low, from)) / (to - from);
  }
}
