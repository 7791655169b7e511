import { GeosisApi } from '../core/api.js';
import { describe, describeGrid, idle } from '../core/extraction_state.js';
import { formatCount, formatShare } from '../core/format.js';
import { Histogram } from '../core/histogram.js';
import { debounced, Latest } from '../core/latest.js';
import {
  cornersOf, displayTransform, extentOf, gridFrame, middleOf, suggestedExaggeration, surveyFrame, toDisplay,
} from '../core/placement.js';
import { parseEnd, rangeFromText, rangeMistake, rangeToText } from '../core/range.js';
import {
  choicesFromAddress, choicesToAddress, hasMissing, isPlaced, noChoices, parseMinVoxels, previewOf, requestOf,
} from '../core/request.js';
import { PartDecoder } from '../decode/decoder.js';
import { Stage } from '../three/stage.js';
import { AxisLabels, SurveyBox } from '../three/survey_box.js';
import { Appearance } from './appearance.js';
import { HistogramView } from './histogram_view.js';
import { showLevels } from './levels_table.js';
import { Preview } from './preview.js';
import { Reconstruction } from './reconstruction.js';
import { listenToSave } from './save.js';
import { SignIn } from './sign_in.js';
import { uploadFile } from './upload.js';

const HISTOGRAM_BINS = 256;
const DEBOUNCE_MS = 250;

const element = (id) => document.getElementById(id);
const api = new GeosisApi();
const stage = new Stage(element('view'));
const box = new SurveyBox();
const labels = new AxisLabels(element('labels'));
stage.world.add(box);
stage.afterDraw((camera, width, height) => labels.follow(camera, stage.world, width, height));

/** The volume on the screen: its document, the grids placed for it, what it is drawn in, its way to the display and its histogram. */
let volume = null;
let grids = [];
let frame = null;
let display = null;
let histogram = null;
let range = { low: null, high: null };
let choices = noChoices;
const opening = new Latest();

const histogramView = new HistogramView(element('histogram'), {
  onMove: (moved) => {
    showRange(moved);
    showPreview();
  },
  onRelease: (released) => {
    showRange(released);
    reconstructSoon();
  },
});

const appearanceElements = {
  colouring: element('colouring'), legend: element('legend'), selection: element('selection'), bodies: element('bodies'),
};
const appearance = new Appearance(stage, appearanceElements, {
  onColouring: (name) => remember({ colour: name === 'plain' ? null : name }),
});

const signIn = new SignIn(element('sign-in'), {
  onKey: (key) => {
    api.key = key;
    withProblems(begin());
  },
});
api.key = signIn.key;

listenToSave(element('save'), async (format) => ({
  blob: await api.level(finished, 0, format), name: `${nameOf(volume)}.${format}`,
}));

const decoder = new PartDecoder(new Worker('decode_worker.js'));
const reconstruction = new Reconstruction(api, decoder, {
  onState: showState,
  onLevel: (parts) => preview.isActive || appearance.draw(parts),
});
const preview = new Preview(api, decoder, { onParts: (parts) => appearance.draw(parts) });
const reconstructSoon = debounced(() => reconstruct({ onlyIfNew: true }), DEBOUNCE_MS);
/** What was asked for last, as text. */
let asked = '';
/** The extraction whose levels can be saved, or null. */
let finished = null;

function reconstruct({ onlyIfNew = false } = {}) {
  if (!volume || mistakeInRequest()) return;
  const request = requestOf(range, wantedChoices());
  const asText = JSON.stringify([volume.id, request]);
  if (onlyIfNew && asText === asked && !preview.isActive) return;
  preview.stop();
  asked = asText;
  rememberRequest();
  const placed = grids.find(({ id }) => id === choices.grid);
  const wanted = placed ? gridFrame(placed, volume) : surveyFrame(volume);
  if (JSON.stringify(wanted) !== JSON.stringify(frame)) showFrame(wanted);
  reconstruction.start(volume.id, request, frame);
}

/** A coarse look at what the range would give, while it is still being chosen. */
function showPreview() {
  const request = volume && !mistakeInRequest() ? previewOf(range, wantedChoices()) : null;
  if (request) preview.show(volume.id, request, frame);
}

/** The choices as far as this volume has them. */
function wantedChoices() {
  return hasMissing(volume) ? choices : { ...choices, fill: 'none' };
}

function mistakeInRequest() {
  return rangeMistake(range) || (choices.minVoxels === undefined ? 'Type how many voxels a body has to have at least.' : '');
}

function showState(state) {
  document.body.dataset.phase = state.phase;
  element('status').textContent = describe(state);
  element('status').classList.toggle('problem', state.phase === 'failed');
  element('progress').value = state.progress;
  showLevels(element('levels').tBodies[0], state);
  const note = describeGrid(state);
  element('grid-note').textContent = note;
  element('grid-note').hidden = note === '';
  finished = state.phase === 'done' && !state.manifest.empty ? state.manifest.id : null;
  element('save').hidden = finished === null;
  appearance.show(state);
}

function showRange(changed) {
  range = changed;
  element('low').value = range.low ?? '';
  element('high').value = range.high ?? '';
  histogramView.range = range;
  noteRange();
}

function noteRange() {
  const mistake = mistakeInRequest();
  element('range-note').textContent = mistake || (histogram ? `${formatShare(histogram.share(range))} of the samples` : '');
  element('reconstruct').disabled = !volume || mistake !== '';
}

function showChoices(changed) {
  choices = changed;
  element('fill').value = choices.fill;
  element('grid').value = choices.grid;
  element('specks').value = choices.minVoxels || '';
}

function rememberRequest() {
  remember({ volume: volume.id, range: rangeToText(range), ...choicesToAddress(choices) });
}

/** Keeps these in the page's address; null takes one away. */
function remember(values) {
  const address = new URL(location.href);
  for (const [name, value] of Object.entries(values)) {
    if (value === null) address.searchParams.delete(name);
    else address.searchParams.set(name, value);
  }
  history.replaceState(null, '', address);
}

// ---- surveys

async function listSurveys(chosen) {
  const volumes = await api.volumes();
  const options = volumes.map(({ id, name }) => new Option(name || id.slice(0, 12), id, false, id === chosen));
  const none = new Option(volumes.length > 0 ? 'Choose a survey' : 'No survey yet', '', false, !chosen);
  element('survey').replaceChildren(none, ...options);
  element('survey').disabled = volumes.length === 0;
  return volumes;
}

/** Shows a volume and, with a range, reconstructs its body at once. */
async function openSurvey(id, wantedRange) {
  reconstruction.stop();
  showSurveyProblem('');
  await opening.run(async (signal) => {
    const [document, placed, counts] = await Promise.all([
      api.volume(id, signal), api.grids(id, signal), api.histogram(id, HISTOGRAM_BINS, signal),
    ]);
    placeVolume(document, placed);
    histogram = new Histogram(counts);
    histogramView.show(histogram);
    showRange(wantedRange ?? histogram.brightest());
    reconstruct();
  });
}

/** A name for files, without what was the end of the survey's own. */
function nameOf({ id, name }) {
  return (name || id.slice(0, 12)).replace(/\.\w{1,5}$/, '');
}

function placeVolume(document_, placed) {
  volume = document_;
  grids = placed;
  showFrame(surveyFrame(volume));
  listGrids();
  element('fill-choice').hidden = !hasMissing(volume);
  const [inlines, crosslines, samples] = volume.dims.map(formatCount);
  const holes = volume.missing.traces > 0 ? `, ${formatCount(volume.missing.traces)} traces missing` : '';
  element('survey-line').textContent = `${inlines} inlines × ${crosslines} crosslines × ${samples} samples${holes}`;
  document.title = `${volume.name || 'Survey'} – Geosis`;
}

/** Offers the grids placed for this volume; a choice that it has not is none. */
function listGrids() {
  const placed = (option) => isPlaced(option.value);
  [...element('grid').options].filter(placed).forEach((option) => option.remove());
  element('grid').append(...grids.map(({ id, kind }) => new Option(`on grid ${id.slice(0, 8)} (${kind})`, id)));
  if (isPlaced(choices.grid) && !grids.some(({ id }) => id === choices.grid)) choices = { ...choices, grid: 'given' };
  element('grid').value = choices.grid;
}

/** Draws in another frame from now on. */
function showFrame(wanted) {
  frame = wanted;
  display = displayTransform(frame.transform, middleOf(frame));
  box.place(frame.dims, display);
  labels.place(frame, display);
  const extent = extentOf(display, frame.dims);
  appearance.placeIn(frame.unit, extent.horizontal);
  exaggerate(suggestedExaggeration(extent));
  frameView();
}

function frameView() {
  stage.frame(cornersOf(frame.dims).map((corner) => toDisplay(display, corner)));
}

function exaggerate(factor) {
  stage.world.scale.y = factor;
  element('exaggeration').value = factor;
  element('exaggeration-value').textContent = `× ${factor}`;
  stage.draw();
}

function showSurveyProblem(text) {
  element('survey-problem').textContent = text;
  element('survey-problem').hidden = text === '';
}

async function upload(file) {
  const bar = element('upload-progress');
  const text = element('upload-text');
  const before = [...text.childNodes];
  showSurveyProblem('');
  bar.hidden = false;
  try {
    const stored = await uploadFile(api.uploadUrl(file.name), api.headers, file, (fraction) => {
      bar.value = fraction;
      text.textContent = fraction < 1 ? `Sending ${file.name} …` : `Reading ${file.name} …`;
    });
    await listSurveys(stored.id);
    await openSurvey(stored.id);
  } catch (error) {
    showFailure(error);
  } finally {
    bar.hidden = true;
    text.replaceChildren(...before);
  }
}

// ---- the page

function listenToForm() {
  element('survey').addEventListener('change', ({ target }) => target.value && withProblems(openSurvey(target.value)));
  element('file').addEventListener('change', ({ target }) => {
    if (target.files.length > 0) upload(target.files[0]);
    target.value = '';
  });
  for (const end of ['low', 'high']) {
    element(end).addEventListener('input', ({ target }) => {
      range = { ...range, [end]: parseEnd(target.value) };
      noteRange();
      if (!rangeMistake(range)) histogramView.range = range;
    });
  }
  for (const choice of ['fill', 'grid']) {
    element(choice).addEventListener('change', ({ target }) => {
      choices = { ...choices, [choice]: target.value };
      reconstructSoon();
    });
  }
  element('specks').addEventListener('input', ({ target }) => {
    choices = { ...choices, minVoxels: parseMinVoxels(target.value) };
    noteRange();
  });
  element('specks').addEventListener('change', reconstructSoon);
  element('range').addEventListener('submit', (event) => {
    event.preventDefault();
    reconstruct();
  });
}

function listenToTools() {
  element('exaggeration').addEventListener('input', ({ target }) => exaggerate(Number(target.value)));
  element('wireframe').addEventListener('change', ({ target }) => {
    appearance.wireframe = target.checked;
  });
  element('reset').addEventListener('click', () => (frame ? frameView() : stage.resetView()));
}

function listenToDrops() {
  const dropping = (on) => document.body.classList.toggle('dropping', on);
  addEventListener('dragover', (event) => {
    event.preventDefault();
    dropping(true);
  });
  addEventListener('dragleave', (event) => event.relatedTarget ?? dropping(false));
  addEventListener('drop', (event) => {
    event.preventDefault();
    dropping(false);
    if (event.dataTransfer.files.length > 0) upload(event.dataTransfer.files[0]);
  });
}

function followColours() {
  const dark = matchMedia('(prefers-color-scheme: dark)');
  const apply = () => {
    const style = getComputedStyle(document.documentElement);
    const color = (name) => style.getPropertyValue(name).trim();
    stage.background = color('--sky');
    appearance.theme = { plain: color('--body'), pale: color('--body-filled'), line: color('--ink') };
    box.color = color('--quiet');
    stage.draw();
  };
  dark.addEventListener('change', apply);
  apply();
}

async function withProblems(work) {
  try {
    await work;
  } catch (error) {
    showFailure(error);
  }
}

/** Says what went wrong; where a key is missing, or is not the right one, it asks for one. */
function showFailure(error) {
  const needsKey = error.code === 'unauthenticated';
  showSurveyProblem(needsKey && !api.key ? '' : error.message);
  if (needsKey) signIn.show();
}

async function begin() {
  const address = new URL(location.href).searchParams;
  const volumes = await listSurveys(address.get('volume'));
  const first = address.get('volume') ?? volumes[0]?.id;
  if (!first) return;
  element('survey').value = first;
  showChoices(choicesFromAddress(address));
  appearance.colouring = address.get('colour');
  await openSurvey(first, rangeFromText(address.get('range')));
}

// Work that nobody will see is not worth doing; finished results stay where they are.
addEventListener('pagehide', () => reconstruction.stop());
listenToForm();
listenToTools();
listenToDrops();
followColours();
showState(idle);
withProblems(begin());
