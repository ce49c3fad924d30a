// Packs the page of ngs-studio and its module into one file: node pack.mjs PAGE_FOLDER MODULE OUT.html
import fs from 'node:fs';
import path from 'node:path';
import { gzipSync } from 'node:zlib';

const here = import.meta.dirname ?? path.dirname(new URL(import.meta.url).pathname);
const [page, module, out] = process.argv.slice(2);
const read = (folder, name) => fs.readFileSync(path.join(folder, name), 'utf8');
const packed = (bytes) => gzipSync(bytes, { level: 9 }).toString('base64');
const replaced = (text, from, to) => {
  if (!text.includes(from)) throw new Error(`index.html: no ${from}`);
  return text.replace(from, () => to);
};

// Scripts import each other by name: an import map gives each name its text.
const scripts = fs.readdirSync(page).filter((name) => name.endsWith('.js'));
const imports = Object.fromEntries(scripts.map((name) => {
  const text = read(page, name).replaceAll(/from '\.\/(\w+\.js)'/g, "from 'page/$1'");
  return [`page/${name}`, `data:text/javascript;base64,${Buffer.from(text).toString('base64')}`];
}));

// The page may load nothing, whatever it says.
const policy = "default-src 'none'; script-src 'unsafe-inline' blob: data: 'wasm-unsafe-eval'; worker-src blob:; " +
  "style-src 'unsafe-inline'; img-src blob: data:; connect-src 'none'; base-uri 'none'; form-action 'none'";
let html = read(page, 'index.html');
html = replaced(html, '  <link rel="stylesheet" href="/studio.css">\n',
  `  <style>\n${read(page, 'studio.css')}${read(here, 'open.css')}</style>\n`);
html = replaced(html, '  <script type="module" src="/studio.js"></script>\n', [
  `  <meta http-equiv="Content-Security-Policy" content="${policy}">`,
  `  <script>\n${read(here, 'carrier.js')}</script>`,
  `  <script type="importmap">${JSON.stringify({ imports })}</script>`,
  `  <script type="module">import 'page/studio.js';</script>\n`].join('\n'));
html = replaced(html, '<summary>Commands that reproduce this</summary>', '<summary>Refine with the installed studio</summary>' +
  '<p class="note">Download saves visit.jsonl too. In the folder of visit.jsonl and the splat:</p>');
html = replaced(html, '<b>Refine</b> the edge if it matters, then <b>Export</b>.', '<b>Export</b> both splats.');
const parts = { code: `${module}.js`, worker: path.join(here, 'worker.js'), thread: `${module}.worker.js`, wasm: `${module}.wasm` };
const embedded = Object.entries(parts).map(([name, file]) =>
  `<script type="text/plain" id="module-${name}">${packed(fs.readFileSync(file))}</script>\n`);
html = replaced(html, '</body>', `${read(here, 'open.html')}${embedded.join('')}</body>`);
fs.writeFileSync(out, html);
console.log(`${out}: ${(html.length / 1e6).toFixed(1)} MB`);
