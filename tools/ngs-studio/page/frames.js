// The picture: requests one frame at a time, small while the camera moves, large when it rests.
import { StudioError, frame } from './server.js';

const kMovingMs = 60, kStillMs = 1200;      // time budget of a frame on the server
const kMovingSizes = [320, 480, 640, 960];  // longer side of a frame in pixels
const kStillSizes = [960, 1280, 1920];
const kNews = 0.4;      // weight of the latest time in the moving average
const kSurprise = 2;    // a time is clamped to this multiple of the average
const kTryLarger = 0.4; // share of the budget below which the next size is tried
const kNoGain = 1.3;    // sizes within this factor of the cheapest count as equally fast
const kSettleMs = 160;  // without a change, the picture counts as still

// Longer side of frames: the largest of `sizes` within `budgetMs`. If no size fits, the largest that is hardly slower
// than the fastest: for a large splat, sorting dominates at every size.
class Size {
  constructor(sizes, budgetMs, step) { Object.assign(this, { sizes, budgetMs, step, costs: sizes.map(() => null) }); }
  get pixels() { return this.sizes[this.step]; }

  learn(ms) {
    const before = this.costs[this.step] ?? ms, now = before + kNews * (Math.min(ms, kSurprise * before) - before);
    // Scale all sizes alike: another part of the splat is visible, or the load of the machine changed.
    this.costs = this.costs.map((cost) => cost && (cost * now) / before);
    this.costs[this.step] = now;
    this.step = this.choose();
  }

  choose() {
    const { costs, budgetMs } = this;
    const largest = (limit) => costs.findLastIndex((cost) => cost !== null && cost <= limit);
    const fits = largest(budgetMs), least = costs.findIndex((cost) => cost !== null);
    if (fits < 0) return least > 0 ? least - 1 : largest(kNoGain * Math.min(...costs.filter((cost) => cost !== null)));
    return costs[fits + 1] === null && costs[fits] < kTryLarger * budgetMs ? fits + 1 : fits;
  }
}

export class Frames {
  // `describe()` returns the request without camera and size; `camera` is the page's; `on` has shown(frame),
  // failed(error) and busy(), which is called when drawing begins or ends.
  constructor(canvas, camera, describe, on) {
    Object.assign(this, { canvas, camera, describe, on });
    this.moving = new Size(kMovingSizes, kMovingMs, 1);
    this.still = new Size(kStillSizes, kStillMs, 0);
    this.wanted = null;    // 'moving' or 'still'
    this.running = null;   // the pending request
    this.shown = null;     // the last frame: camera, kind, size, version of the labels
    this.frozen = false;   // true while a stroke is painted: the picture does not change
  }

  // 'moving' or 'still': the frame pending or requested next.
  get drawing() { return this.running?.kind ?? this.wanted; }

  // Call when the camera moved; a large frame follows once it rests.
  move() {
    this.learnFromStill();
    clearTimeout(this.settling);
    this.settling = setTimeout(() => this.refresh(), kSettleMs);
    if (this.running?.kind === 'still') this.running.abort.abort();
    this.wanted = 'moving';
    this.next();
  }

  // Call when labels, layers or the window size changed.
  refresh() {
    if (this.running?.kind === 'still') this.running.abort.abort();
    this.wanted = 'still';
    this.next();
  }

  // The size changes only when the camera moves: strokes are in pixels of the still frame.
  learnFromStill() {
    if (this.shown?.kind !== 'still' || this.shown.learnt) return;
    this.shown.learnt = true;
    this.still.learn(this.shown.ms);
  }

  freeze(frozen) {
    this.frozen = frozen;
    if (!frozen) this.next();
  }

  // Size of a frame with longer side `longest` and the window's aspect, at most the screen's resolution.
  sizeFor(longest) {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    const factor = Math.min(longest / Math.max(width, height), Math.min(window.devicePixelRatio, 2));
    return [Math.max(16, Math.round(width * factor)), Math.max(16, Math.round(height * factor))];
  }

  cameraFor(kind) { return this.camera.toJson(...this.sizeFor(this[kind].pixels)); }

  async next() {
    if (this.running || this.frozen || !this.wanted || !this.canvas.clientWidth) return;
    const kind = this.wanted, moving = kind === 'moving';
    this.wanted = null;
    this.running = { kind, abort: new AbortController() };
    this.on.busy();
    const body = { camera: this.cameraFor(kind), ...this.describe(), moving };
    try {
      const picture = await frame(body, this.running.abort.signal);
      if (!this.frozen) this.show(picture, body.camera, kind);
      else this.wanted ??= kind;
    } catch (error) {
      if (error.name !== 'AbortError') this.on.failed(error);
      if (error instanceof StudioError && error.gone) this.wanted = null;
    }
    this.running = null;
    this.on.busy();
    this.next();
  }

  show(picture, camera, kind) {
    const { bitmap, ms, version } = picture;
    this.paint(bitmap);
    this.shown = { camera, kind, ms, version, width: bitmap.width, height: bitmap.height };
    if (kind === 'moving') this.moving.learn(ms);
    this.on.shown(this.shown);
  }

  paint(bitmap) {
    const { canvas } = this;
    const ratio = Math.min(window.devicePixelRatio, 2);
    const width = Math.round(canvas.clientWidth * ratio), height = Math.round(canvas.clientHeight * ratio);
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    const context = canvas.getContext('2d');
    context.imageSmoothingQuality = 'high';
    context.drawImage(bitmap, 0, 0, width, height);
    bitmap.close();
  }
}
