// Keys: one table, which is both what they do and what the list under ? says. Those that SuperSplat has mean the same.
const kTurn = 0.06;    // radians an arrow's step
const kZoom = 0.88;    // of the distance, a step
const kNudge = 10;     // CSS pixels that an arrow moves the brush
const kFlight = 0.3;   // distances to the target a second

// `does` has the functions that are called by name here.
export function keyTable(does) {
  const turn = (across, along) => () => does.arrow([across * kTurn, along * kTurn], [across * kNudge, -along * kNudge]);
  return [
    { group: 'Tools' },
    { keys: ['Escape'], shown: 'Esc', says: 'look around', run: () => does.tool('look') },
    { keys: ['b'], shown: 'B', says: 'paint the object', run: () => does.tool('object') },
    { keys: ['x'], shown: 'X', says: 'paint background', run: () => does.tool('background') },
    { shown: 'Shift / Ctrl', says: 'while painting: object / background' },
    { keys: ['['], shown: '[ ]', says: 'size of the brush', run: () => does.radius(1 / 1.2) },
    { keys: [']'], run: () => does.radius(1.2) },
    { keys: ['Enter'], shown: 'Enter', says: 'mark where the brush is', run: () => does.mark() },
    { keys: ['z'], ctrl: true, shown: 'Ctrl Z', says: 'undo', run: () => does.undo() },
    { keys: ['z'], ctrl: true, shift: true, shown: 'Ctrl Shift Z', says: 'redo', run: () => does.redo() },
    { keys: ['y'], ctrl: true, run: () => does.redo() },
    { group: 'Camera' },
    { shown: 'drag', says: 'turn; with a brush: Alt or the middle button' },
    { shown: 'right drag', says: 'pan; so do two fingers' },
    { shown: 'wheel, pinch', says: 'zoom' },
    { keys: ['ArrowLeft'], shown: 'arrows', says: 'turn; with a brush: move it', run: turn(-1, 0) },
    { keys: ['ArrowRight'], run: turn(1, 0) },
    { keys: ['ArrowUp'], run: turn(0, 1) },
    { keys: ['ArrowDown'], run: turn(0, -1) },
    { shown: 'W A S D Q E', says: 'fly, faster with Shift; then dragging looks about' },
    { keys: ['v'], shown: 'V', says: 'fly, or turn about the object', run: () => does.fly() },
    { keys: ['+', '='], shown: '+ −', says: 'zoom', run: () => does.zoom(kZoom) },
    { keys: ['-'], run: () => does.zoom(1 / kZoom) },
    { keys: ['f'], shown: 'F', says: 'go to the selection; without one, show all', run: () => does.fit() },
    { keys: ['c'], shown: 'C', says: 'back to the start', run: () => does.start() },
    { keys: [','], shown: ', .', says: 'view before, view after', run: () => does.view(-1) },
    { keys: ['.'], run: () => does.view(1) },
    { group: 'Seen' },
    { keys: [' '], shown: 'Space', says: 'selection and outline', run: () => does.highlight() },
    { keys: ['1'], shown: '1 2 3', says: 'object, both, background', run: () => does.fade(0) },
    { keys: ['2'], run: () => does.fade(0.5) },
    { keys: ['3'], run: () => does.fade(1) },
    { keys: ['g'], shown: 'G', says: 'splats on the edge', run: () => does.boundary() },
    { keys: ['p'], shown: 'P', says: 'panel', run: () => does.panel() },
    { keys: ['?'], shown: '?', says: 'this list', run: () => does.help() },
  ];
}

const takesText = (element) => element.matches?.('input:not([type=range], [type=checkbox], [type=radio]), select');
const needsKey = (element, key) => element.matches?.('input, button, select, summary, [role=radio]') &&
  (key === ' ' || key === 'Enter' || key.startsWith('Arrow'));

// Calls what a key means; `element` loses no key that it needs itself.
export function listenToKeys(table, flight) {
  const held = new Set();
  addEventListener('keydown', (event) => {
    const key = event.key.length === 1 ? event.key.toLowerCase() : event.key, ctrl = event.ctrlKey || event.metaKey;
    if (takesText(event.target) || needsKey(event.target, key) || document.querySelector('dialog[open]')) return;
    if (!ctrl && !event.altKey && 'wasdqe'.includes(key)) return startFlight(held, key, event, flight);
    const row = table.find(({ keys, ctrl: wanted, shift }) =>
      keys?.includes(key) && Boolean(wanted) === ctrl && (!ctrl || Boolean(shift) === event.shiftKey));
    if (!row || event.altKey) return;
    event.preventDefault();
    row.run(event);
  });
  addEventListener('keyup', (event) => held.delete(event.key.toLowerCase()));
  addEventListener('blur', () => held.clear());
}

// Flies as long as a key is held; `flight(ahead, right, up)` in distances to the target.
function startFlight(held, key, event, flight) {
  const flying = held.size > 0;
  held.add(key);
  held.fast = event.shiftKey;
  if (flying) return;
  let before = performance.now();
  const step = (now) => {
    if (held.size === 0) return;
    const way = (kFlight * (held.fast ? 4 : 1) * Math.min(100, now - before)) / 1000;
    before = now;
    const sign = (plus, minus) => (held.has(plus) - held.has(minus)) * way;
    flight(sign('w', 's'), sign('d', 'a'), sign('e', 'q'));
    requestAnimationFrame(step);
  };
  requestAnimationFrame(step);
}

export function listKeys(table, list) {
  for (const { group, shown, says } of table) {
    if (group) list.append(element('dt', group, 'group'));
    else if (shown) list.append(element('dt', shown), element('dd', says));
  }
}

function element(name, text, className = '') {
  return Object.assign(document.createElement(name), { textContent: text, className });
}
