// Strokes drawn over the picture until a frame from the server shows their result, and the ring of the brush.
const kSpacing = 2;      // CSS pixels between two points of a stroke
const kRing = 1.5;       // width of the brush's ring
const kPaint = { object: 'rgb(34 197 94 / .62)', background: 'rgb(239 68 68 / .62)' };
const kFill = { object: 'rgb(34 197 94 / .2)', background: 'rgb(239 68 68 / .2)' };
const kEdge = { object: 'rgb(22 163 74)', background: 'rgb(220 38 38)' };

export class Brush {
  constructor(canvas) {
    this.canvas = canvas;
    this.radius = 14;     // CSS pixels
    this.cursor = null;   // {x, y, label} in CSS pixels, or null
    this.strokes = [];    // in progress, or not yet in a frame: {label, radius, points, version}
  }

  // `shape`: 'line', or 'lasso', 'box' and 'ball', which are outlines.
  begin(label, point, shape = 'line') {
    this.current = { label, shape, radius: this.radius, points: [point], version: Infinity };
    this.strokes.push(this.current);
    this.draw();
    return this.current;
  }

  extend(point) {
    const [x, y] = this.current.points.at(-1);
    if (Math.hypot(point[0] - x, point[1] - y) < kSpacing) return;
    if (['box', 'ball'].includes(this.current.shape)) this.current.points.length = 1;
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
    for (const stroke of this.strokes) (stroke.shape === 'line' ? drawStroke : drawOutline)(context, stroke);
    if (this.cursor && this.cursor.shape === 'line') drawRing(context, this.cursor, this.radius);
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

// The corners of a lasso or a box, in CSS pixels.
function cornersOf({ shape, points }) {
  if (shape === 'lasso') return points;
  const [[left, top], [right, bottom]] = [points[0], points.at(-1)];
  return [[left, top], [right, top], [right, bottom], [left, bottom]];
}

// The radius of a ball: as far as it was dragged, or that of the brush.
const ballRadius = ({ points, radius }) =>
  (points.length > 1 ? Math.hypot(points[1][0] - points[0][0], points[1][1] - points[0][1]) : radius);

function drawOutline(context, stroke) {
  context.beginPath();
  if (stroke.shape === 'ball') context.arc(...stroke.points[0], ballRadius(stroke), 0, 2 * Math.PI);
  else for (const point of cornersOf(stroke)) context.lineTo(...point);
  context.closePath();
  context.fillStyle = kFill[stroke.label];
  context.fill();
  for (const [colour, width] of [['#fff', 3.5], [kEdge[stroke.label], 1.5]]) {
    context.strokeStyle = colour;
    context.lineWidth = width;
    context.stroke();
  }
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

const pixelOf = (canvas, camera) => (value) => Math.round((value * camera.width * 10) / canvas.clientWidth) / 10;

// A stroke in pixels of a camera, as the server expects it.
export function strokeFor({ label, radius, points }, canvas, camera) {
  const pixel = pixelOf(canvas, camera);
  return { label, radius_px: Math.max(0.5, pixel(radius)), points: points.map(([x, y]) => [pixel(x), pixel(y)]) };
}

// The outline of an edit by hand, the same way; null if it contains nothing.
export function outlineFor(stroke, canvas, camera) {
  const pixel = pixelOf(canvas, camera), [x, y] = stroke.points[0].map(pixel);
  if (stroke.shape === 'ball') return { ball: { x, y, radius_px: Math.max(0.5, pixel(ballRadius(stroke))) } };
  const outline = cornersOf(stroke).map((point) => point.map(pixel));
  return stroke.points.length > 1 && outline.length > 2 ? { outline } : null;
}
