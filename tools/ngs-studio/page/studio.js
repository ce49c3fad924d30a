// The page of ngs-studio. The server holds marks, labels and files; the page holds camera, tool and display settings,
// shows the server's state and sends strokes.
import { Brush, outlineFor, strokeFor } from './brush.js';
import { Camera, length, subtract } from './camera.js';
import { Frames } from './frames.js';
import { Jobs } from './jobs.js';
import { keyTable, listKeys, listenToKeys } from './keys.js';
import { gaussiansText, number, showObjects } from './objects.js';
import { Pointer } from './pointer.js';
import { get, inTurn, post } from './server.js';

const kLook = 0.5;  // rotation of looking around, as a fraction of that of orbiting
const kRetryMs = 2000, kReadMs = 6000;
const kTools = ['look', 'object', 'background', 'lasso', 'box', 'ball'];
const kByHand = ['lasso', 'box', 'ball'];
const kDone = { refine: 'Refined', export: 'Written' };
const kRadius = { least: 2, most: 80 };
const kAxes = {
  auto: null, '+x': [1, 0, 0], '−x': [-1, 0, 0], '+y': [0, 1, 0], '−y': [0, -1, 0],
  '+z': [0, 0, 1], '−z': [0, 0, -1],
};
const find = (id) => document.getElementById(id);

const display = { fade: 0.5, boundary: false, highlight: true, all: true };  // display settings
let writes = 0;             // number of pending write requests
let flying = false;         // dragging looks around instead of orbiting the target
let tool = 'look';          // one of kTools
let state, camera, frames;  // the server's state, the page's camera and picture
const brush = new Brush(find('paint'));
const jobs = new Jobs(find, { state: showState, failed });

// ---- the server's state

function showState(next, finished) {
  const first = !state;
  state = next;
  document.title = `${state.title} – ngs-studio`;
  find('title').textContent = state.title.replace(/[._-]/g, '$&\u200b');  // may break there
  find('gaussians').textContent = gaussiansText(state.gaussians);
  find('undo').disabled = !state.undo || isBusy();
  find('redo').disabled = !state.redo || isBusy();
  find('no-objects').hidden = state.objects.length > 0;
  find('all-row').hidden = state.objects.length < 2;
  showObjects(find('objects'), state, (change) => write('/api/objects', change));
  showPieces();
  const active = state.objects.find(({ id }) => id === state.active);
  find('one-side').hidden = active?.views !== 1 || active.edits > 0 || active.refined || active.gaussians === 0;
  for (const [id, on] of [['hide', active?.hidden], ['lock', active?.locked]]) find(id).setAttribute('aria-pressed', Boolean(on));
  for (const button of find('edits').children) button.disabled = !active?.gaussians || isBusy();
  jobs.show(state);
  if (finished) say(finishedText(finished));
  if (first) begin();
  frames.refresh();
}

function finishedText({ kind, state: how, note }) {
  if (note) return 'Your selection stays as it is';
  if (how !== 'done') return { failed: 'Failed', cancelled: 'Cancelled' }[how] ?? '';
  return kind === 'refine' ? `${kDone.refine}: ${gaussiansText(gaussiansOf(state.active))}` : kDone[kind];
}

// Pieces that no stroke touches are left out, unless "All pieces" is on.
function showPieces() {
  const leftOut = state.objects.find(({ id }) => id === state.active)?.left_out ?? 0;
  find('pieces-row').hidden = !leftOut && !state.all_pieces;
  find('pieces').checked = state.all_pieces;
  find('pieces-text').textContent = state.all_pieces ? 'All pieces, touched by a stroke or not'
    : `All pieces: ${gaussiansText(leftOut)} that no stroke touches ${leftOut === 1 ? 'is' : 'are'} left out`;
}

const isBusy = () => state.job?.state === 'running';

async function write(path, body) {
  writes += 1;
  showBusy();
  try {
    const answer = await inTurn(() => post(path, body));
    showState(answer);
    return answer;
  } catch (error) {
    failed(error);
    return null;
  } finally {
    writes -= 1;
    showBusy();
  }
}

// The bar over the picture, and the busy state for screen readers.
function showBusy() {
  find('working').classList.toggle('busy', writes > 0 || frames?.drawing === 'still');
  find('paint').setAttribute('aria-busy', writes > 0 || Boolean(frames?.drawing));
}

// Another tab may have changed the state while this one was not looked at.
async function follow() {
  if (document.hidden || !frames || writes > 0) return;
  const now = await get('/api/state').catch(failed);
  if (now && now.version > state.version) showState(now);
}

// ---- the picture

function request() {
  const { fade, boundary, highlight } = display;
  const layer = boundary ? 'boundary' : fade <= 0 ? 'object' : fade >= 1 ? 'background' : 'both';
  const everyObject = display.all || state.objects.length < 2;
  return { layer, fade, object: everyObject && fade > 0 ? 0 : state.active, highlight: highlight && layer === 'both' };
}

const kFirst = 'Drawing the first picture …';

function frameShown({ version, kind, ms }) {
  if (find('status').textContent === kFirst) say('');
  brush.forget(version);
  if (find('trouble').dataset.gone) hideTrouble();
  if (version > state.version) inTurn(() => get('/api/state')).then(showState, failed);  // another page changed the state
  find('paint').dataset.shown = kind;
  find('status').title = `${Math.round(ms)} ms`;
}

function begin() {
  say(kFirst);
  camera = new Camera(state.start, state.bounds);
  frames = new Frames(find('picture'), camera, request, {
    shown: frameShown, failed, busy: showBusy,
  });
  const views = ['first view', ...state.views.map(({ name }) => name)];
  find('views').replaceChildren(...views.map((name, k) => new Option(name, k)));
  find('upwards').replaceChildren(...Object.keys(kAxes).map((name) => new Option(name)));
  new ResizeObserver(resized).observe(find('stage'));
  new Pointer(find('paint'), labelFor, pointerTasks());
  flying = startsInside();
  find('hint').hidden = Boolean(localStorage.getItem('ngs-studio-hint')) || state.undo > 0 || state.objects.some(({ strokes, edits }) => strokes + edits > 0);
}

// The first call only reports the size.
function resized() {
  brush.draw();
  if (frames.shown) frames.refresh();
}

function moved(change) {
  if (frames.frozen) return;
  change();
  frames.move();
}

// Jumps to view `index` - 1 of the scene; 0: the first camera.
function jump(index) {
  find('views').value = index;
  moved(() => camera.place(index > 0 ? state.views[index - 1].camera : state.start));
}

function jumpBy(step) {
  const count = state.views.length + 1;
  jump((Number(find('views').value) + step + count) % count);
}

function fly(on) {
  const mode = on ? 'Fly: dragging looks around. V switches back to orbit.' : 'Orbit';
  if (flying !== on) say(mode);
  flying = on;
}

// A room, viewed from inside; little of it is visible from outside.
function startsInside() {
  return length(subtract(state.start.position, state.bounds.centre)) < state.bounds.radius;
}

// Fits the selection, or the whole splat without a selection.
function fit() {
  const focus = state.objects.find(({ id }) => id === state.active)?.focus;
  if (!focus && startsInside()) return jump(0);
  fly(false);
  moved(() => camera.fit(focus ?? state.bounds));
}

// ---- strokes

function labelFor({ shiftKey, ctrlKey, metaKey }) {
  if (tool === 'look') return null;
  return ctrlKey || metaKey ? 'background' : shiftKey ? 'object' : kByHand.includes(tool) ? handLabel() : tool;
}

const handLabel = () => document.querySelector('[name=by-hand]:checked').value;
const shapeOf = (name) => (kByHand.includes(name) ? name : 'line');

function pointerTasks() {
  return {
    turn: (dx, dy) => moved(() => (flying ? camera.look(-dx * kLook, dy * kLook) : camera.orbit(dx, dy))),
    pan: (dx, dy) => moved(() => {
      const { clientWidth: width, clientHeight: height } = find('paint');
      camera.pan(dx / height, dy / height, width / height);
    }),
    zoom: (factor) => moved(() => camera.zoom(factor)),
    hover: (point, label) => {
      brush.cursor = point && label ? { x: point[0], y: point[1], label, shape: shapeOf(tool) } : null;
      brush.draw();
    },
    paint: beginStroke,
    paintMore: (point) => frames.frozen && brush.extend(point),
    paintEnd: endStroke,
    paintCancel: cancelStroke,
  };
}

// A stroke refers to the picture shown, which may lag behind the camera: reset the camera to that of the picture.
function beginStroke(label, point) {
  if (!frames.shown) return;
  if (isBusy()) return say('Wait until the job ends, or cancel it, before painting.');
  const { position, look_at, up } = frames.shown.camera;
  camera.place({ position, look_at, up, fov_y_deg: camera.fovDegrees });
  frames.freeze(true);
  brush.begin(label, point, shapeOf(tool));
  hideHint();
}

function cancelStroke() {
  const stroke = brush.current;
  brush.current = null;
  brush.drop(stroke);
  frames.freeze(false);
}

function addObject() {
  const last = Math.max(0, ...state.objects.map(({ id }) => id));
  return write('/api/objects', { add: { name: `object ${last + 1}` } });
}

// "46,737 Gaussians (−1,742)"
function countText(gaussians, change) {
  const sign = change > 0 ? '+' : '−';
  return `${gaussiansText(gaussians)} (${change === 0 ? 'no change' : sign + number(Math.abs(change))})`;
}

// Undo or redo, and the count that results.
async function step(path, what) {
  const before = gaussiansOf(state.active);
  const answered = await write(path, {});
  if (answered) say(`${what}: ${countText(gaussiansOf(state.active), gaussiansOf(state.active) - before)}`);
}

const gaussiansOf = (object) => state.objects.find(({ id }) => id === object)?.gaussians ?? 0;

async function endStroke() {
  if (!frames.frozen) return;
  const stroke = brush.current, { kind, camera: shownBy } = frames.shown;
  brush.current = null;
  frames.freeze(false);
  const of = kind === 'still' ? shownBy : frames.cameraFor('still');
  say('Updating the selection …');
  if (state.objects.length === 0) await addObject();
  if (stroke.shape !== 'line') return endOutline(stroke, of);
  const body = { object: state.active, camera: of, strokes: [strokeFor(stroke, find('paint'), of)] };
  const answered = await write('/api/strokes', body);
  if (!answered) return brush.drop(stroke);
  stroke.version = answered.version;
  const { gaussians, change, ms } = answered.answer;
  say(`${countText(gaussians, change)}, ${(ms / 1000).toFixed(2)} s`);
  frames.refresh();
}

async function endOutline(stroke, of) {
  const shape = outlineFor(stroke, find('paint'), of);
  if (shape?.outline && find('visible-only').checked) shape.visible_only = true;
  const answered = shape && await edit(stroke.label === 'object' ? 'add' : 'take', { camera: of, ...shape });
  if (!answered) return brush.drop(stroke);
  stroke.version = answered.version;
  frames.refresh();
}

// Changes the selection by hand and tells the count.
async function edit(action, shape = {}) {
  if (isBusy()) return say('Wait until the job ends, or cancel it, before you change the selection.');
  const answered = await write('/api/edit', { object: state.active, action, ...shape });
  if (answered) say(countText(answered.answer.gaussians, answered.answer.change));
  return answered;
}

// Turns "hidden" or "locked" of the active object on or off.
function toggle(flag) {
  const active = state.objects.find(({ id }) => id === state.active);
  if (active) write('/api/objects', { id: active.id, [flag]: !active[flag] });
}

// Keyboard painting: the brush starts in the middle; arrow keys move it.
function keyCursor() {
  const { clientWidth, clientHeight } = find('paint');
  return (brush.cursor ??= { x: clientWidth / 2, y: clientHeight / 2, label: tool, shape: 'line' });
}

function arrow(turn, [dx, dy]) {
  if (tool === 'look') return moved(() => (flying ? camera.look(...turn) : camera.orbit(...turn)));
  const cursor = keyCursor();
  Object.assign(cursor, { x: cursor.x + dx, y: cursor.y + dy, label: tool });
  brush.draw();
}

function mark() {
  if (tool === 'look' || tool === 'lasso' || tool === 'box') return;
  const { x, y } = keyCursor();
  beginStroke(kByHand.includes(tool) ? handLabel() : tool, [x, y]);
  endStroke();
}

// ---- tools and display

function take(next) {
  if (frames?.frozen) return cancelStroke();  // Esc while painting cancels the stroke
  tool = next;
  for (const name of kTools) find(`tool-${name}`).setAttribute('aria-pressed', name === tool);
  find('paint').dataset.tool = tool;
  find('brush-size').hidden = tool === 'look' || kByHand.includes(tool);
  find('by-hand').hidden = !kByHand.includes(tool);
  find('visible-only').disabled = tool === 'ball';
  if (tool === 'look') brush.cursor = null;
  else if (brush.cursor) Object.assign(brush.cursor, { label: tool, shape: shapeOf(tool) });
  brush.draw();
}

function setRadius(value) {
  brush.radius = Math.round(Math.min(kRadius.most, Math.max(kRadius.least, value)));
  find('radius').value = brush.radius;
  find('radius').nextElementSibling.value = `${brush.radius} px`;
  brush.draw();
}

function setDisplay(change) {
  Object.assign(display, change);
  for (const name of ['highlight', 'boundary', 'all']) find(name).checked = display[name];
  find('fade').value = display.fade;
  find('fade').disabled = display.boundary;
  for (const end of document.querySelectorAll('.end'))
    end.setAttribute('aria-pressed', Number(end.dataset.fade) === display.fade);
  frames?.refresh();
}

function togglePanel() {
  const open = document.body.classList.toggle('no-panel') === false;
  find('panel-toggle').setAttribute('aria-expanded', open);
}

// In a narrow window the panel would cover the picture.
if (matchMedia('(max-width: 699px)').matches) togglePanel();

function hideHint() {
  find('hint').hidden = true;
  localStorage.setItem('ngs-studio-hint', 'seen');
}

// ---- messages

let forgetting;
function say(text) {
  find('status').textContent = text;
  clearTimeout(forgetting);
  forgetting = setTimeout(() => { find('status').textContent = ''; }, kReadMs);
}

// Shows a StudioError, the error text of a job, or any other exception.
function failed(error) {
  if (error.object === 'stroke') return say('Nothing is there: paint on the splat. Nothing was changed.');
  const [object, found] = find('trouble').firstElementChild.children;
  object.textContent = error.object ?? 'ngs-studio';
  const expected = error.expected && `expected ${error.expected}`;
  found.textContent = [error.found ?? error.message ?? String(error), expected].filter(Boolean).join(', ');
  find('trouble').querySelector('.remedy').textContent = error.remedy ?? '';
  find('trouble').hidden = false;
  say('');
  if (error.gone) awaitServer();
}

function hideTrouble() {
  find('trouble').hidden = true;
  delete find('trouble').dataset.gone;
}

let waiting = false;
async function awaitServer() {
  find('trouble').dataset.gone = 'yes';
  if (waiting) return;
  waiting = true;
  for (;;) {
    await new Promise((resolve) => setTimeout(resolve, kRetryMs));
    try {
      showState(await get('/api/state'));
      break;
    } catch (error) {
      if (!error.gone) { failed(error); break; }
    }
  }
  waiting = false;
}

// ---- start

const keys = keyTable({
  tool: take, mark, arrow, fit, view: jumpBy, edit,
  hide: () => toggle('hidden'),
  radius: (factor) => setRadius(factor > 1 ? Math.max(brush.radius + 1, brush.radius * factor) : brush.radius * factor),
  undo: () => find('undo').click(),
  redo: () => find('redo').click(),
  zoom: (factor) => moved(() => camera.zoom(factor)),
  start: () => jump(0),
  fly: () => fly(!flying),
  highlight: () => setDisplay({ highlight: !display.highlight }),
  fade: (fade) => setDisplay({ fade, boundary: false }),
  boundary: () => setDisplay({ boundary: !display.boundary }),
  panel: togglePanel,
  help: () => find('keys').showModal(),
});

function listen() {
  const clicked = (id, work) => find(id).addEventListener('click', work);
  for (const name of kTools) clicked(`tool-${name}`, () => take(name));
  for (const target of [window, document])
    for (const name of ['focus', 'visibilitychange']) target.addEventListener(name, follow);
  clicked('undo', () => step('/api/undo', 'Undone'));
  clicked('redo', () => step('/api/redo', 'Redone'));
  find('pieces').addEventListener('change', ({ target }) => write('/api/objects', { all_pieces: target.checked }));
  for (const button of document.querySelectorAll('[data-edit]'))
    button.addEventListener('click', () => edit(button.dataset.edit));
  clicked('hide', () => toggle('hidden'));
  clicked('lock', () => toggle('locked'));
  clicked('fit', fit);
  clicked('help', () => find('keys').showModal());
  clicked('panel-toggle', togglePanel);
  clicked('hint-close', hideHint);
  clicked('trouble-close', hideTrouble);
  clicked('view-back', () => jumpBy(-1));
  clicked('view-next', () => jumpBy(1));
  clicked('object-add', addObject);
  for (const end of document.querySelectorAll('.end'))
    end.addEventListener('click', () => setDisplay({ fade: Number(end.dataset.fade), boundary: false }));
  for (const name of ['highlight', 'boundary', 'all'])
    find(name).addEventListener('change', ({ target }) => setDisplay({ [name]: target.checked }));
  find('fade').addEventListener('input', ({ target }) => setDisplay({ fade: Number(target.value) }));
  find('radius').addEventListener('input', ({ target }) => setRadius(Number(target.value)));
  find('views').addEventListener('change', ({ target }) => jump(Number(target.value)));
  find('upwards').addEventListener('change', ({ target }) => moved(() => {
    camera.turnUpright(kAxes[target.value] ?? state.bounds.up);
    if (!startsInside()) camera.fit(state.bounds);
  }));
}

listen();
listKeys(keys, find('keys-list'));
setDisplay({});
get('/api/state').then((first) => {
  showState(first);
  listenToKeys(keys, (ahead, rightwards, upwards) => moved(() => {
    fly(true);
    const { distance } = camera;
    camera.move(ahead * distance, rightwards * distance, upwards * distance);
  }));
}).catch(failed);
