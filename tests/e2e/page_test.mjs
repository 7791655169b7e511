// The page in Chromium against a running server (GEOSIS_URL) that holds a sample survey. GEOSIS = the built binary, for a
// second survey; GEOSIS_SCREENSHOTS = folder for pictures.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdirSync, mkdtempSync, readFileSync, rmSync } from 'node:fs';
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

const levelRows = () => page.locator('#levels tbody tr');
const triangles = async () => (await levelRows().last().locator('td').nth(1).textContent()).replace(/\D/g, '');

const waitUntilDone = () => waitUntilPageDone(page);
const bodyShare = () => shareOfPixels(page, isWarm);

async function screenshot(name) {
  await page.screenshot({ path: join(GEOSIS_SCREENSHOTS, `${name}.png`) });
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
    assert.match(await page.textContent('#status'), /^Done: \d+ pieces?/);
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
    await reconstructBy(page, () => page.mouse.up());
    assert.equal(await levelRows().count(), LEVELS);
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

  it('saves the finest level as a file', async () => {
    const [download] = await Promise.all([page.waitForEvent('download', { timeout: PATIENCE_MS }), page.click('#save button[value="glb"]')]);
    assert.equal(download.suggestedFilename(), 'sample.glb');
    assert.equal(readFileSync(await download.path()).subarray(0, 4).toString(), 'glTF');
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

  it('tells kindly why a file is refused', async () => {
    await page.setInputFiles('#file', { name: 'notes.txt', mimeType: 'text/plain', buffer: Buffer.from('not a survey') });
    await page.locator('#survey-problem').waitFor({ state: 'visible', timeout: PATIENCE_MS });
    assert.ok((await page.textContent('#survey-problem')).length > 10);
    assert.equal(await levelRows().count(), LEVELS);
  });
});
