// Converts the cameras of scene.json for another renderer: `node cameras.mjs scene.json VIEWS OUT_PREFIX`.
// Writes PREFIX.scene.json with the first VIEWS views, principal points centred and the reference low-pass filter (0.3 px^2),
// and PREFIX.track.json, the same cameras for splat-transform. That program rotates a PLY by 180 degrees about z, so x and y of
// every vector change sign; it has no principal point.
import fs from 'node:fs';
import path from 'node:path';

const [scenePath, views, prefix] = process.argv.slice(2);
const scene = JSON.parse(fs.readFileSync(scenePath, 'utf8'));
const from = path.dirname(path.resolve(scenePath)), to = path.dirname(path.resolve(prefix));
const moved = (file) => path.relative(to, path.resolve(from, file));

scene.filter_px2 = 0.3;
scene.model = moved(scene.model);
scene.views = scene.views.slice(0, Number(views));
const frames = scene.views.map((view) => {
  view.cx = view.width / 2;
  view.cy = view.height / 2;
  view.image = moved(view.image);
  if (view.mask) view.mask = moved(view.mask);
  const r = view.rotation, t = view.translation;
  const column = (k) => [r[k], r[3 + k], r[6 + k]];
  const centre = [0, 1, 2].map((k) => -column(k).reduce((sum, x, i) => sum + x * t[i], 0));
  const forward = r.slice(6, 9), down = r.slice(3, 6);
  const turned = ([x, y, z]) => [-x, -y, z];
  return {
    position: turned(centre),
    target: turned(centre.map((x, k) => x + forward[k])),
    up: turned(down.map((x) => -x)),
    fov: (360 / Math.PI) * Math.atan(view.height / 2 / view.fy),
  };
});
fs.writeFileSync(prefix + '.scene.json', JSON.stringify(scene));
fs.writeFileSync(prefix + '.track.json', JSON.stringify({ frameRate: 1, frames }));
