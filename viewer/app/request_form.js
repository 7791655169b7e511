import { formatShare } from '../core/format.js';
import { Histogram } from '../core/histogram.js';
import { debounced } from '../core/latest.js';
import { gridFrame, surveyFrame } from '../core/placement.js';
import { parseEnd, rangeMistake, rangeToText } from '../core/range.js';
import {
  choicesToAddress, hasMissing, isPlaced, noChoices, parseMinVoxels, parseVelocity, previewOf, requestOf, takesVelocity,
} from '../core/request.js';
import { remember } from './address.js';
import { HistogramView } from './histogram_view.js';

const DEBOUNCE_MS = 250;

/**
 * What somebody asks for: the range of amplitudes and the choices beside it.
 *
 * onMove()                 the range is being chosen: a handle moves.
 * onWanted({onlyIfNew})    it is to be reconstructed; where only a field was touched, unless it is what was asked for last.
 */
export class RequestForm {
  #form;
  #histogramView;
  #histogram = null;
  #volume = null;
  #grids = [];
  #range = { low: null, high: null };
  #choices = noChoices;

  /** form   the element around the fields.   histogramFrame   that of the histogram. */
  constructor(form, histogramFrame, { onMove, onWanted }) {
    this.#form = form;
    const wantedSoon = debounced(() => onWanted({ onlyIfNew: true }), DEBOUNCE_MS);
    this.#histogramView = new HistogramView(histogramFrame, {
      onMove: (moved) => {
        this.range = moved;
        onMove();
      },
      onRelease: (released) => {
        this.range = released;
        wantedSoon();
      },
    });
    this.#listen(wantedSoon, onWanted);
  }

  /** grids   those placed for it.   counts   its histogram. */
  openSurvey(volume, grids, counts) {
    this.#volume = volume;
    this.#grids = grids;
    this.#histogram = new Histogram(counts);
    this.#histogramView.show(this.#histogram);
    this.#listGrids();
    this.#field('fill-choice').hidden = !hasMissing(volume);
    this.#showVelocity();
  }

  /** The range that a survey begins with. */
  get brightest() {
    return this.#histogram.brightest();
  }

  set range(range) {
    this.#range = range;
    this.#field('low').value = range.low ?? '';
    this.#field('high').value = range.high ?? '';
    this.#histogramView.range = range;
    this.#note();
  }

  set choices(choices) {
    this.#choices = choices;
    this.#field('fill').value = choices.fill;
    this.#field('grid').value = choices.grid;
    this.#field('specks').value = choices.minVoxels || '';
    this.#field('velocity').value = choices.velocity ?? '';
  }

  /** What the service is to be asked for; null while that makes no sense. */
  get request() {
    return this.#isSound ? requestOf(this.#range, this.#wantedChoices) : null;
  }

  /** The same for a coarse look; null where there is none. */
  get preview() {
    return this.#isSound ? previewOf(this.#range, this.#wantedChoices) : null;
  }

  /** What the answer is to be drawn in. */
  get frame() {
    const { velocity } = this.#wantedChoices;
    return this.#placed ? gridFrame(this.#placed, this.#volume, velocity) : surveyFrame(this.#volume, velocity);
  }

  rememberRequest() {
    remember({ volume: this.#volume.id, range: rangeToText(this.#range), ...choicesToAddress(this.#choices) });
  }

  get #isSound() {
    return this.#volume !== null && this.#mistake === '';
  }

  /** The grid that is chosen, where somebody has placed it. */
  get #placed() {
    return this.#grids.find(({ id }) => id === this.#choices.grid);
  }

  /** The choices as far as this volume has them. */
  get #wantedChoices() {
    const fill = hasMissing(this.#volume) ? this.#choices.fill : 'none';
    const velocity = takesVelocity(this.#volume, this.#placed) ? this.#choices.velocity : null;
    return { ...this.#choices, fill, velocity };
  }

  get #mistake() {
    const { minVoxels, velocity } = this.#wantedChoices;
    if (minVoxels === undefined) return 'Type how many voxels a body has to have at least.';
    if (velocity === undefined) return 'Type a velocity in metres a second, at most 20 000, or leave the field empty.';
    return rangeMistake(this.#range);
  }

  #field(id) {
    return this.#form.querySelector(`#${id}`);
  }

  #note() {
    const mistake = this.#mistake;
    const share = mistake || !this.#histogram ? '' : `${formatShare(this.#histogram.share(this.#range))} of the samples`;
    this.#field('range-note').textContent = mistake || share;
    this.#field('reconstruct').disabled = !this.#isSound;
  }

  /** Offers the grids placed for this volume; a choice that it has not is none. */
  #listGrids() {
    const list = this.#field('grid');
    [...list.options].filter(({ value }) => isPlaced(value)).forEach((option) => option.remove());
    list.append(...this.#grids.map(({ id, kind }) => new Option(`on grid ${id.slice(0, 8)} (${kind})`, id)));
    if (isPlaced(this.#choices.grid) && !this.#placed) this.#choices = { ...this.#choices, grid: 'given' };
    list.value = this.#choices.grid;
  }

  #showVelocity() {
    this.#field('velocity-choice').hidden = !takesVelocity(this.#volume, this.#placed);
  }

  #listen(wantedSoon, onWanted) {
    const choose = (name, value) => {
      this.#choices = { ...this.#choices, [name]: value };
    };
    for (const end of ['low', 'high']) {
      this.#field(end).addEventListener('input', ({ target }) => {
        this.#range = { ...this.#range, [end]: parseEnd(target.value) };
        this.#note();
        if (!rangeMistake(this.#range)) this.#histogramView.range = this.#range;
      });
    }
    for (const choice of ['fill', 'grid']) {
      this.#field(choice).addEventListener('change', ({ target }) => {
        choose(choice, target.value);
        this.#showVelocity();
        wantedSoon();
      });
    }
    for (const [field, name, parse] of [['specks', 'minVoxels', parseMinVoxels], ['velocity', 'velocity', parseVelocity]]) {
      this.#field(field).addEventListener('input', ({ target }) => {
        choose(name, parse(target.value));
        this.#note();
      });
      this.#field(field).addEventListener('change', wantedSoon);
    }
    this.#field('range').addEventListener('submit', (event) => {
      event.preventDefault();
      onWanted({ onlyIfNew: false });
    });
  }
}
