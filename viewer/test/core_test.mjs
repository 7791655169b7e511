import assert from 'node:assert/strict';
import { describe, it } from 'node:test';

import { GeosisApi } from '../core/api.js';
import {
  describe as sentenceOf, describeGrid, describePreview, failed, idle, levelCame, levelChosen, levelKnown, manifestCame, progressed, started,
} from '../core/extraction_state.js';
import { EventReader } from '../core/event_stream.js';
import { asSentence, formatBytes, formatCount, formatDistance, formatShare, formatWhole } from '../core/format.js';
import { Histogram } from '../core/histogram.js';
import { debounced, Latest } from '../core/latest.js';
import { LevelAssembly } from '../core/level_assembly.js';
import { describeDropped, levelCells } from '../core/levels.js';
import { describeCandidate, problemFromText } from '../core/problem.js';
import { parseEnd, rangeFromText, rangeMistake, rangeToText, roundTo } from '../core/range.js';
import { describeSurvey, fileNameOf, surveyChoices, warningsOf } from '../core/survey.js';

describe('LevelAssembly', () => {
  it('shows each finer level when its last part is here', () => {
    const assembly = new LevelAssembly();
    assert.deepEqual(assembly.add({ level: 1, part: 0, count: 1 }, 'coarse'), { level: 1, parts: ['coarse'] });
    assert.equal(assembly.add({ level: 0, part: 1, count: 2 }, 'right'), null);
    assert.deepEqual(assembly.add({ level: 0, part: 0, count: 2 }, 'left'), { level: 0, parts: ['left', 'right'] });
  });

  it('never goes back to a coarser level', () => {
    const assembly = new LevelAssembly();
    assembly.add({ level: 0, part: 0, count: 1 }, 'fine');
    assert.equal(assembly.add({ level: 2, part: 0, count: 1 }, 'coarse'), null);
  });
});

describe('Latest', () => {
  it('aborts the running task when a newer one starts, silently', async () => {
    const latest = new Latest();
    let aborted;
    const first = latest.run((signal) => new Promise((_, reject) => {
      aborted = signal;
      signal.addEventListener('abort', () => reject(signal.reason));
    }));
    assert.equal(await latest.run(async () => 'second'), 'second');
    assert.equal(await first, undefined);
    assert.ok(aborted.aborted);
  });

  it('lets other failures through', async () => {
    await assert.rejects(new Latest().run(async () => { throw new Error('broken'); }), /broken/);
  });
});

describe('EventReader', () => {
  const bytes = new TextEncoder().encode(
    ': hello\r\n\r\nevent: progress\ndata: {"stage":"fill", "é": 1}\n\nid: 7\nevent: level\ndata: [1,\ndata: 2]\n\ndata: cut');

  it('gives the same events however they arrive', () => {
    for (const size of [1, 2, 5, 1000]) {
      const reader = new EventReader();
      const events = [];
      for (let at = 0; at < bytes.length; at += size) events.push(...reader.push(bytes.slice(at, at + size)));
      assert.deepEqual(events, [{ event: 'progress', data: '{"stage":"fill", "é": 1}' }, { event: 'level', data: '[1,\n2]' }], `${size} at once`);
    }
  });
});

describe('a key', () => {
  it('goes with every call, and only when there is one', async () => {
    const sent = [];
    const api = new GeosisApi('', async (url, options) => {
      sent.push(options?.headers ?? {});
      return new Response('{"volumes": [], "bodies": []}');
    });
    await api.volumes();
    api.key = 'secret';
    await api.volumes();
    await api.createExtraction('v', {});
    await api.withdraw('e');
    const { Authorization, ...others } = sent[2];
    assert.deepEqual([sent[0], sent[1], others, sent[3]], [{}, { Authorization: 'Bearer secret' }, { 'Content-Type': 'application/json' }, sent[1]]);
    assert.equal(Authorization, 'Bearer secret');
  });
});

describe('the grid', () => {
  const on = (grid) => describeGrid({ manifest: { grid } });

  it('is told where it is not the given one', () => {
    assert.equal(describeGrid({ manifest: null }), '');
    assert.equal(describeGrid({ manifest: {} }), '');
    assert.equal(on({ asked: 'structural', chosen: 'structural', because: 'it was asked for', unreliable_share: 0.034 }),
      'Joined along the reflectors. 3.4 % of the samples lie where traces hardly agree.');
    assert.match(on({ asked: 'structural', chosen: 'structural', unreliable_share: 1e-6 }), /reflectors\. Under 0\.01 %/);
    assert.equal(on({ asked: 'ab', chosen: 'curvilinear', folded_share: 0.002 }),
      "Where the grid's nodes are placed. 0.2 % of its cells are folded: the surface may cross itself there.");
    assert.equal(on({ asked: 'auto', chosen: 'given', because: 'dips are small' }), 'Joined along the axes: dips are small.');
  });
});

describe('debounced', () => {
  it('acts once, with the last arguments', () => {
    const waiting = new Map();
    const timers = { setTimeout: (action, ms) => waiting.set(ms, action) && ms, clearTimeout: (id) => waiting.delete(id) };
    const calls = [];
    const act = debounced((value) => calls.push(value), 250, timers);
    act(1);
    act(2);
    for (const action of waiting.values()) action();
    assert.deepEqual(calls, [2]);
  });
});

describe('range', () => {
  it('takes an empty field, inf and the sign for an open end', () => {
    for (const text of ['', ' ', 'inf', '-inf', '∞', '-Infinity']) assert.equal(parseEnd(text), null, text);
  });

  it('takes numbers with point or comma, and refuses words', () => {
    assert.equal(parseEnd(' -1e3 '), -1000);
    assert.equal(parseEnd('0,5'), 0.5);
    assert.equal(parseEnd('half'), undefined);
  });

  it('says what is wrong', () => {
    assert.equal(rangeMistake({ low: 1, high: 1 }), '');
    assert.match(rangeMistake({ low: 2, high: 1 }), /above/);
    assert.match(rangeMistake({ low: undefined, high: 1 }), /number/);
  });

  it('comes back from the page address', () => {
    for (const range of [{ low: 0.5, high: null }, { low: null, high: -2 }, { low: null, high: null }]) {
      assert.deepEqual(rangeFromText(rangeToText(range)), range);
    }
    assert.equal(rangeFromText('3,1'), null);
    assert.equal(rangeFromText(null), null);
  });

  it('rounds to the digits of a step', () => {
    assert.equal(roundTo(0.123456, 0.005), 0.1235);
    assert.equal(roundTo(1234.56, 100), 1235);
  });
});

describe('Histogram', () => {
  const histogram = new Histogram({ edges: [0, 1, 2, 3, 4], counts: [96, 2, 1, 1] });

  it('keeps open ends at the outside', () => {
    assert.equal(histogram.fractionOf(null, 1), 1);
    assert.equal(histogram.valueAt(1.2), null);
    assert.equal(histogram.valueAt(0.5), 2);
    assert.equal(histogram.fractionOf(3, 0), 0.75);
  });

  it('counts the share of the samples, bins in proportion', () => {
    assert.equal(histogram.share({ low: 2, high: null }), 0.02);
    assert.equal(histogram.share({ low: null, high: 0.5 }), 0.48);
  });

  it('begins with the brightest samples', () => {
    assert.deepEqual(histogram.brightest(0.02), { low: 2, high: null });
  });

  it('has a place for a survey of one value', () => {
    const flat = new Histogram({ edges: [5, 5], counts: [7] });
    assert.equal(flat.fractionOf(5, 0), 0.5);
    assert.equal(flat.share({ low: 5, high: 5 }), 1);
  });
});

describe('extraction state', () => {
  const entry = (level) => ({ level, components: 1, genus: 2, manifold: true });

  it('keeps levels coarsest first, the newest entry of each', () => {
    let state = levelKnown(levelKnown(started(), entry(1)), entry(2));
    state = levelKnown(state, { ...entry(1), genus: 3 });
    assert.deepEqual(state.levels.map(({ level, genus }) => [level, genus]), [[2, 2], [1, 3]]);
  });

  it('ends with the manifest, whatever comes late', () => {
    const done = manifestCame(started(), { levels: [entry(0), entry(1)], empty: false });
    assert.equal(progressed(done, { stage: 'encode', progress: 0.5 }), done);
    assert.equal(levelKnown(done, entry(5)), done);
    assert.equal(sentenceOf(levelCame(done, 0)), 'Done: 1 surface, 2 tunnels.');
  });

  it('shows the finest level, or the one that somebody chose', () => {
    const two = levelCame(levelCame(started(), 4), 3);
    assert.equal(two.shown, 3);
    assert.equal(levelChosen(two, 1), two);
    const coarse = levelChosen(two, 4);
    assert.deepEqual([coarse.shown, levelCame(coarse, 2).shown], [4, 4]);
    assert.equal(levelCame(levelChosen(levelCame(coarse, 2), 2), 1).shown, 1);
  });

  it('says that a preview is one', () => {
    assert.equal(describePreview(false), 'Preview: rough, topology not promised.');
    assert.match(describePreview(true), /^Preview: nothing/);
  });

  it('tells an empty range, a failure and the beginning', () => {
    assert.match(sentenceOf(manifestCame(started(), { levels: [], empty: true })), /Nothing/);
    assert.equal(sentenceOf(failed(started(), 'no space')), 'no space');
    assert.match(sentenceOf(idle), /Choose/);
  });

  it('keeps the fraction in bounds', () => {
    assert.equal(progressed(started(), { stage: 'load', progress: 7 }).progress, 1);
  });
});

describe('problemFromText', () => {
  it('says the detail and the ways to read a refused survey', () => {
    const problem = problemFromText(422, JSON.stringify({
      detail: 'no grid', code: 'malformed_input', candidates: [{ dims: [2, 3, 4], inline_byte: 9, crossline_byte: 21 }],
    }));
    assert.equal(problem.message, 'No grid.');
    assert.equal(problem.status, 422);
  });

  it('asks which way of several is right, and offers each once', () => {
    const candidates = [
      { dims: [2, 3, 1000], inline_byte: 9, crossline_byte: 21, missing_traces: 0 },
      { dims: [2, 4, 1000], inline_byte: 189, crossline_byte: 193, missing_traces: 2 },
    ];
    const problem = problemFromText(422, JSON.stringify({ detail: 'several: 9/21, 189/193; name one by inline_byte', candidates }));
    assert.match(problem.message, /\. Which trace header bytes .*\?$/);
    assert.doesNotMatch(problem.message, /189/);
    assert.deepEqual(problem.candidates.map(describeCandidate), [
      'Inlines at byte 9, crosslines at 21: 2 × 3 × 1\u202f000', 'Inlines at byte 189, crosslines at 193: 2 × 4 × 1\u202f000, 2 traces missing',
    ]);
  });

  it('ends what the server says before it goes on', () => {
    assert.equal(problemFromText(404, JSON.stringify({ detail: 'there is no volume 12', code: 'not_found' })).message,
      'There is no volume 12. It may have been deleted meanwhile.');
  });

  it('survives what is not a problem document', () => {
    assert.match(problemFromText(502, '<html>').message, /502/);
    assert.match(problemFromText(500, 'null').message, /500/);
  });
});

describe('GeosisApi.stream', () => {
  const collect = async (chunks, type = 'multipart/mixed; boundary=b') => {
    const body = new ReadableStream({ start: (controller) => chunks(controller, new TextEncoder()) });
    const api = new GeosisApi('', async () => new Response(body, { headers: { 'Content-Type': type } }));
    const items = [];
    for await (const item of api.stream('id')) items.push(item);
    return items;
  };

  it('gives the parts and the manifest', async () => {
    const items = await collect((stream, encoder) => {
      stream.enqueue(encoder.encode('--b\r\nX-Geosis-Level: 2\r\nX-Geosis-Part: 1\r\nX-Geosis-Parts: 3\r\n\r\nmesh'));
      stream.enqueue(encoder.encode('\r\n--b\r\nContent-Type: application/json\r\n\r\n{"levels":[]}\r\n--b--'));
      stream.close();
    });
    assert.deepEqual(items.map(({ bytes, ...rest }) => rest), [
      { kind: 'part', level: 2, part: 1, count: 3 },
      { kind: 'manifest', manifest: { levels: [] } },
    ]);
  });

  it('says that it was cut short, whether it ends or breaks', async () => {
    await assert.rejects(collect((stream) => stream.close()), /cut short/);
    await assert.rejects(collect((stream) => stream.error(new TypeError('terminated'))), /cut short/);
  });

  it('refuses an answer that is not multipart', async () => {
    await assert.rejects(collect((stream) => stream.close(), 'text/plain'), /not multipart/);
  });
});

describe('GeosisApi.uploadUrl', () => {
  it('has the name, and the options that somebody chose', () => {
    const { searchParams } = new URL(new GeosisApi('http://host').uploadUrl('a & b.sgy', { inline_byte: 9, crossline_byte: 21 }));
    assert.deepEqual([...searchParams], [['format', 'auto'], ['name', 'a & b.sgy'], ['inline_byte', '9'], ['crossline_byte', '21']]);
  });
});

describe('the table of levels', () => {
  const level = {
    triangles: 7812, components: 222, euler: -330, genus: 1057, bytes: 18271, distance: { mean_voxels: 0.113, max_voxels: 25.814 }, dropped_components: 109,
  };

  it('has no distance before it is measured', () => {
    assert.deepEqual(levelCells(level, true), ['7\u202f812', '222', '−330', '1\u202f057', '18.3 kB', '0.11 / 25.81']);
    assert.equal(levelCells({ ...level, distance: null, genus: null }, false).at(-1), '…');
  });

  it('says what is left out, and that the distance has it', () => {
    assert.equal(describeDropped(level), '109 specks left out; the distance includes them');
    assert.equal(describeDropped({ dropped_components: 1 }), '1 speck left out; the distance includes it');
    assert.equal(describeDropped({ dropped_components: 0 }), '');
  });
});

describe('surveys', () => {
  it('are listed by name, and told apart where they share one', () => {
    const id = (letter) => letter.repeat(64);
    const choices = surveyChoices([
      { id: id('a'), name: 'Line 10' }, { id: id('b'), name: 'line 9' }, { id: id('c'), name: 'line 9' }, { id: id('d'), name: null },
    ]);
    assert.deepEqual(choices.map(({ text }) => text), ['dddddddddddd', 'line 9 (bbbbbb)', 'line 9 (cccccc)', 'Line 10']);
    assert.equal(choices[1].id, id('b'));
  });

  it('are told in a line', () => {
    assert.equal(describeSurvey({ dims: [23, 18, 1075], missing: { traces: 1 } }), '23 inlines × 18 crosslines × 1\u202f075 samples, 1 trace missing');
    assert.equal(describeSurvey({ dims: [2, 3, 4], missing: { traces: 0 } }), '2 inlines × 3 crosslines × 4 samples');
    assert.equal(fileNameOf({ id: 'f', name: 'north sea.2.sgy' }), 'north sea.2');
  });

  it('have their warnings in plain words', () => {
    const [plain, other] = warningsOf({ warnings: [
      { code: 'no_coordinates', detail: 'bytes 181 and 185 are zero; x and y are the inline and crossline numbers' },
      { code: 'dead_traces', detail: '12 traces are marked dead (2 at byte 29): taken as missing' },
    ] });
    assert.match(plain.text, /no coordinates/);
    assert.match(plain.detail, /^Bytes 181 .*numbers\.$/);
    assert.equal(other.text, '12 traces are marked dead (2 at byte 29): taken as missing.');
    assert.deepEqual(warningsOf({}), []);
  });
});

describe('format', () => {
  it('makes sentences of what a server says', () => {
    assert.equal(asSentence('the queue is full '), 'The queue is full.');
    assert.equal(asSentence('inline_byte: 300, at most 240'), 'inline_byte: 300, at most 240.');
    assert.equal(asSentence('SEG-Y: cut short!'), 'SEG-Y: cut short!');
    assert.equal(formatWhole(-1234), '−1\u202f234');
  });

  it('writes numbers for people', () => {
    assert.equal(formatCount(31970), '31\u202f970');
    assert.equal(formatBytes(999), '999 B');
    assert.equal(formatBytes(41030), '41.0 kB');
    assert.equal(formatDistance(null), '…');
    assert.equal(formatDistance(0.0279), '0.028');
    assert.equal(formatShare(0.0312), '3.1 %');
    assert.equal(formatShare(1e-6), 'under 0.01 %');
  });
});
