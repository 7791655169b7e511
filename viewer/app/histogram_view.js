/**
 * The histogram with a handle at each end of the range.
 *
 * onMove(range)    while a handle moves.
 * onRelease(range) when it is let go, or after each key.
 */
export class HistogramView {
  #canvas;
  #handles;
  #histogram = null;
  #range = { low: null, high: null };
  #onMove;
  #onRelease;

  constructor(frame, { onMove, onRelease }) {
    this.#canvas = frame.querySelector('canvas');
    this.#handles = { low: frame.querySelector('#low-handle'), high: frame.querySelector('#high-handle') };
    this.#onMove = onMove;
    this.#onRelease = onRelease;
    for (const end of ['low', 'high']) this.#listen(end);
    new ResizeObserver(() => this.#draw()).observe(frame);
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => this.#draw());
  }

  show(histogram) {
    this.#histogram = histogram;
    this.#draw();
  }

  set range(range) {
    this.#range = range;
    this.#draw();
  }

  #listen(end) {
    const handle = this.#handles[end];
    handle.addEventListener('pointerdown', (event) => {
      handle.setPointerCapture(event.pointerId);
      event.preventDefault();
      handle.focus();
    });
    handle.addEventListener('pointermove', (event) => {
      if (!handle.hasPointerCapture(event.pointerId)) return;
      const { left, width } = this.#canvas.getBoundingClientRect();
      this.#moveTo(end, (event.clientX - left) / width);
    });
    handle.addEventListener('lostpointercapture', () => this.#onRelease(this.#range));
    handle.addEventListener('keydown', (event) => this.#onKey(end, event));
  }

  #onKey(end, event) {
    const here = this.#fraction(end);
    const step = 1 / (this.#histogram?.counts.length ?? 256);
    const places = {
      ArrowLeft: here - step, ArrowDown: here - step, ArrowRight: here + step, ArrowUp: here + step,
      PageDown: here - 10 * step, PageUp: here + 10 * step, Home: 0, End: 1,
    };
    if (!(event.key in places)) return;
    event.preventDefault();
    this.#moveTo(end, places[event.key]);
    this.#onRelease(this.#range);
  }

  #fraction(end) {
    return this.#histogram?.fractionOf(this.#range[end], end === 'low' ? 0 : 1) ?? (end === 'low' ? 0 : 1);
  }

  /** The handles never pass each other. */
  #moveTo(end, fraction) {
    if (!this.#histogram) return;
    const bounded = end === 'low' ? Math.min(fraction, this.#fraction('high')) : Math.max(fraction, this.#fraction('low'));
    const outermost = end === 'low' ? 0 : 1;
    const value = bounded === outermost ? null : this.#histogram.valueAt(bounded);
    this.range = { ...this.#range, [end]: value };
    this.#onMove(this.#range);
  }

  #draw() {
    for (const end of ['low', 'high']) this.#placeHandle(end);
    const { clientWidth: width, clientHeight: height } = this.#canvas;
    const scale = devicePixelRatio;
    this.#canvas.width = Math.round(width * scale);
    this.#canvas.height = Math.round(height * scale);
    if (!this.#histogram || width === 0) return;
    const context = this.#canvas.getContext('2d');
    context.scale(scale, scale);
    this.#drawBars(context, width, height);
  }

  #drawBars(context, width, height) {
    const style = getComputedStyle(this.#canvas);
    const [inside, outside, tint] = ['--accent', '--bar', '--tint'].map((name) => style.getPropertyValue(name));
    const [low, high] = [this.#fraction('low'), this.#fraction('high')];
    context.fillStyle = tint;
    context.fillRect(low * width, 0, (high - low) * width, height);
    const bars = this.#histogram.bars();
    for (const [bin, bar] of bars.entries()) {
      const middle = (bin + 0.5) / bars.length;
      context.fillStyle = low <= middle && middle <= high ? inside : outside;
      context.fillRect((bin / bars.length) * width, height * (1 - bar), width / bars.length, height * bar);
    }
  }

  #placeHandle(end) {
    const handle = this.#handles[end];
    const value = this.#range[end];
    handle.style.left = `${100 * this.#fraction(end)}%`;
    if (!this.#histogram) return;
    handle.setAttribute('aria-valuemin', this.#histogram.first);
    handle.setAttribute('aria-valuemax', this.#histogram.last);
    handle.setAttribute('aria-valuenow', value ?? (end === 'low' ? this.#histogram.first : this.#histogram.last));
    handle.setAttribute('aria-valuetext', value === null ? 'open' : String(value));
  }
}
