import { GeosisApi } from '../core/api.js';
import { describe, describeGrid, describePreview, idle } from '../core/extraction_state.js';
import { rangeFromText } from '../core/range.js';
import { choicesFromAddress } from '../core/request.js';
import { fileNameOf } from '../core/survey.js';
import { PartDecoder } from '../decode/decoder.js';
import { Stage } from '../three/stage.js';
import { addressParameters, remember } from './address.js';
import { Appearance } from './appearance.js';
import { LevelsTable } from './levels_table.js';
import { Preview } from './preview.js';
import { Reconstruction } from './reconstruction.js';
import { RequestForm } from './request_form.js';
import { listenToSave } from './save.js';
import { SurveyView } from './survey_view.js';
import { Surveys } from './surveys.js';

const element = (id) => document.getElementById(id);
const api = new GeosisApi();
const overlays = ['tools', 'colouring', 'selection'].map(element);
const stage = new Stage(element('view'), overlays);

/** The volume on the screen, and what is known of its extraction. */
let volume = null;
let state = idle;
/** What was asked for last, as text. */
let asked = '';

const elementsOf = (...ids) => Object.fromEntries(ids.map((id) => [id, element(id)]));
const appearance = new Appearance(stage, elementsOf('colouring', 'legend', 'ramp', 'selection', 'bodies'), {
  onColouring: (name) => remember({ colour: name === 'plain' ? null : name }),
});
const surveyView = new SurveyView(stage, { ...elementsOf('labels', 'tools'), overlays }, {
  onWireframe: (isOn) => {
    appearance.wireframe = isOn;
  },
});

const decoder = new PartDecoder(new Worker('decode_worker.js'));
const reconstruction = new Reconstruction(api, decoder, {
  onState: (changed) => {
    state = changed;
    showState();
    appearance.show(state);
  },
  onLevel: (parts) => preview.isActive || appearance.draw(parts),
});
const preview = new Preview(api, decoder, {
  onParts: (parts) => {
    appearance.drawPreview(parts);
    showState(parts.length === 0);
  },
});
const levelsTable = new LevelsTable(element('levels'), { onChoose: (level) => reconstruction.choose(level) });
const form = new RequestForm(document.querySelector('aside'), element('histogram'), { onMove: showPreview, onWanted: reconstruct });
const surveys = new Surveys(api, { onLeave: leaveSurvey, onOpen: openSurvey });

listenToSave(element('save'), async (format) => {
  const { manifest, shown } = state;
  const name = fileNameOf(volume) + (shown > 0 ? `_level${shown}` : '');
  return { blob: await api.level(manifest.id, shown, format), name: `${name}.${format}` };
});

function leaveSurvey() {
  preview.stop();
  reconstruction.stop();
}

/** Shows a volume and reconstructs its body at once: with what the address asks for, or with its brightest samples. */
function openSurvey(opened, grids, counts, isAddressed) {
  volume = opened;
  const address = addressParameters();
  if (isAddressed) {
    form.choices = choicesFromAddress(address);
    appearance.colouring = address.get('colour');
  }
  form.openSurvey(volume, grids, counts);
  form.range = (isAddressed ? rangeFromText(address.get('range')) : null) ?? form.brightest;
  placeFrame();
  reconstruct({ onlyIfNew: false });
}

function reconstruct({ onlyIfNew }) {
  const { request } = form;
  if (!request) return;
  const asText = JSON.stringify([volume.id, request]);
  if (onlyIfNew && asText === asked && !preview.isActive) return;
  preview.stop();
  asked = asText;
  form.rememberRequest();
  placeFrame();
  reconstruction.start(volume.id, request, surveyView.frame);
}

/** A coarse look at what the range would give, while it is still being chosen. */
function showPreview() {
  const request = form.preview;
  if (!request) return;
  placeFrame();
  preview.show(volume.id, request, surveyView.frame);
}

function placeFrame() {
  const extent = surveyView.place(form.frame);
  if (extent) appearance.placeIn(surveyView.frame, extent.horizontal);
}

function showState(isPreviewEmpty = false) {
  const isPreview = preview.isShown;
  const isDone = state.phase === 'done' && !state.manifest.empty && !isPreview;
  document.body.dataset.phase = state.phase;
  element('status').textContent = isPreview ? describePreview(isPreviewEmpty) : describe(state);
  element('status').classList.toggle('problem', state.phase === 'failed' && !isPreview);
  element('progress').value = state.progress;
  levelsTable.show(state, isPreview);
  element('bodies').classList.toggle('old', isPreview);
  element('preview-note').hidden = !isPreview;
  const note = isPreview ? '' : describeGrid(state);
  element('grid-note').textContent = note;
  element('grid-note').hidden = note === '';
  element('save').hidden = !isDone;
  element('save-level').textContent = String(state.shown ?? 0);
}

function followColours() {
  const dark = matchMedia('(prefers-color-scheme: dark)');
  const apply = () => {
    const style = getComputedStyle(document.documentElement);
    const color = (name) => style.getPropertyValue(name).trim();
    stage.background = color('--sky');
    appearance.theme = { plain: color('--body'), pale: color('--body-filled'), line: color('--ink') };
    surveyView.color = color('--quiet');
    stage.draw();
  };
  dark.addEventListener('change', apply);
  apply();
}

// Work that nobody will see is not worth doing; finished results stay where they are.
addEventListener('pagehide', () => reconstruction.stop());
followColours();
showState();
surveys.begin();
