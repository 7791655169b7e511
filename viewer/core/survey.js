import { asSentence, formatCount } from './format.js';

/** What the page says of surveys. A volume is its document. */

/** The volumes by name, and what each is called in the list: those that share a name are told apart by their ids. */
export function surveyChoices(volumes) {
  const titles = volumes.map(titleOf);
  return volumes
    .map(({ id }, at) => {
      const isShared = titles.indexOf(titles[at]) !== titles.lastIndexOf(titles[at]);
      return { id, text: isShared ? `${titles[at]} (${id.slice(0, 6)})` : titles[at] };
    })
    .sort((a, b) => a.text.localeCompare(b.text, 'en', { numeric: true }));
}

export function titleOf({ id, name }) {
  return name || id.slice(0, 12);
}

/** A name for files, without what was the end of the survey's own. */
export function fileNameOf(volume) {
  return titleOf(volume).replace(/\.\w{1,5}$/, '');
}

export function describeSurvey({ dims, missing }) {
  const [inlines, crosslines, samples] = dims.map(formatCount);
  const holes = missing.traces > 0 ? `, ${formatCount(missing.traces)} ${missing.traces === 1 ? 'trace' : 'traces'} missing` : '';
  return `${inlines} inlines × ${crosslines} crosslines × ${samples} samples${holes}`;
}

/** Warnings whose details speak of header bytes, in plain words. */
const PLAIN = {
  no_coordinates: 'The file has no coordinates: lengths count lines, not metres.',
  trace_sample_count: 'The trace headers tell another number of samples than the file has. The file counts.',
  sample_count: 'The file header tells another number of samples than the traces have. The traces count.',
  delay: 'The traces do not all begin at the same time. All are placed where the first one begins.',
  extended_text_count: 'The file header tells of text that is not there.',
  no_valid_samples: 'Every sample is missing: there is nothing to reconstruct.',
};

/** [{text, detail}]: what was found odd in the file, for people, and as the server says it. */
export function warningsOf({ warnings }) {
  return (warnings ?? []).map(({ code, detail }) => ({ text: PLAIN[code] ?? asSentence(detail), detail: asSentence(detail) }));
}
