// Mouse, pen and touch input on the picture. Hand tool: left and middle button orbit, right pans. Brush: left paints,
// Alt + left orbits, other buttons as with the hand. Two fingers pan and zoom; a second finger cancels a stroke that
// the first began.
const kTurn = 0.005;        // radians per CSS pixel
const kWheelZoom = 0.0012;  // ln of the distance per wheel unit
const kPinchZoom = 0.01;    // the same for a trackpad's pinch, whose units are smaller
const kLine = 20;           // wheel units per line

const middleOf = ([a, b]) => ({ x: (a.x + b.x) / 2, y: (a.y + b.y) / 2, spread: Math.hypot(a.x - b.x, a.y - b.y) });

export class Pointer {
  // `on`: turn, pan, zoom, hover(point or null), paint, paintMore, paintEnd, paintCancel; `labelFor(event)`:
  // 'object', 'background', or null for the hand tool.
  constructor(element, labelFor, on) {
    Object.assign(this, { element, labelFor, on, fingers: new Map(), task: null });
    const listen = (name, work) =>
      element.addEventListener(name, (event) => work.call(this, event), { passive: false });
    listen('pointerdown', this.down);
    listen('pointermove', this.move);
    listen('pointerup', this.up);
    listen('pointercancel', this.cancel);
    listen('pointerleave', () => this.on.hover(null));
    listen('wheel', this.wheel);
    listen('contextmenu', (event) => event.preventDefault());
  }

  at(event) {
    const box = this.element.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  }

  down(event) {
    if (event.pointerType === 'mouse' && this.task) return;
    this.element.setPointerCapture(event.pointerId);
    const [x, y] = this.at(event);
    this.fingers.set(event.pointerId, { x, y });
    if (this.fingers.size > 1) return this.beginGesture();
    this.task = this.taskOf(event);
    this.button = event.button;
    if (event.button === 1) event.preventDefault();  // no scrolling by the middle button
    if (this.task === 'paint') this.on.paint(this.labelFor(event), [x, y]);
  }

  taskOf(event) {
    const { button, shiftKey, altKey } = event;
    if (button === 2) return shiftKey ? 'turn' : altKey ? 'zoom' : 'pan';
    if (button === 1) return shiftKey ? 'pan' : 'turn';
    if (!altKey && this.labelFor(event)) return 'paint';
    return shiftKey ? 'pan' : 'turn';
  }

  beginGesture() {
    if (this.task === 'paint') this.on.paintCancel();
    this.task = 'gesture';
    this.middle = middleOf([...this.fingers.values()]);
  }

  move(event) {
    const [x, y] = this.at(event), finger = this.fingers.get(event.pointerId);
    if (event.pointerType !== 'touch') this.on.hover([x, y], this.labelFor(event));
    if (!finger) return;
    const dx = x - finger.x, dy = y - finger.y;
    Object.assign(finger, { x, y });
    if (this.task === 'turn') this.on.turn(dx * kTurn, dy * kTurn);
    else if (this.task === 'pan') this.on.pan(dx, dy);
    else if (this.task === 'zoom') this.on.zoom(Math.exp(-dy * kTurn));
    else if (this.task === 'paint') this.paint(event);
    else if (this.task === 'gesture' && this.fingers.size > 1) this.gesture();
  }

  // Includes coalesced events between two browser frames, so that quick strokes have no corners.
  paint(event) {
    for (const part of event.getCoalescedEvents?.() ?? []) this.on.paintMore(this.at(part));
    this.on.paintMore(this.at(event));
  }

  gesture() {
    const middle = middleOf([...this.fingers.values()]);
    this.on.pan(middle.x - this.middle.x, middle.y - this.middle.y);
    if (middle.spread > 0 && this.middle.spread > 0) this.on.zoom(this.middle.spread / middle.spread);
    this.middle = middle;
  }

  up(event) {
    if (!this.fingers.has(event.pointerId)) return;
    if (event.pointerType === 'mouse' && event.button !== this.button) return;
    this.fingers.delete(event.pointerId);
    if (this.task === 'paint') this.on.paintEnd();
    if (this.fingers.size === 0) this.task = null;
    else if (this.task === 'gesture') this.task = 'rest';  // the last finger of a gesture does nothing
  }

  cancel(event) {
    this.fingers.delete(event.pointerId);
    if (this.task === 'paint') this.on.paintCancel();
    if (this.fingers.size === 0) this.task = null;
  }

  wheel(event) {
    event.preventDefault();
    const unit = event.deltaMode === 1 ? kLine : 1;
    const across = event.deltaX * unit, along = event.deltaY * unit;
    if (event.shiftKey) this.on.pan(-across || -along, across ? -along : 0);
    else this.on.zoom(Math.exp((event.ctrlKey ? kPinchZoom : kWheelZoom) * along));
  }
}
