// Strokes drawn over the picture until a frame from the server shows their result, and the ring of the brush.
const kSpacing = 2;      // CSS pixels between two points of a stroke
const kRing = 1.5;       // width of the brush's ring
const kPaint = { object: 'rgb(34 197 94 / .62)', background: 'rgb(239 68 68 / .62)' };
const kEdge = { object: 'rgb(22 163 74)', background: 'rgb(220 38 38)' };

export class Brush {
  constructor(canvas) {
    this.canvas = canvas;
    this.radius = 14;     // CSS pixels
    this.cursor = null;   // {x, y, label} in CSS pixels, or null
    this.strokes = [];    // in progress, or not yet in a frame: {label, radius, points, version}
  }

  begin(label, point) {
    this.current = { label, radius: this.radius, points: [point], version: Infinity };
    this.strokes.push(this.current);
    this.draw();
    return this.current;
  }

  extend(point) {
    const [x, y] = this.current.points.at(-1);
    if (Math.hypot(point[0] - x, point[1] - y) < kSpacing) return;
    this.current.points.push(point);
    this.draw();
  }

  // Removes strokes that a frame with this version of the labels includes.
  forget(version) {
    this.strokes = this.strokes.filter((stroke) => stroke === this.current || stroke.version > version);
    this.draw();
  }

  drop(stroke) {
    this.strokes = this.strokes.filter((other) => other !== stroke);
    this.draw();
  }

  draw() {
    const ratio = window.devicePixelRatio, { canvas } = this;
    const width = Math.round(canvas.clientWidth * ratio), height = Math.round(canvas.clientHeight * ratio);
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    const context = canvas.getContext('2d');
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, width, height);
    for (const stroke of this.strokes) drawStroke(context, stroke);
    if (this.cursor) drawRing(context, this.cursor, this.radius);
  }
}

function drawStroke(context, { label, radius, points }) {
  context.lineCap = context.lineJoin = 'round';
  context.lineWidth = 2 * radius;
  context.strokeStyle = kPaint[label];
  context.beginPath();
  context.moveTo(...points[0]);
  for (const point of points) context.lineTo(...point);
  context.stroke();
}

// Dark, light and coloured rings, visible on any picture.
function drawRing(context, { x, y, label }, radius) {
  for (const [colour, grow] of [['rgb(0 0 0 / .55)', kRing], ['#fff', 0], [kEdge[label], -kRing]]) {
    context.strokeStyle = colour;
    context.lineWidth = kRing;
    context.beginPath();
    context.arc(x, y, Math.max(1, radius + grow), 0, 2 * Math.PI);
    context.stroke();
  }
}

// A stroke in pixels of a camera, as the server expects it.
export function strokeFor({ label, radius, points }, canvas, camera) {
  const factor = camera.width / canvas.clientWidth;
  const pixel = (value) => Math.round(value * factor * 10) / 10;
  return { label, radius_px: Math.max(0.5, pixel(radius)), points: points.map(([x, y]) => [pixel(x), pixel(y)]) };
}
