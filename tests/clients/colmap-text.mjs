// Compares scene.json with COLMAP's text model: `node colmap-text.mjs TXT_DIR scene.json BOUND`. Prints the largest difference over
// all numbers of all views (rotation as a matrix, other numbers relative above 1). Exit code 1 if it exceeds BOUND.
import fs from 'node:fs';

const [folder, scenePath, bound] = process.argv.slice(2);
const lines = (name) => fs.readFileSync(`${folder}/${name}`, 'utf8').split('\n').filter((line) => !line.startsWith('#'));
const cameras = new Map(lines('cameras.txt').filter(Boolean).map((line) => {
  const [id, model, , , ...parameters] = line.split(' ');
  const p = parameters.map(Number);
  return [id, model === 'PINHOLE' ? p : [p[0], p[0], p[1], p[2]]];
}));
const wanted = new Map();
lines('images.txt').forEach((line, i) => {  // every second line lists the points of an image
  if (i % 2 || !line) return;
  const [, w, x, y, z, tx, ty, tz, camera, ...name] = line.split(' ');
  const q = [w, x, y, z].map(Number), norm = Math.hypot(...q), [a, b, c, d] = q.map((v) => v / norm);
  wanted.set(name.join(' '), [
    1 - 2 * (c * c + d * d), 2 * (b * c - a * d), 2 * (b * d + a * c),
    2 * (b * c + a * d), 1 - 2 * (b * b + d * d), 2 * (c * d - a * b),
    2 * (b * d - a * c), 2 * (c * d + a * b), 1 - 2 * (b * b + c * c),
    ...[tx, ty, tz].map(Number), ...cameras.get(camera)]);
});
const { views } = JSON.parse(fs.readFileSync(scenePath, 'utf8'));
if (views.length !== wanted.size) throw new Error(`${views.length} views, expected ${wanted.size}`);
let worst = 0;
for (const view of views) {
  const found = [...view.rotation, ...view.translation, view.fx, view.fy, view.cx, view.cy];
  wanted.get(view.name).forEach((x, i) => { worst = Math.max(worst, Math.abs(found[i] - x) / Math.max(1, Math.abs(x))); });
}
console.log(`${worst.toExponential(1)} over ${views.length} views`);
process.exit(worst <= Number(bound) ? 0 : 1);
