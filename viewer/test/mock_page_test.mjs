// The page in Chromium against the mock service: needs the built page and binary (environment variable GEOSIS).
import assert from 'node:assert/strict';
import { after, afterEach, before, beforeEach, describe, it } from 'node:test';

import {
  colourBy, hasBrowser, isBlue, isWarm, launchBrowser, openPage, pixelsWhere, reconstructBy, shareChangedBy, shareOfPixels,
  waitUntilDone,
} from './browser.mjs';
import { startMock, synthesize } from './mock_server.mjs';

const GEOSIS = process.env.GEOSIS;
const SPECKLED = 'range=0.42,inf'; // a big body and hundreds of specks

describe('the page on the mock', { skip: GEOSIS && hasBrowser ? false : 'needs GEOSIS and Chromium' }, () => {
  let service;
  let volume;
  let browser;
  let page;

  const rows = () => page.locator('#bodies tbody tr');
  const pressed = () => page.locator('#bodies button[aria-pressed="true"]').allTextContents();

  before(async () => {
    service = await startMock({ geosis: GEOSIS });
    const dims = ['--dims', '48,56,64'];
    const whole = await synthesize(GEOSIS, ...dims, '--missing', 'none');
    volume = await service.mock.addVolume('holes.sgy', await synthesize(GEOSIS, ...dims), whole);
    await service.mock.addVolume('whole.sgy', whole);
    browser = await launchBrowser();
  });
  after(async () => {
    await browser?.close();
    await service?.close();
  });

  beforeEach(async () => {
    service.mock.refusesBodies = false;
    page = await openPage(browser, `${service.url}/?volume=${volume.id}&${SPECKLED}`, { viewport: { width: 1000, height: 640 } });
    await waitUntilDone(page);
  });
  afterEach(async () => {
    const { mistakes } = page;
    await page.context().close();
    assert.deepEqual(mistakes, []);
  });

  it('fills missing traces when asked to, and remembers it', async () => {
    assert.equal(await page.inputValue('#fill'), 'none');
    assert.equal(await page.locator('#colouring label:visible').count(), 3, 'reliability is not offered where all is measured');
    const { missing, attributes } = await reconstructBy(page, () => page.selectOption('#fill', 'rbf'));
    assert.deepEqual(missing, { method: 'rbf' });
    assert.deepEqual(attributes, ['reliability', 'body']);
    await page.reload();
    await waitUntilDone(page);
    assert.equal(await page.inputValue('#fill'), 'rbf');
  });

  it('asks for a key where the server does, until it is the right one, and keeps it with the tab', async () => {
    service.mock.key = 'secret';
    try {
      await page.reload();
      await page.waitForSelector('#sign-in', { state: 'visible' });
      assert.ok(await page.isHidden('#survey-problem'));
      assert.ok(await page.isHidden('#survey'), 'it seems to be loading');
      await page.fill('#key', 'wrong');
      await page.click('#sign-in button');
      await page.getByText('the key is not known here').waitFor();
      await page.fill('#key', 'secret');
      await page.click('#sign-in button');
      await waitUntilDone(page);
      assert.ok(await page.isHidden('#sign-in'));
      assert.ok(await page.isVisible('#survey'));
      await page.reload();
      await waitUntilDone(page);
    } finally {
      service.mock.key = '';
    }
  });

  it('invites to bring the first survey, and shows nothing that needs one', async () => {
    const empty = await startMock({ geosis: GEOSIS });
    try {
      await page.goto(empty.url);
      await page.getByText('Drop a SEG-Y file here, or choose one').waitFor();
      for (const id of ['#histogram', '#levels', '#bodies', '#tools']) assert.ok(await page.isHidden(id), id);
      const bytes = await synthesize(GEOSIS, '--dims', '24,28,32');
      await page.setInputFiles('#file', { name: 'first.sgy', mimeType: 'application/octet-stream', buffer: bytes });
      await waitUntilDone(page);
      assert.ok(await page.isHidden('#nothing-yet'));
      assert.ok(await page.isVisible('#histogram'));
    } finally {
      await page.goto('about:blank');
      await empty.close();
    }
  });

  it('does not offer to fill a survey without holes', async () => {
    assert.ok(await page.isVisible('#fill'));
    const { missing } = await reconstructBy(page, () => page.selectOption('#survey', { label: 'whole.sgy' }));
    assert.ok(await page.isHidden('#fill'));
    assert.deepEqual(missing, { method: 'none' });
  });

  it('colours bodies, and what was filled in', async () => {
    assert.equal(await shareOfPixels(page, isBlue), 0);
    const warm = await shareOfPixels(page, isWarm);
    await colourBy(page, 'bodies');
    assert.ok((await shareOfPixels(page, isBlue)) > 0, 'no body is blue');
    await reconstructBy(page, () => page.selectOption('#fill', 'linear'));
    await colourBy(page, 'plain');
    assert.ok((await shareOfPixels(page, isWarm)) > warm, 'the holes are not filled');
    const changed = await shareChangedBy(page, () => colourBy(page, 'reliability'));
    assert.ok(changed > 1e-3 && changed < 0.5 * warm, `of ${warm}, ${changed} changed`);
    assert.ok(await page.isVisible('#legend'));
    await page.reload();
    await waitUntilDone(page);
    assert.ok(await page.isChecked('#colouring input[value="reliability"]'));
  });

  it('lists the largest bodies and counts the others', async () => {
    assert.equal(await rows().count(), 50);
    assert.match(await page.textContent('#bodies-smaller'), /^and \d+ smaller ones$/);
    const volumes = (await rows().locator('td:nth-child(2)').allTextContents()).map((text) => Number(text.replace(/[^\d.]/g, '')));
    assert.deepEqual(volumes, [...volumes].sort((a, b) => b - a));
    assert.ok(volumes.at(-1) > 0);
  });

  it('singles out the body of a row, by pointer and by keyboard', async () => {
    const all = await shareOfPixels(page, isWarm);
    await rows().nth(1).click();
    assert.deepEqual(await pressed(), ['1']);
    assert.match(await page.textContent('#selection'), /^Body 1: /);
    assert.ok((await shareOfPixels(page, isWarm)) < 0.2 * all, 'the others are not dimmed');
    await page.focus('#bodies tbody tr:nth-child(2) button');
    await page.keyboard.press('ArrowUp');
    await page.keyboard.press('Enter');
    assert.deepEqual(await pressed(), ['0']);
    assert.equal(await page.evaluate(() => document.activeElement.textContent), '0');
    assert.ok((await shareOfPixels(page, isWarm)) > 0.8 * all);
    await page.keyboard.press('Space');
    assert.deepEqual(await pressed(), []);
    assert.ok(await page.isHidden('#selection'));
  });

  it('chooses the row of the body that is clicked in the view', async () => {
    const { middle } = await pixelsWhere(page, isWarm);
    await page.click('#view', { position: middle });
    assert.deepEqual(await pressed(), ['0']);
    await page.keyboard.press('Escape');
    assert.deepEqual(await pressed(), []);
  });

  it('goes near the body that is singled out', async () => {
    await rows().nth(1).click();
    await colourBy(page, 'bodies');
    const before = await shareOfPixels(page, isBlue);
    await page.click('#zoom-to');
    assert.ok((await shareOfPixels(page, isBlue)) > 3 * before);
    await page.click('#release');
    assert.deepEqual(await pressed(), []);
  });

  it('drops specks, and says when nothing is left', async () => {
    const type = (text) => async () => {
      await page.fill('#specks', text);
      await page.press('#specks', 'Enter');
    };
    const { bodies } = await reconstructBy(page, type('100'));
    assert.deepEqual(bodies, { min_voxels: 100 });
    assert.equal(await rows().count(), 1);
    assert.match(page.url(), /min_voxels=100/);
    await page.fill('#specks', 'few');
    assert.ok(await page.isDisabled('#reconstruct'));
    await type('1000000')();
    await page.getByText('No body in this range is that large.').waitFor();
    assert.equal(await rows().count(), 0);
  });

  it('keeps the surface when the bodies are not to be had', async () => {
    service.mock.refusesBodies = true;
    await reconstructBy(page, () => page.click('#reconstruct'));
    assert.match(await page.textContent('#bodies-note'), /being counted/);
    assert.match(await page.textContent('#status'), /^Done/);
    assert.equal(await rows().count(), 0);
    assert.ok((await shareOfPixels(page, isWarm)) > 0.005);
  });
});
