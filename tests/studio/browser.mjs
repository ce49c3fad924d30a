// A headless Chromium, with mouse and touch input.
import fs from 'node:fs';
import path from 'node:path';
import { pathToFileURL } from 'node:url';

const kFlags = ['--no-sandbox', '--disable-gpu', '--disable-quic', '--no-first-run', '--disable-background-networking',
  '--disable-component-update', '--disable-sync'];
const kPatienceMs = 60_000;  // generous, for a machine under load

// Starts with an empty profile below `folder`; `errors` collects console errors and exceptions of the page.
export async function openBrowser({ modules, chromium: executablePath, folder, errors }, look) {
  const { chromium } = await import(pathToFileURL(path.resolve(modules, 'playwright-core/index.mjs')));
  const { width, height, scheme = 'light', touch = false } = look;
  const context = await chromium.launchPersistentContext(fs.mkdtempSync(path.join(folder, 'profile-')), {
    executablePath, args: kFlags, headless: true, viewport: { width, height }, colorScheme: scheme, hasTouch: touch,
    isMobile: touch, deviceScaleFactor: touch ? 2 : 1,
  });
  const page = context.pages()[0] ?? (await context.newPage());
  page.setDefaultTimeout(kPatienceMs);
  page.on('console', (message) => message.type() === 'error' && errors.push(message.text()));
  page.on('pageerror', (error) => errors.push(String(error)));
  return { page, close: () => context.close() };
}

// Waits until a still frame is shown and no request is pending.
export async function settled(page) {
  await page.waitForFunction(() => {
    const { dataset, ariaBusy } = document.getElementById('paint');
    return dataset.shown === 'still' && ariaBusy === 'false';
  });
}

// Converts a place of the picture to CSS pixels of the window: `across` in heights from the middle, `down` in heights
// from the top. It is the same place of a view for any landscape window.
export async function placeOf(page, [across, down]) {
  const box = await page.locator('#paint').boundingBox();
  return [box.x + box.width / 2 + across * box.height, box.y + down * box.height];
}

export async function drag(page, places, button = 'left') {
  const points = [];
  for (const place of places) points.push(await placeOf(page, place));
  await page.mouse.move(...points[0]);
  await page.mouse.down({ button });
  for (const point of points.slice(1)) await page.mouse.move(...point, { steps: 6 });
  await page.mouse.up({ button });
}

// Moves fingers, each along its own list of places; all lists have the same length.
export async function touch(page, fingers) {
  const session = await page.context().newCDPSession(page);
  const send = (type, touchPoints) => session.send('Input.dispatchTouchEvent', { type, touchPoints });
  for (let step = 0; step < fingers[0].length; ++step) {
    const points = [];
    for (const [id, places] of fingers.entries()) {
      const [x, y] = await placeOf(page, places[step]);
      points.push({ x, y, id });
    }
    await send(step === 0 ? 'touchStart' : 'touchMove', points);
  }
  await send('touchEnd', []);
  await session.detach();
}

// Mean colour of 3 x 3 pixels of the picture at a place, 0..255.
export async function colourAt(page, [across, down]) {
  return page.evaluate(([x, y]) => {
    const canvas = document.getElementById('picture');
    const left = Math.round(canvas.width / 2 + x * canvas.height) - 1, top = Math.round(y * canvas.height) - 1;
    const { data } = canvas.getContext('2d').getImageData(left, top, 3, 3);
    return [0, 1, 2].map((c) => data.filter((_, k) => k % 4 === c).reduce((sum, v) => sum + v, 0) / 9);
  }, [across, down]);
}

export const difference = (a, b) => Math.max(...a.map((x, k) => Math.abs(x - b[k])));
