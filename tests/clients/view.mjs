// Opens models in web viewers in headless Chromium and counts the Gaussians that each has loaded:
//
//   node view.mjs MODULES OUT scene.json VIEW FILE=COUNT[,SELECTED]...
//
// MODULES is the node_modules folder with the viewers; the camera is that of view VIEW. Screenshots: OUT/VIEWER-FILE.png.
// SELECTED: expected number of selected Gaussians; such a file is for SuperSplat and is opened only in its engine. One line
// per viewer and file. Exit code 1 if a count is wrong or a viewer reports an error.
import fs from 'node:fs';
import http from 'node:http';
import path from 'node:path';
import { pathToFileURL } from 'node:url';

const [modules, out, scenePath, index, ...wanted] = process.argv.slice(2);
const { chromium } = await import(pathToFileURL(path.resolve(modules, 'playwright-core/index.mjs')));
const pages = path.join(import.meta.dirname ?? path.dirname(new URL(import.meta.url).pathname), 'pages');

const types = { '.html': 'text/html', '.js': 'text/javascript', '.mjs': 'text/javascript', '.wasm': 'application/wasm' };
const models = new Map(wanted.map((entry) => {
  const [file, counts] = entry.split('='), [count, wantedSelected] = counts.split(',').map(Number);
  return [path.basename(file), { file, count, wantedSelected }];
}));
function fileOf(url) {
  if (url.startsWith('/modules/')) return path.join(modules, url.slice(9));
  if (url.startsWith('/models/')) return models.get(url.slice(8))?.file;
  return path.join(pages, url);
}
const server = http.createServer((request, response) => {
  const file = fileOf(decodeURIComponent(request.url.split('?')[0]));
  fs.readFile(file ?? '', (error, data) => {
    if (error) return response.writeHead(404).end();
    response.writeHead(200, {
      'Content-Type': types[path.extname(file)] ?? 'application/octet-stream',
      'Cross-Origin-Opener-Policy': 'same-origin',
      'Cross-Origin-Embedder-Policy': 'require-corp',
    });
    response.end(data);
  });
});
await new Promise((listening) => server.listen(0, '127.0.0.1', listening));
const root = `http://127.0.0.1:${server.address().port}`;

const view = JSON.parse(fs.readFileSync(scenePath, 'utf8')).views[index];
const row = (k) => view.rotation.slice(3 * k, 3 * k + 3);
const centre = [0, 1, 2].map((k) => -[0, 1, 2].reduce((sum, i) => sum + view.rotation[3 * i + k] * view.translation[i], 0));
const camera = JSON.stringify({
  position: centre,
  target: centre.map((x, k) => x + 3 * row(2)[k]),
  up: row(1).map((x) => -x),
  rotation: view.rotation,
  fov: (360 / Math.PI) * Math.atan(view.height / 2 / view.fy),
  focal: view.fy * (480 / view.height),
});

const browser = await chromium.launch({
  executablePath: process.env.NGS_CHROMIUM ?? '/usr/lib/chromium/chromium',
  args: ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist'],
});
let failures = 0;
for (const viewer of ['spark', 'mkkellogg', 'gsplat', 'playcanvas']) {
  for (const [name, { count, wantedSelected }] of models) {
    if (wantedSelected !== undefined && viewer !== 'playcanvas') continue;
    const page = await browser.newPage({ viewport: { width: 640, height: 480 } });
    const errors = [];
    page.on('pageerror', (error) => errors.push(String(error)));
    const begin = Date.now();
    await page.goto(`${root}/${viewer}.html?model=/models/${name}&camera=${encodeURIComponent(camera)}`);
    await page.waitForFunction('window.done', null, { timeout: 180000 }).catch(() => errors.push('not rendered within 180 s'));
    const { loaded, selected, error } = await page.evaluate('({ loaded: window.loaded, selected: window.selected, error: window.error })');
    if (error) errors.push(error);
    if (wantedSelected !== undefined && selected !== wantedSelected) errors.push(`${selected} selected, expected ${wantedSelected}`);
    await page.screenshot({ path: path.join(out, `${viewer}-${name.replace('.ply', '')}.png`), timeout: 60000 });
    await page.close();
    const good = errors.length === 0 && loaded === count;
    failures += good ? 0 : 1;
    console.log(`${good ? 'ok  ' : 'FAIL'} ${viewer} ${name}: ${loaded} of ${count} Gaussians` +
      `${selected > 0 ? `, ${selected} selected` : ''}, ${((Date.now() - begin) / 1000).toFixed(1)} s` +
      errors.map((text) => ` | ${text.slice(0, 200)}`).join(''));
  }
}
await browser.close();
server.close();
process.exit(failures ? 1 : 0);
