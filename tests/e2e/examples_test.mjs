// The page of api/examples in Chromium: node with_server.mjs examples_test.mjs, GEOSIS_TEST_PAGE = api/examples.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

import { hasBrowser, launchBrowser, openPage } from '../../viewer/test/browser.mjs';

if (!hasBrowser) throw new Error('there is no browser');
const folder = mkdtempSync(join(tmpdir(), 'geosis-example-'));
const survey = join(folder, 'survey.sgy');
execFileSync(process.env.GEOSIS, ['synth', survey, '--dims', '48,56,64']);
const browser = await launchBrowser();
try {
  const page = await openPage(browser, `${process.env.GEOSIS_URL}/levels.html`);
  await page.setInputFiles('#file', survey);
  await page.click('#go');
  await page.waitForFunction(() => /done|:/.test(document.querySelector('#state').textContent), undefined, { timeout: 60_000 });
  assert.equal(await page.textContent('#state'), 'done');
  const names = await page.locator('#levels a').evaluateAll((links) => links.map((link) => link.download));
  assert.deepEqual(names, [4, 3, 2, 1, 0].map((level) => `level${level}.glb`));
  const download = page.waitForEvent('download');
  await page.locator('#levels a').first().click();
  const bytes = readFileSync(await (await download).path());
  assert.equal(bytes.toString('latin1', 0, 4), 'glTF');
  assert.deepEqual(page.mistakes, []);
} finally {
  await browser.close();
  rmSync(folder, { recursive: true });
}
