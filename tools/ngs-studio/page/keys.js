// Keys: one table for both the actions and the help list. Keys shared with SuperSplat have the same meaning.
const kTurn = 0.06;    // radians per arrow key step
const kZoom = 0.88;    // factor of the distance per step
const kNudge = 10;     // CSS pixels per arrow key step of the brush
const kFlight = 0.3;   // distances to the target per second

// `does` holds the actions.
export function keyTable(does) {
  const turn = (across, along) => () => does.arrow([across * kTurn, along * kTurn], [across * kNudge, -along * kNudge]);
  return [
    { group: 'Tools' },
    { keys: ['Escape'], shown: 'Esc', help: 'look around', run: () => does.tool('look') },
    { keys: ['b'], shown: 'B', help: 'paint the object', run: () => does.tool('object') },
    { keys: ['x'], shown: 'X', help: 'paint background', run: () => does.tool('background') },
    { keys: ['l'], shown: 'L R O', help: 'by hand: lasso, box, ball', run: () => does.tool('lasso') },
    { keys: ['r'], run: () => does.tool('box') },
    { keys: ['o'], run: () => does.tool('ball') },
    { shown: 'Shift / Ctrl', help: 'while painting: object / background; by hand: add / take' },
    { keys: ['i'], shown: 'I', help: 'invert the selection', run: () => does.edit('invert') },
    { keys: ['h'], shown: 'H', help: 'hide the object', run: () => does.hide() },
    { keys: ['['], shown: '[ ]', help: 'brush size', run: () => does.radius(1 / 1.2) },
    { keys: [']'], run: () => does.radius(1.2) },
    { keys: ['Enter'], shown: 'Enter', help: 'paint a dot at the brush', run: () => does.mark() },
    { keys: ['z'], ctrl: true, shown: 'Ctrl Z', help: 'undo', run: () => does.undo() },
    { keys: ['z'], ctrl: true, shift: true, shown: 'Ctrl Shift Z', help: 'redo', run: () => does.redo() },
    { keys: ['y'], ctrl: true, run: () => does.redo() },
    { group: 'Camera' },
    { shown: 'drag', help: 'orbit; with a brush: hold Alt or use the middle button' },
    { shown: 'right drag', help: 'pan; also two fingers' },
    { shown: 'wheel, pinch', help: 'zoom' },
    { keys: ['ArrowLeft'], shown: 'arrows', help: 'orbit; with a brush: move the brush', run: turn(-1, 0) },
    { keys: ['ArrowRight'], run: turn(1, 0) },
    { keys: ['ArrowUp'], run: turn(0, 1) },
    { keys: ['ArrowDown'], run: turn(0, -1) },
    { shown: 'W A S D Q E', help: 'fly, faster with Shift; dragging then looks around' },
    { keys: ['v'], shown: 'V', help: 'switch between fly and orbit', run: () => does.fly() },
    { keys: ['+', '='], shown: '+ −', help: 'zoom', run: () => does.zoom(kZoom) },
    { keys: ['-'], run: () => does.zoom(1 / kZoom) },
    { keys: ['f'], shown: 'F', help: 'go to the selection; without one, show everything', run: () => does.fit() },
    { keys: ['c'], shown: 'C', help: 'back to the first view', run: () => does.start() },
    { keys: [','], shown: ', .', help: 'previous view, next view', run: () => does.view(-1) },
    { keys: ['.'], run: () => does.view(1) },
    { group: 'Display' },
    { keys: [' '], shown: 'Space', help: 'selection and outline', run: () => does.highlight() },
    { keys: ['1'], shown: '1 2 3', help: 'object, both, background', run: () => does.fade(0) },
    { keys: ['2'], run: () => does.fade(0.5) },
    { keys: ['3'], run: () => does.fade(1) },
    { keys: ['g'], shown: 'G', help: 'splats on the edge', run: () => does.boundary() },
    { keys: ['p'], shown: 'P', help: 'panel', run: () => does.panel() },
    { keys: ['?'], shown: '?', help: 'this list', run: () => does.help() },
  ];
}

const takesText = (element) => element.matches?.('input:not([type=range], [type=checkbox], [type=radio]), select');
const usesKey = (element, key) => element.matches?.('input, button, select, summary, [role=radio]') &&
  (key === ' ' || key === 'Enter' || key.startsWith('Arrow'));

// Runs the action of a key, except for keys that the focused element needs.
export function listenToKeys(table, flight) {
  const pressed = new Set();
  addEventListener('keydown', (event) => {
    const key = event.key.length === 1 ? event.key.toLowerCase() : event.key, ctrl = event.ctrlKey || event.metaKey;
    if (takesText(event.target) || usesKey(event.target, key) || document.querySelector('dialog[open]')) return;
    if (!ctrl && !event.altKey && 'wasdqe'.includes(key)) return startFlight(pressed, key, event, flight);
    const row = table.find(({ keys, ctrl: wanted, shift }) =>
      keys?.includes(key) && Boolean(wanted) === ctrl && (!ctrl || Boolean(shift) === event.shiftKey));
    if (!row || event.altKey) return;
    event.preventDefault();
    row.run(event);
  });
  addEventListener('keyup', (event) => pressed.delete(event.key.toLowerCase()));
  addEventListener('blur', () => pressed.clear());
}

// Flies while a key is held; `flight(ahead, right, up)` in distances to the target.
function startFlight(pressed, key, event, flight) {
  const flying = pressed.size > 0;
  pressed.add(key);
  pressed.fast = event.shiftKey;
  if (flying) return;
  let before = performance.now();
  const step = (now) => {
    if (pressed.size === 0) return;
    const way = (kFlight * (pressed.fast ? 4 : 1) * Math.min(100, now - before)) / 1000;
    before = now;
    const sign = (plus, minus) => (pressed.has(plus) - pressed.has(minus)) * way;
    flight(sign('w', 's'), sign('d', 'a'), sign('e', 'q'));
    requestAnimationFrame(step);
  };
  requestAnimationFrame(step);
}

export function listKeys(table, list) {
  for (const { group, shown, help } of table) {
    if (group) list.append(element('dt', group, 'group'));
    else if (shown) list.append(element('dt', shown), element('dd', help));
  }
}

function element(name, text, className = '') {
  return Object.assign(document.createElement(name), { textContent: text, className });
}
