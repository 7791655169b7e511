/** The page in Chromium, for tests: CHROMIUM = its path. */
import { existsSync } from 'node:fs';

import { chromium } from 'playwright-core';

const CHROMIUM = process.env.CHROMIUM ?? '/usr/bin/chromium';
const PATIENCE_MS = 60_000;

const NO_OVERLAYS = 'main > :not(#view) { visibility: hidden !important; }';

export const hasBrowser = existsSync(CHROMIUM);

export function launchBrowser() {
  return chromium.launch({ executablePath: CHROMIUM, args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'] });
}

/** A page that collects the mistakes of its scripts in page.mistakes. */
export async function openPage(browser, url, options = {}) {
  const page = await browser.newPage({ viewport: { width: 1360, height: 860 }, ...options });
  page.mistakes = [];
  page.on('pageerror', (error) => page.mistakes.push(error.message));
  await page.goto(url);
  return page;
}

/** Waits until the finest level is drawn and the list of its bodies is here, or is known not to come. */
export async function waitUntilDone(page) {
  await page.waitForSelector('body[data-phase="done"]', { timeout: PATIENCE_MS });
  await page.waitForSelector('#levels tr[data-level="0"][aria-current="true"]', { timeout: PATIENCE_MS });
  await page.waitForFunction(() => !/Counting|when the last/.test(document.querySelector('#bodies-note').textContent),
    undefined, { timeout: PATIENCE_MS });
}

/** What is done makes the page reconstruct; resolves when that is done. */
export async function reconstructBy(page, action) {
  const asked = page.waitForRequest((request) => request.method() === 'POST' && /\/extractions$/.test(request.url()), { timeout: PATIENCE_MS });
  await action();
  const request = (await asked).postDataJSON();
  await page.waitForFunction(() => document.body.dataset.phase !== 'waiting', undefined, { timeout: PATIENCE_MS });
  await waitUntilDone(page);
  return request;
}

/**
 * The view's pixels that satisfy a test(red, green, blue), a function without surroundings.
 *
 * returns  {share: of all pixels, middle: {x, y} of the one in their middle}
 */
export async function pixelsWhere(page, test) {
  return page.evaluate(async ([data, source]) => {
    const satisfies = new Function(`return ${source}`)();
    const image = await createImageBitmap(await (await fetch(`data:image/png;base64,${data}`)).blob());
    const context = new OffscreenCanvas(image.width, image.height).getContext('2d');
    context.drawImage(image, 0, 0);
    const { data: pixels } = context.getImageData(0, 0, image.width, image.height);
    const found = [];
    for (let at = 0; at < pixels.length; at += 4) if (satisfies(pixels[at], pixels[at + 1], pixels[at + 2])) found.push(at / 4);
    const middle = found[Math.floor(found.length / 2)] ?? 0;
    return {
      share: found.length / (image.width * image.height),
      middle: { x: middle % image.width, y: Math.floor(middle / image.width) },
    };
  }, [await pictureOf(page), test.toString()]);
}

export async function shareOfPixels(page, test) {
  return (await pixelsWhere(page, test)).share;
}

/** Share of the view's pixels that differ clearly after an action from what they were before. */
export async function shareChangedBy(page, action) {
  const before = await pictureOf(page);
  await action();
  return page.evaluate(async (pictures) => {
    const [old, now] = await Promise.all(pictures.map(async (data) => {
      const image = await createImageBitmap(await (await fetch(`data:image/png;base64,${data}`)).blob());
      const context = new OffscreenCanvas(image.width, image.height).getContext('2d');
      context.drawImage(image, 0, 0);
      return context.getImageData(0, 0, image.width, image.height).data;
    }));
    let changed = 0;
    for (let at = 0; at < old.length; at += 4) changed += [0, 1, 2].some((channel) => Math.abs(old[at + channel] - now[at + channel]) > 24);
    return changed / (old.length / 4);
  }, [before, await pictureOf(page)]);
}

/** The view without what lies over it, as PNG in base64, once it is drawn. */
async function pictureOf(page) {
  await page.evaluate(() => new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve))));
  return (await page.locator('#view').screenshot({ style: NO_OVERLAYS })).toString('base64');
}

export const isWarm = (red, green, blue) => red > blue + 40;
export const isBlue = (red, green, blue) => blue > red + 60 && blue > green + 30;

/** Chooses how the surface is coloured. */
export async function colourBy(page, name) {
  await page.locator('#colouring label', { hasText: new RegExp(`^${name}$`, 'i') }).click();
}
