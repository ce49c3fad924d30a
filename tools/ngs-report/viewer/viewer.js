'use strict';
// Draws the records of a .splat file back to front, each as the ellipse of its projected covariance; or the mesh and its
// colliders, a .glb of ngs-mesh.
const parameters = JSON.parse(document.getElementById('parameters').textContent);
const kRowTexels = 1024;      // Gaussians per texture row, three texels each
const kNearShare = 1e-3;      // near plane as a fraction of the camera's distance
const kSteepest = 1.4;        // radians from the horizon
const canvas = document.getElementById('canvas'), message = document.getElementById('message');
const wanted = location.hash.slice(1).split(',');  // bare: without text and buttons; mesh, collider: what is shown
if (wanted.includes('bare')) document.documentElement.classList.add('bare');
const layers = document.getElementById('layer');
if (layers) layers.value = ['mesh', 'collider'].find((name) => wanted.includes(name)) ?? 'splat';

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const plus = (a, b, by = 1) => [a[0] + by * b[0], a[1] + by * b[1], a[2] + by * b[2]];
const unit = (a) => { const n = Math.hypot(...a) || 1; return [a[0] / n, a[1] / n, a[2] / n]; };
// `v` turned by `angle` about the unit vector `axis`.
function turned(v, axis, angle) {
  const c = Math.cos(angle), s = Math.sin(angle), along = dot(axis, v) * (1 - c), side = cross(axis, v);
  return [0, 1, 2].map((k) => c * v[k] + s * side[k] + along * axis[k]);
}

// ---- records -> texture

function bytesOf(id) {
  const text = atob(document.getElementById(id).textContent.trim()), bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  return bytes;
}

// Layout at texels[12 i] for record i: position, opacity; covariance xx xy xz yy; yz zz, packed colour, 0.
function decoded(bytes) {
  const count = Math.floor(bytes.length / 32), view = new DataView(bytes.buffer);
  const rows = Math.max(1, Math.ceil(count / kRowTexels));
  const texels = new Float32Array(rows * kRowTexels * 12), places = new Float32Array(3 * count);
  for (let i = 0; i < count; ++i) {
    const at = 32 * i, to = 12 * i;
    for (let k = 0; k < 3; ++k) places[3 * i + k] = texels[to + k] = view.getFloat32(at + 4 * k, true);
    const s = [12, 16, 20].map((k) => view.getFloat32(at + k, true));
    let [w, x, y, z] = [28, 29, 30, 31].map((k) => bytes[at + k] - 128);
    const n = Math.hypot(w, x, y, z) || 1;
    w /= n; x /= n; y /= n; z /= n;
    const r = [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
               [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
               [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]];
    const about = (a, b) => s[0] * s[0] * r[a][0] * r[b][0] + s[1] * s[1] * r[a][1] * r[b][1] + s[2] * s[2] * r[a][2] * r[b][2];
    texels[to + 3] = bytes[at + 27] / 255;
    texels.set([about(0, 0), about(0, 1), about(0, 2), about(1, 1), about(1, 2), about(2, 2),
                bytes[at + 24] * 65536 + bytes[at + 25] * 256 + bytes[at + 26]], to + 4);
  }
  return { count, rows, texels, places };
}

// ---- the camera, orbiting `centre`

const home = () => ({ right: parameters.right, down: parameters.down, forward: parameters.forward, eye: parameters.eye, centre: parameters.centre });
let pose = home();

function turn(dx, dy) {
  const tilt = Math.asin(Math.max(-1, Math.min(1, dot(pose.forward, parameters.up))));
  const tilted = Math.max(-kSteepest, Math.min(kSteepest, tilt - dy));  // stays off the poles
  for (const [axis, angle] of [[pose.right, tilted - tilt], [parameters.up, -dx]]) {
    for (const k of ['right', 'down', 'forward']) pose[k] = unit(turned(pose[k], axis, angle));
    pose.eye = plus(pose.centre, turned(plus(pose.eye, pose.centre, -1), axis, angle));
  }
}
function shift(dx, dy) {
  const far = Math.hypot(...plus(pose.eye, pose.centre, -1)) / focal();
  const by = plus(plus([0, 0, 0], pose.right, -dx * far), pose.down, -dy * far);
  pose.eye = plus(pose.eye, by);
  pose.centre = plus(pose.centre, by);
}
function near(factor) { pose.eye = plus(pose.centre, plus(pose.eye, pose.centre, -1), factor); }
// Focal length in CSS pixels; the first view fits into any window.
const focal = () => Math.min(canvas.clientWidth / parameters.width_px, canvas.clientHeight / parameters.height_px) * parameters.fx;

// ---- drawing

const kVertex = `#version 300 es
precision highp float; precision highp int; precision highp sampler2D;
uniform sampler2D splats; uniform mat3 turn; uniform vec3 eye; uniform vec2 size; uniform vec2 middle;
uniform float focal, filterPx2, nearest;
in vec2 corner; in uint which;
out vec2 at; out vec4 colour;
void main() {
  ivec2 texel = ivec2(3 * int(which % ${kRowTexels}u), int(which / ${kRowTexels}u));
  vec4 a = texelFetch(splats, texel, 0), b = texelFetch(splats, texel + ivec2(1, 0), 0), c = texelFetch(splats, texel + ivec2(2, 0), 0);
  vec3 p = turn * (a.xyz - eye);
  gl_Position = vec4(2., 2., 2., 1.);
  at = vec2(0.); colour = vec4(0.);
  if (p.z < nearest || a.w < 1. / 255.) return;
  mat3 s = turn * mat3(b.x, b.y, b.z, b.y, b.w, c.x, b.z, c.x, c.y) * transpose(turn);
  vec2 limit = .65 * size / focal, t = clamp(p.xy / p.z, -limit, limit);
  vec3 jx = focal / p.z * vec3(1., 0., -t.x), jy = focal / p.z * vec3(0., 1., -t.y);
  float xx = dot(jx, s * jx) + filterPx2, xy = dot(jx, s * jy), yy = dot(jy, s * jy) + filterPx2;
  float mid = .5 * (xx + yy), spread = length(vec2(.5 * (xx - yy), xy));
  float longer = mid + spread, shorter = max(mid - spread, .5 * filterPx2);
  vec2 axis = abs(xy) > 1e-6 * longer ? normalize(vec2(xy, longer - xx)) : xx >= yy ? vec2(1., 0.) : vec2(0., 1.);
  float reach = sqrt(2. * log(255. * a.w));
  at = reach * corner;
  vec2 px = focal * p.xy / p.z + middle + at.x * sqrt(longer) * axis + at.y * sqrt(shorter) * vec2(-axis.y, axis.x);
  gl_Position = vec4((2. * px / size - 1.) * vec2(1., -1.), 0., 1.);
  int rgb = int(c.z);
  colour = vec4(vec3(rgb >> 16, rgb >> 8 & 255, rgb & 255) / 255., a.w);
}`;
const kFragment = `#version 300 es
precision highp float;
in vec2 at; in vec4 colour; out vec4 painted;
void main() {
  float alpha = min(.99, colour.a * exp(-.5 * dot(at, at)));
  if (alpha < 1. / 255.) discard;
  painted = vec4(colour.rgb * alpha, alpha);
}`;

const kMeshVertex = `#version 300 es
precision highp float;
uniform mat3 turn; uniform vec3 eye; uniform vec2 size; uniform float focal, nearest, raised;
in vec3 place; in vec4 linear;
out vec3 colour;
void main() {
  vec3 p = turn * (place - eye);
  float far = 1e4 * nearest, scale = (far + nearest) / (far - nearest);
  gl_Position = vec4(2. * focal * p.xy / size * vec2(1., -1.), (scale - raised) * p.z - (scale + 1.) * nearest, p.z);
  colour = mix(12.92 * linear.rgb, 1.055 * pow(linear.rgb, vec3(1. / 2.4)) - .055, step(.0031308, linear.rgb));
}`;
const kMeshFragment = `#version 300 es
precision highp float;
in vec3 colour; out vec4 painted;
void main() { painted = vec4(colour, 1.); }`;

function program(gl, vertex, fragment) {
  const made = gl.createProgram();
  for (const [kind, source] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
    gl.attachShader(made, shader);
  }
  gl.linkProgram(made);
  if (!gl.getProgramParameter(made, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(made));
  return made;
}

// Counting sort, farthest first, with 65536 depth bins; stable within a bin.
function sorter(model) {
  const kBins = 65536, depth = new Float32Array(model.count), bin = new Uint16Array(model.count);
  const order = new Uint32Array(model.count), start = new Uint32Array(kBins + 1);
  return (forward) => {
    let least = Infinity, most = -Infinity;
    for (let i = 0; i < model.count; ++i) {
      const d = depth[i] = forward[0] * model.places[3 * i] + forward[1] * model.places[3 * i + 1] + forward[2] * model.places[3 * i + 2];
      if (d < least) least = d;
      if (d > most) most = d;
    }
    const scale = most > least ? (kBins - 1) / (most - least) : 0;
    start.fill(0);
    for (let i = 0; i < model.count; ++i) ++start[(bin[i] = kBins - 1 - Math.floor((depth[i] - least) * scale)) + 1];
    for (let k = 0; k < kBins; ++k) start[k + 1] += start[k];
    for (let i = 0; i < model.count; ++i) order[start[bin[i]]++] = i;
    return order;
  };
}

// The triangles of the mesh and the edges of its colliders, in the axes of the splat.
function meshes(gl) {
  const bytes = bytesOf('mesh'), length = new DataView(bytes.buffer).getUint32(12, true);
  const gltf = JSON.parse(new TextDecoder().decode(bytes.subarray(20, 20 + length))), turn = gltf.asset.extras.to_splat;
  const values = (number, Type, width) => {
    const { bufferView, count } = gltf.accessors[number], from = 28 + length + gltf.bufferViews[bufferView].byteOffset;
    return new Type(bytes.slice(from, from + Type.BYTES_PER_ELEMENT * width * count).buffer);
  };
  const paint = program(gl, kMeshVertex, kMeshFragment);
  const colour = gl.getAttribLocation(paint, 'linear');
  const attribute = (at, data, width, type) => {
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ARRAY_BUFFER, data, gl.STATIC_DRAW);
    gl.enableVertexAttribArray(at);
    gl.vertexAttribPointer(at, width, type, true, 0, 0);
  };
  const parts = gltf.meshes.map(({ name, primitives: [{ attributes, indices }] }, k) => {
    const places = values(attributes.POSITION, Float32Array, 3), faces = values(indices, Uint32Array, 1);
    for (let i = 0; i < places.length; i += 3) {
      const place = places.slice(i, i + 3);
      for (let row = 0; row < 3; ++row) places[i + row] = dot(turn.slice(3 * row, 3 * row + 3), place);
    }
    const solid = name === 'object', hue = (k * 0.618) % 1, array = gl.createVertexArray();
    const corners = solid ? faces : new Uint32Array(2 * faces.length);
    for (let i = 0; !solid && i < faces.length; ++i) corners.set([faces[i], faces[i % 3 < 2 ? i + 1 : i - 2]], 2 * i);
    gl.bindVertexArray(array);
    attribute(gl.getAttribLocation(paint, 'place'), places, 3, gl.FLOAT);
    if (solid && 'COLOR_0' in attributes)
      attribute(colour, values(attributes.COLOR_0, Uint16Array, 4), 4, gl.UNSIGNED_SHORT);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, corners, gl.STATIC_DRAW);
    gl.bindVertexArray(null);
    const bright = [0, 1 / 3, 2 / 3].map((at) => Math.max(0, Math.cos(2 * Math.PI * (hue - at))));
    return { array, count: corners.length, mode: solid ? gl.TRIANGLES : gl.LINES, solid, bright };
  });
  return { paint, draw: (withColliders, raised) => {
    gl.disable(gl.BLEND);
    gl.enable(gl.DEPTH_TEST);
    for (const { array, count, mode, solid, bright } of parts) {
      if (!solid && !withColliders) continue;
      gl.bindVertexArray(array);
      gl.uniform1f(raised, solid ? 0 : 2e-3);  // lines in a face of the mesh are in front of it
      gl.vertexAttrib4f(colour, ...bright, 1);
      gl.drawElements(mode, count, gl.UNSIGNED_INT, 0);
    }
    gl.bindVertexArray(null);
    gl.disable(gl.DEPTH_TEST);
    gl.enable(gl.BLEND);
  } };
}

function start() {
  const gl = canvas.getContext('webgl2', { antialias: false, premultipliedAlpha: true, preserveDrawingBuffer: true });
  if (!gl) throw new Error('This browser has no WebGL 2. Open object.ply in another viewer of Gaussian splats.');
  const model = decoded(bytesOf('splats')), sorted = sorter(model), paint = program(gl, kVertex, kFragment);
  gl.useProgram(paint);
  gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
  gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32F, 3 * kRowTexels, model.rows, 0, gl.RGBA, gl.FLOAT, model.texels);
  const attribute = (name, data) => {
    const at = gl.getAttribLocation(paint, name);
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ARRAY_BUFFER, data, gl.STATIC_DRAW);
    gl.enableVertexAttribArray(at);
    return at;
  };
  gl.vertexAttribPointer(attribute('corner', new Float32Array([-1, -1, 1, -1, -1, 1, 1, 1])), 2, gl.FLOAT, false, 0, 0);
  const which = attribute('which', new Uint32Array(model.count)), rows = gl.getParameter(gl.ARRAY_BUFFER_BINDING);
  gl.vertexAttribIPointer(which, 1, gl.UNSIGNED_INT, 0, 0);
  gl.vertexAttribDivisor(which, 1);
  gl.enable(gl.BLEND);
  gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);

  const solids = layers ? meshes(gl) : null;
  let sortedFor = [0, 0, 0];
  const draw = () => {
    const sharp = Math.min(2, devicePixelRatio || 1), f = focal() * sharp;
    canvas.width = Math.max(1, Math.round(canvas.clientWidth * sharp));
    canvas.height = Math.max(1, Math.round(canvas.clientHeight * sharp));
    const shown = layers ? layers.value : 'splat', used = shown === 'splat' ? paint : solids.paint;
    if (shown === 'splat' && dot(sortedFor, pose.forward) < 0.9999) {
      gl.bindBuffer(gl.ARRAY_BUFFER, rows);
      gl.bufferData(gl.ARRAY_BUFFER, sorted(pose.forward), gl.DYNAMIC_DRAW);
      sortedFor = pose.forward;
    }
    const { right: r, down: d, forward: w, eye } = pose;
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.useProgram(used);
    const place = (name) => gl.getUniformLocation(used, name);
    gl.uniformMatrix3fv(place('turn'), false, [r[0], d[0], w[0], r[1], d[1], w[1], r[2], d[2], w[2]]);
    gl.uniform3f(place('eye'), ...eye);
    gl.uniform2f(place('size'), canvas.width, canvas.height);
    gl.uniform2f(place('middle'), canvas.width / 2, canvas.height / 2);
    gl.uniform1f(place('focal'), f);
    gl.uniform1f(place('filterPx2'), Math.max(0.05, parameters.filter_px2 * (f / parameters.fx) ** 2));
    gl.uniform1f(place('nearest'), kNearShare * Math.hypot(...plus(eye, pose.centre, -1)));
    if (shown === 'splat') gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, model.count);
    else solids.draw(shown === 'collider', place('raised'));
    document.body.dataset.drawn = shown === 'splat' ? model.count : shown;
  };
  let waiting = false;
  return () => {
    if (waiting) return;
    waiting = true;
    requestAnimationFrame(() => { waiting = false; draw(); });
  };
}

// ---- input

function listen(redraw) {
  const pointers = new Map();
  canvas.addEventListener('pointerdown', (e) => { canvas.setPointerCapture(e.pointerId); pointers.set(e.pointerId, e); });
  for (const end of ['pointerup', 'pointercancel']) canvas.addEventListener(end, (e) => pointers.delete(e.pointerId));
  canvas.addEventListener('pointermove', (e) => {
    const before = pointers.get(e.pointerId);
    if (!before) return;
    const dx = e.clientX - before.clientX, dy = e.clientY - before.clientY;
    if (pointers.size === 2) {
      const other = [...pointers.values()].find((p) => p.pointerId !== e.pointerId);
      const gap = (p) => Math.max(1, Math.hypot(p.clientX - other.clientX, p.clientY - other.clientY));
      shift(dx / 2, dy / 2);
      near(gap(before) / gap(e));
    } else if (e.shiftKey || e.buttons & 2) shift(dx, dy);
    else turn(dx / 150, dy / 150);
    pointers.set(e.pointerId, e);
    redraw();
  });
  canvas.addEventListener('contextmenu', (e) => e.preventDefault());
  canvas.addEventListener('wheel', (e) => { e.preventDefault(); near(Math.exp(Math.max(-1, Math.min(1, e.deltaY / 500)))); redraw(); }, { passive: false });
  const keys = { ArrowLeft: () => turn(-0.1, 0), ArrowRight: () => turn(0.1, 0), ArrowUp: () => turn(0, -0.1), ArrowDown: () => turn(0, 0.1),
    '+': () => near(0.9), '=': () => near(0.9), '-': () => near(1 / 0.9), 0: () => { pose = home(); } };
  addEventListener('keydown', (e) => {
    if (!keys[e.key] || e.target === layers || e.ctrlKey || e.metaKey || e.altKey) return;
    e.preventDefault();
    keys[e.key]();
    redraw();
  });
  addEventListener('resize', redraw);
  layers?.addEventListener('change', redraw);
  document.getElementById('home').addEventListener('click', () => { pose = home(); redraw(); });
  document.getElementById('ground').addEventListener('click', () => {
    const root = document.documentElement.classList, dark = root.contains('dark') ||
      (!root.contains('light') && matchMedia('(prefers-color-scheme: dark)').matches);
    root.remove('light', 'dark');
    root.add(dark ? 'light' : 'dark');
  });
}

try {
  const redraw = start();
  listen(redraw);
  redraw();
} catch (error) {
  message.textContent = error.message;
  document.body.dataset.failed = error.message;
}
