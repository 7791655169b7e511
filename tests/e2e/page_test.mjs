// The page in Chromium against a running server (GEOSIS_URL) that holds a sample survey. GEOSIS = the built binary, for a
// second survey; GEOSIS_SCREENSHOTS = folder for pictures.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, beforeEach, describe, it } from 'node:test';

import {
  colourBy, isWarm, launchBrowser, openPage, reconstructBy, shareChangedBy, shareOfPixels,
  waitUntilDone as waitUntilPageDone,
} from '../../viewer/test/browser.mjs';

const { GEOSIS, GEOSIS_URL, GEOSIS_SCREENSHOTS = mkdtempSync(join(tmpdir(), 'geosis-screenshots-')) } = process.env;
const LEVELS = 5;
const PATIENCE_MS = 60_000;

let browser;
let page;

const levelRows = () => page.locator('#levels tbody tr[data-level]');
const triangles = async () => (await levelRows().last().locator('td').nth(1).textContent()).replace(/\D/g, '');

const waitUntilDone = () => waitUntilPageDone(page);
const bodyShare = () => shareOfPixels(page, isWarm);

async function screenshot(name) {
  await page.screenshot({ path: join(GEOSIS_SCREENSHOTS, `${name}.png`) });
}

/** Where the elements are that lie over the canvas, and the canvas itself: {left, top, right, bottom, name}. */
function boxesOver() {
  return page.evaluate(() => {
    const boxOf = (element) => {
      const { left, top, right, bottom } = element.getBoundingClientRect();
      return { left, top, right, bottom, name: element.id || element.textContent };
    };
    const isSeen = (element) => getComputedStyle(element).visibility === 'visible' && element.getClientRects().length > 0;
    const texts = [...document.querySelectorAll('#labels span')].filter(isSeen).map(boxOf);
    const overlays = [...document.querySelectorAll('#tools, #colouring, #selection')].filter(isSeen).map(boxOf);
    return { canvas: boxOf(document.querySelector('#view')), texts, overlays };
  });
}

/** A survey of 40 x 48 x 56 without holes, changed trace by trace: change(header, number of the trace). */
function surveyWith(folder, name, change) {
  const path = join(folder, name);
  execFileSync(GEOSIS, ['synth', path, '--dims', '40,48,56', '--missing', 'none']);
  const bytes = readFileSync(path);
  const length = 240 + 4 * 56;
  for (let trace = 0; trace < 40 * 48; ++trace) change(bytes.subarray(3600 + trace * length, 3600 + trace * length + 240), trace);
  writeFileSync(path, bytes);
  return path;
}

/** Places the nodes of the first survey on an arch; returns the ids of both. */
async function placeGrid() {
  const { volumes: [volume] } = await (await fetch(`${GEOSIS_URL}/v1/volumes`)).json();
  const { id, dims: [inlines, crosslines, samples], geometry: { transform } } = volume;
  const nodes = new Float32Array(3 * inlines * crosslines * samples);
  let at = 0;
  for (let i = 0; i < inlines; ++i) for (let j = 0; j < crosslines; ++j) for (let k = 0; k < samples; ++k) {
    const arch = -0.5 * samples * Math.sin((Math.PI * i) / inlines);
    for (const row of [0, 4, 8]) nodes[at++] = transform[row] * i + transform[row + 1] * j + transform[row + 2] * (k + arch) + transform[row + 3];
  }
  const answer = await fetch(`${GEOSIS_URL}/v1/volumes/${id}/grids?kind=nodes&dtype=float32`, { method: 'POST', body: nodes });
  assert.equal(answer.status, 201, await answer.clone().text());
  return [id, (await answer.json()).id];
}

describe('the page', () => {
  before(async () => {
    mkdirSync(GEOSIS_SCREENSHOTS, { recursive: true });
    browser = await launchBrowser();
  });
  after(() => browser?.close());

  beforeEach(async () => {
    await page?.context().close();
    page = await openPage(browser, GEOSIS_URL);
    await waitUntilDone();
  });

  it('opens the first survey and shows every level of its bright body', async () => {
    assert.equal(await levelRows().count(), LEVELS);
    assert.match(await page.textContent('#status'), /^Done: \d+ bod(y|ies)/);
    const distances = await levelRows().locator('td:last-child').allTextContents();
    assert.ok(distances.every((text) => /^[\d.]+ \/ [\d.]+$/.test(text)), distances.join());
    assert.ok((await bodyShare()) > 0.005, 'no body is drawn');
    await screenshot('opened');
    assert.deepEqual(page.mistakes, []);
  });

  it('reconstructs again when a handle is moved by keyboard or pointer', async () => {
    const first = await triangles();
    await page.focus('#low-handle');
    await page.keyboard.press('PageUp');
    await page.waitForFunction((before) => document.querySelector('#levels tbody tr:last-child td:nth-child(2)')
      ?.textContent.replace(/\D/g, '') !== before, first);
    await waitUntilDone();
    const second = await triangles();
    assert.notEqual(second, first);

    const { x, y, width, height } = await page.locator('#low-handle').boundingBox();
    await page.mouse.move(x + width / 2, y + height / 2);
    await page.mouse.down();
    await page.mouse.move(x + width / 2 + 40, y + height / 2, { steps: 4 });
    await page.mouse.up();
    await page.waitForFunction((before) => document.querySelector('#levels tbody tr:last-child td:nth-child(2)')
      ?.textContent.replace(/\D/g, '') !== before, second);
    await waitUntilDone();
    assert.deepEqual(page.mistakes, []);
  });

  it('shows a preview while a handle is dragged, and the body when it is let go', async () => {
    const isPreview = (request) => request.method() === 'POST' && /\/extractions$/.test(request.url()) && request.postDataJSON().preview === true;
    const { x, y, width, height } = await page.locator('#low-handle').boundingBox();
    await page.mouse.move(x + width / 2, y + height / 2);
    await page.mouse.down();
    const changed = await shareChangedBy(page, async () => {
      const asked = page.waitForRequest(isPreview, { timeout: PATIENCE_MS });
      const streamed = page.waitForResponse((response) => /\/stream$/.test(response.url()), { timeout: PATIENCE_MS });
      await page.mouse.move(x + width / 2 - 30, y + height / 2, { steps: 3 });
      await asked;
      await streamed;
      await page.waitForTimeout(500);
    });
    assert.ok(changed > 1e-3, `the preview does not show: ${changed}`);
    assert.equal(await page.textContent('#status'), 'Preview: rough, topology not promised.');
    assert.ok(await page.isVisible('#preview-note'));
    assert.ok(await page.isHidden('#save'), 'what was there before can be saved');
    const paleness = () => page.locator('#levels').evaluate((table) => Number(getComputedStyle(table).opacity));
    assert.ok((await paleness()) < 0.6, 'the old table looks as if it were of the preview');
    await reconstructBy(page, () => page.mouse.up());
    assert.equal(await levelRows().count(), LEVELS);
    assert.equal(await paleness(), 1);
    assert.ok(await page.isHidden('#preview-note'));
    assert.match(await page.textContent('#status'), /^Done/);
    assert.deepEqual(page.mistakes, []);
  });

  it('keeps the range in the address, so that a link shows the same body', async () => {
    await page.fill('#low', '0.6');
    await page.click('#reconstruct');
    await page.waitForURL(/range=0\.6/);
    await waitUntilDone();
    const shown = await triangles();
    await page.reload();
    await waitUntilDone();
    assert.equal(await triangles(), shown);
    assert.equal(await page.inputValue('#low'), '0.6');
  });

  it('says so when nothing lies in the range, and draws nothing', async () => {
    await page.fill('#low', '1000');
    await page.click('#reconstruct');
    await page.getByText('Nothing of the survey lies in this range.').waitFor({ timeout: PATIENCE_MS });
    assert.equal(await levelRows().count(), 0);
    assert.equal(await bodyShare(), 0);
  });

  it('lists the bodies, and singles out the one whose row is clicked', async () => {
    const row = page.locator('#bodies tbody tr').first();
    assert.match(await row.locator('td').nth(1).textContent(), /\d/);
    await colourBy(page, 'bodies');
    await row.click();
    assert.equal(await row.getByRole('button').getAttribute('aria-pressed'), 'true');
    assert.match(await page.textContent('#selection'), /^Body 0: .* samples?/);
    assert.ok((await bodyShare()) > 0.005, 'the body is not drawn');
    await screenshot('singled_out');
    await page.keyboard.press('Escape');
    assert.ok(await page.isHidden('#selection'));
    assert.deepEqual(page.mistakes, []);
  });

  it('fills missing traces, and shows where', async () => {
    const before = await triangles();
    await reconstructBy(page, () => page.selectOption('#fill', 'linear'));
    assert.notEqual(await triangles(), before);
    assert.match(page.url(), /missing=linear/);
    assert.ok((await shareChangedBy(page, () => colourBy(page, 'reliability'))) > 0, 'nothing is marked as filled in');
    assert.ok(await page.isVisible('#legend'));
    await screenshot('reliability');
    assert.deepEqual(page.mistakes, []);
  });

  it('joins samples along reflectors, says so, and shows how well traces agree', async () => {
    assert.ok(await page.isHidden('#grid-note'));
    await reconstructBy(page, () => page.selectOption('#grid', 'structural'));
    assert.match(page.url(), /grid=structural/);
    assert.match(await page.textContent('#grid-note'), /^Joined along the reflectors\./);
    assert.ok((await shareChangedBy(page, () => colourBy(page, 'agreement'))) > 0, 'agreement is not shown');
    assert.match(await page.textContent('#legend'), /traces agree/);
    await screenshot('agreement');
    await reconstructBy(page, () => page.selectOption('#grid', 'auto'));
    assert.match(await page.textContent('#grid-note'), /95 % of the dips are within/);
    assert.deepEqual(page.mistakes, []);
  });

  it('draws the body where a placed grid puts it', async () => {
    const [id, grid] = await placeGrid();
    try {
      await page.goto(`${GEOSIS_URL}?volume=${id}`);
      await waitUntilDone();
      const before = await triangles();
      await reconstructBy(page, () => page.selectOption('#grid', grid));
      assert.match(page.url(), new RegExp(`grid=${grid}`));
      assert.match(await page.textContent('#grid-note'), /^Where the grid's nodes are placed\./);
      assert.equal(await triangles(), before);
      assert.ok((await bodyShare()) > 0.005, 'no body is drawn');
      await screenshot('placed');
      assert.deepEqual(page.mistakes, []);
    } finally {
      await fetch(`${GEOSIS_URL}/v1/volumes/${id}/grids/${grid}`, { method: 'DELETE' });
    }
  });

  it('saves the level that is shown as a file, the finest at first', async () => {
    const save = async () => {
      const [download] = await Promise.all([page.waitForEvent('download', { timeout: PATIENCE_MS }), page.click('#save button[value="glb"]')]);
      const bytes = readFileSync(await download.path());
      assert.equal(bytes.subarray(0, 4).toString(), 'glTF');
      return [download.suggestedFilename(), bytes.length];
    };
    const [name, size] = await save();
    assert.equal(name, 'sample.glb');
    await page.click('#levels tr[data-level="3"]');
    const [coarseName, coarseSize] = await save();
    assert.equal(coarseName, 'sample_level3.glb');
    assert.ok(coarseSize < size / 4, `${coarseSize} bytes beside ${size}`);
  });

  it('shows the level whose row is chosen, by pointer and by keyboard', async () => {
    const shown = () => page.locator('#levels tr[aria-current="true"]').getAttribute('data-level');
    assert.ok((await shareChangedBy(page, () => page.click('#levels tr[data-level="4"]'))) > 1e-3, 'the picture is the same');
    assert.equal(await shown(), '4');
    await page.focus('#levels tr[data-level="4"] button');
    await page.keyboard.press('End');
    await page.keyboard.press('ArrowUp');
    assert.ok((await shareChangedBy(page, () => page.keyboard.press('Enter'))) > 1e-3, 'the picture is the same');
    assert.equal(await shown(), '1');
    assert.equal(await page.evaluate(() => document.activeElement.textContent), '1');
    assert.equal(await page.textContent('#save-level'), '1');
    await reconstructBy(page, () => page.click('#reconstruct'));
    assert.equal(await shown(), '0');
    assert.deepEqual(page.mistakes, []);
  });

  it('says in the rows of coarse levels what they leave out', async () => {
    await page.goto(`${GEOSIS_URL}?range=0.42,inf`);
    await waitUntilDone();
    const count = async (level) => Number(await page.textContent(`#levels tr[data-level="${level}"] td:nth-child(3)`));
    const note = await page.textContent('#levels tr[data-level="4"] + .note');
    const [, dropped] = /^(\d+) specks? left out; the distance includes/.exec(note);
    assert.equal((await count(4)) + Number(dropped), await count(0));
    assert.equal(await page.locator('#levels tr[data-level="1"] + .note').count(), 0);
  });

  it('goes nearer to the largest body, too', async () => {
    await page.locator('#bodies tbody tr').first().click();
    const before = await bodyShare();
    await page.click('#zoom-to');
    assert.ok((await bodyShare()) > 1.1 * before, 'it is as far as before');
    await screenshot('near');
  });

  it('turns times into depths by a velocity, so that bodies have volumes', async () => {
    const names = () => page.locator('#labels .axis-name').allTextContents();
    assert.equal(await page.textContent('#volume-unit'), 'voxels');
    assert.ok((await names()).includes('Time, ms'));
    const request = await reconstructBy(page, async () => {
      await page.fill('#velocity', '2500');
      await page.press('#velocity', 'Enter');
    });
    assert.equal(request.velocity, 2500);
    assert.equal(await page.textContent('#volume-unit'), 'm³');
    assert.ok((await names()).includes('Depth, m'));
    assert.match(page.url(), /velocity=2500/);
    assert.ok((await bodyShare()) > 0.005, 'no body is drawn');
    await page.fill('#velocity', 'fast');
    assert.ok(await page.isDisabled('#reconstruct'));
    assert.match(await page.textContent('#range-note'), /velocity/);
    assert.deepEqual(page.mistakes, []);
  });

  it('colours by time, and tells which colour is which', async () => {
    assert.ok((await shareChangedBy(page, () => colourBy(page, 'time'))) > 1e-3, 'the colours are the same');
    const [top, bottom] = (await page.locator('#ramp span').allTextContents()).map((text) => Number(text.replace(/\D/g, '')));
    assert.ok(top >= 1000 && top < bottom && bottom <= 1000 + 4 * 63, `${top} to ${bottom}`);
    await screenshot('time');
    assert.deepEqual(page.mistakes, []);
  });

  it('has room for everything on a tablet and on a telephone, and frames the survey anew when its room changes', async () => {
    const sizes = [['tablet', 820, 1180], ['telephone', 390, 844], ['telephone with a body', 390, 844], ['desk', 1400, 900]];
    for (const [name, width, height] of sizes) {
      await page.setViewportSize({ width, height });
      await page.waitForTimeout(300);
      const hasBody = name === 'telephone with a body';
      await page.keyboard.press('Escape');
      if (hasBody) await page.locator('#bodies tbody tr').first().click();
      const { canvas, texts, overlays } = await boxesOver();
      assert.ok(hasBody || texts.length >= 7, `${name}: ${texts.map((text) => text.name)}`);
      assert.equal(overlays.length, hasBody ? 3 : 2);
      const boxes = [...texts, ...overlays];
      for (const box of boxes) {
        const isInside = box.left >= canvas.left && box.right <= canvas.right && box.top >= canvas.top && box.bottom <= canvas.bottom;
        assert.ok(isInside, `${name}: ${box.name} is cut`);
        const over = boxes.find((other) => other !== box && box.left < other.right && other.left < box.right && box.top < other.bottom && other.top < box.bottom);
        assert.equal(over, undefined, `${name}: ${box.name} lies over ${over?.name}`);
      }
      const hidden = await page.locator('.table-frame').first().evaluate((frame) => frame.scrollWidth - frame.clientWidth);
      assert.ok(hidden <= 0, `${name}: ${hidden} pixels of the levels are hidden`);
      assert.ok((await bodyShare()) > 0.005, `${name}: no body is drawn`);
      await screenshot(name.replaceAll(' ', '_'));
    }
    assert.deepEqual(page.mistakes, []);
  });

  it('offers the other surveys when the address names one that is not there', async () => {
    await page.goto(`${GEOSIS_URL}?volume=${'0'.repeat(64)}&range=3,4&colour=bodies`);
    await page.getByText('This survey is not here any more.').waitFor({ timeout: PATIENCE_MS });
    const { searchParams } = new URL(page.url());
    assert.deepEqual([...searchParams.keys()], ['colour']);
    assert.ok(await page.isHidden('#histogram'));
    await page.selectOption('#survey', { label: 'sample.sgy' });
    await waitUntilDone();
    assert.ok(await page.isHidden('#survey-problem'));
    assert.ok(await page.isVisible('#histogram'));
  });

  it('does not ask for a range that makes no sense', async () => {
    await page.fill('#high', 'high');
    assert.ok(await page.isDisabled('#reconstruct'));
    assert.match(await page.textContent('#range-note'), /number/);
  });

  it('uploads a survey and shows its body', async () => {
    const folder = mkdtempSync(join(tmpdir(), 'geosis-e2e-'));
    try {
      const path = join(folder, 'uploaded.sgy');
      execFileSync(GEOSIS, ['synth', path, '--dims', '40,48,56', '--seed', '7']);
      await page.setInputFiles('#file', path);
      await page.waitForFunction(() => document.title.startsWith('uploaded.sgy'), undefined, { timeout: PATIENCE_MS });
      await waitUntilDone();
      assert.match(await page.textContent('#survey-line'), /40 inlines × 48 crosslines × 56 samples/);
      assert.ok((await bodyShare()) > 0.005, 'no body is drawn');
      await screenshot('uploaded');
    } finally {
      rmSync(folder, { recursive: true });
    }
  });

  it('offers a button for each way to read a survey', async () => {
    const folder = mkdtempSync(join(tmpdir(), 'geosis-e2e-'));
    try {
      const path = surveyWith(folder, 'two_ways.sgy', (header, trace) => {
        const other = (7 * trace) % (40 * 48);
        header.writeInt32BE(1 + Math.floor(other / 48), 9 - 1);
        header.writeInt32BE(1 + (other % 48), 21 - 1);
      });
      await page.setInputFiles('#file', path);
      await page.locator('#candidates button').first().waitFor({ timeout: PATIENCE_MS });
      assert.match(await page.textContent('#survey-problem'), /more than one way\. Which/);
      const labels = await page.locator('#candidates button').allTextContents();
      assert.deepEqual(labels.map((label) => /byte (\d+)/.exec(label)[1]).sort(), ['189', '9']);
      await screenshot('two_ways');
      await page.locator('#candidates button', { hasText: 'byte 9,' }).click();
      await page.waitForFunction(() => document.title.startsWith('two_ways.sgy'), undefined, { timeout: PATIENCE_MS });
      await waitUntilDone();
      assert.ok(await page.isHidden('#candidates'));
      const { volumes } = await (await fetch(`${GEOSIS_URL}/v1/volumes`)).json();
      assert.equal(volumes.find(({ name }) => name === 'two_ways.sgy').axes.inline.byte, 9);
      assert.deepEqual(page.mistakes, []);
    } finally {
      rmSync(folder, { recursive: true });
    }
  });

  it('tells in plain words what is odd in a file, and lowers what is taller than wide', async () => {
    const folder = mkdtempSync(join(tmpdir(), 'geosis-e2e-'));
    try {
      const path = surveyWith(folder, 'without_places.sgy', (header) => header.fill(0, 72, 80).fill(0, 180, 188));
      await page.setInputFiles('#file', path);
      await page.waitForFunction(() => document.title.startsWith('without_places.sgy'), undefined, { timeout: PATIENCE_MS });
      await waitUntilDone();
      assert.deepEqual(await page.locator('#warnings li').allTextContents(), ['The file has no coordinates: lengths count lines, not metres.']);
      assert.ok(await page.isHidden('#velocity'), 'lines and metres would be mixed');
      assert.equal(await page.textContent('#exaggeration-value'), '× 0.3');
      assert.ok((await bodyShare()) > 0.005, 'no body is drawn');
      await page.selectOption('#survey', { label: 'sample.sgy' });
      await waitUntilDone();
      assert.ok(await page.isHidden('#warnings'));
    } finally {
      rmSync(folder, { recursive: true });
    }
  });

  it('tells kindly why a file is refused', async () => {
    await page.setInputFiles('#file', { name: 'notes.txt', mimeType: 'text/plain', buffer: Buffer.from('not a survey') });
    await page.locator('#survey-problem').waitFor({ state: 'visible', timeout: PATIENCE_MS });
    assert.ok((await page.textContent('#survey-problem')).length > 10);
    assert.equal(await levelRows().count(), LEVELS);
  });
});
