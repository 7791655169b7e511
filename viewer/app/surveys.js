import { Latest } from '../core/latest.js';
import { describeCandidate } from '../core/problem.js';
import { describeSurvey, surveyChoices, titleOf, warningsOf } from '../core/survey.js';
import { addressParameters, forgetRequest } from './address.js';
import { SignIn } from './sign_in.js';
import { uploadFile } from './upload.js';

const HISTOGRAM_BINS = 256;

const element = (id) => document.getElementById(id);

/**
 * The section of the surveys: the list, the upload, what is told of the one that is open, and what went wrong.
 *
 * onLeave()                                    another survey is about to be opened.
 * onOpen(volume, grids, counts, isAddressed)   it is here, with its grids and its histogram; addressed: the address names it.
 */
export class Surveys {
  #api;
  #opening = new Latest();
  #signIn;
  #onLeave;
  #onOpen;

  constructor(api, { onLeave, onOpen }) {
    this.#api = api;
    this.#onLeave = onLeave;
    this.#onOpen = onOpen;
    this.#signIn = new SignIn(element('sign-in'), {
      onKey: (key) => {
        api.key = key;
        this.begin();
      },
    });
    api.key = this.#signIn.key;
    this.#listen();
    this.#listenToDrops();
  }

  /** Lists the surveys, and opens the one that the address names, or the first. */
  begin() {
    return this.#tellingProblems(async () => {
      const named = addressParameters().get('volume');
      const choices = await this.#list(named);
      if (named && !choices.some(({ id }) => id === named)) this.#forget();
      else if (choices.length > 0) await this.#open(named ?? choices[0].id, true);
    });
  }

  async #list(chosen) {
    const list = element('survey');
    let choices = null;
    try {
      choices = surveyChoices(await this.#api.volumes());
    } finally {
      const title = choices ? (choices.length > 0 ? 'Choose a survey' : 'No survey yet') : 'Not to be had';
      const options = (choices ?? []).map(({ id, text }) => new Option(text, id, false, id === chosen));
      list.replaceChildren(new Option(title, '', false, true), ...options);
      list.disabled = options.length === 0;
    }
    element('nothing-yet').hidden = choices.length > 0;
    this.#needKey(false);
    return choices;
  }

  async #open(id, isAddressed = false) {
    this.#onLeave();
    this.#showProblem('');
    element('survey').value = id;
    await this.#opening.run(async (signal) => {
      const [volume, grids, counts] = await Promise.all([
        this.#api.volume(id, signal), this.#api.grids(id, signal), this.#api.histogram(id, HISTOGRAM_BINS, signal),
      ]);
      document.body.classList.remove('no-survey');
      this.#describe(volume);
      this.#onOpen(volume, grids, counts, isAddressed);
    });
  }

  #describe(volume) {
    element('survey-line').textContent = describeSurvey(volume);
    document.title = `${titleOf(volume)} – Geosis`;
    const warnings = warningsOf(volume).map(({ text, detail }) => {
      const item = document.createElement('li');
      item.textContent = text;
      if (detail !== text) item.title = detail;
      return item;
    });
    element('warnings').replaceChildren(...warnings);
    element('warnings').hidden = warnings.length === 0;
  }

  /** A survey that the address or the list has is not there any more. */
  #forget() {
    forgetRequest();
    document.body.classList.add('no-survey');
    element('survey').value = '';
    this.#showProblem('This survey is not here any more. Choose another one.');
  }

  /** options   import options, where somebody had to choose them. */
  async #upload(file, options = {}) {
    const bar = element('upload-progress');
    const text = element('upload-text');
    const before = [...text.childNodes];
    this.#showProblem('');
    bar.hidden = false;
    try {
      const stored = await uploadFile(this.#api.uploadUrl(file.name, options), this.#api.headers, file, (fraction) => {
        bar.value = fraction;
        text.textContent = fraction < 1 ? `Sending ${file.name} …` : `Reading ${file.name} …`;
      });
      await this.#list(stored.id);
      await this.#open(stored.id);
    } catch (error) {
      this.#showFailure(error);
      this.#offer(error.candidates ?? [], file);
    } finally {
      bar.hidden = true;
      text.replaceChildren(...before);
    }
  }

  /** One button for each way to read a file. */
  #offer(candidates, file) {
    const buttons = candidates.map((candidate) => {
      const button = document.createElement('button');
      button.type = 'button';
      button.textContent = describeCandidate(candidate);
      const { inline_byte, crossline_byte } = candidate;
      button.addEventListener('click', () => this.#upload(file, { inline_byte, crossline_byte }));
      return button;
    });
    element('candidates').replaceChildren(...buttons);
    element('candidates').hidden = buttons.length === 0;
  }

  #needKey(isNeeded) {
    for (const id of ['survey', 'upload']) element(id).hidden = isNeeded;
    if (!isNeeded) return;
    element('nothing-yet').hidden = true;
    this.#signIn.show();
  }

  #showProblem(text) {
    element('survey-problem').textContent = text;
    element('survey-problem').hidden = text === '';
    this.#offer([]);
  }

  /** Says what went wrong; where a key is missing, or is not the right one, it asks for one. */
  #showFailure(error) {
    const needsKey = error.code === 'unauthenticated';
    this.#showProblem(needsKey && !this.#api.key ? '' : error.message);
    if (needsKey) this.#needKey(true);
  }

  async #tellingProblems(work) {
    try {
      await work();
    } catch (error) {
      this.#showFailure(error);
    }
  }

  #listen() {
    element('survey').addEventListener('change', ({ target }) => {
      if (target.value) this.#tellingProblems(() => this.#change(target.value));
    });
    element('file').addEventListener('change', ({ target }) => {
      if (target.files.length > 0) this.#upload(target.files[0]);
      target.value = '';
    });
  }

  async #change(id) {
    try {
      await this.#open(id);
    } catch (error) {
      if (error.code !== 'not_found') throw error;
      await this.#list(null);
      this.#forget();
    }
  }

  #listenToDrops() {
    const dropping = (on) => document.body.classList.toggle('dropping', on);
    addEventListener('dragover', (event) => {
      event.preventDefault();
      dropping(true);
    });
    addEventListener('dragleave', (event) => event.relatedTarget ?? dropping(false));
    addEventListener('drop', (event) => {
      event.preventDefault();
      dropping(false);
      if (event.dataTransfer.files.length > 0) this.#upload(event.dataTransfer.files[0]);
    });
  }
}
