// The picture: frames are asked for one at a time, small while something moves, large when all is still.
import { StudioError, frame } from './server.js';

const kMovingMs = 60, kStillMs = 900;             // what a frame may take the server
const kMovingSizes = [240, 320, 480, 640, 960];   // longer side of a frame, pixels
const kStillSizes = [640, 960, 1280, 1920];
const kPatience = 12;                               // fast frames before a slow size is tried again
const kSettleMs = 160;                            // without a change, the picture counts as still

// Longer side of frames: the largest of `sizes` that stays within `budgetMs`. A size that was too slow is tried again
// only after many fast frames, so that pictures do not change their sharpness to and fro.
class Size {
  constructor(sizes, budgetMs, step) {
    Object.assign(this, { sizes, budgetMs, step, ceiling: sizes.length - 1, fast: 0 });
  }
  get pixels() { return this.sizes[this.step]; }
  learn(ms) {
    this.fast = ms < 0.35 * this.budgetMs ? this.fast + 1 : 0;
    if (ms > this.budgetMs) this.ceiling = this.step = Math.max(0, this.step - 1);
    if (this.fast > kPatience) this.ceiling = this.sizes.length - 1;
    if (this.fast > 0 && this.step < this.ceiling) this.step += 1;
  }
}

export class Frames {
  // `describe()` gives what belongs to a request beside camera and size; `camera` is the page's; `on` has shown(frame),
  // failed(error) and busy(), which is called when drawing begins or ends.
  constructor(canvas, camera, describe, on) {
    Object.assign(this, { canvas, camera, describe, on });
    this.moving = new Size(kMovingSizes, kMovingMs, 2);
    this.still = new Size(kStillSizes, kStillMs, 1);
    this.wanted = null;    // 'moving' or 'still'
    this.running = null;   // the request under way
    this.shown = null;     // the last frame: its camera, of which size, which version of the labels
    this.frozen = false;   // while a stroke is painted, the picture stays as it is
  }

  // 'moving' or 'still': what the server draws, or soon will.
  get drawing() { return this.running?.kind ?? this.wanted; }

  // The camera has moved; once it rests, a large frame follows.
  move() {
    this.learnFromStill();
    clearTimeout(this.settling);
    this.settling = setTimeout(() => this.refresh(), kSettleMs);
    if (this.running?.kind === 'still') this.running.abort.abort();
    this.wanted = 'moving';
    this.next();
  }

  // Something else has changed: labels, layers, the size of the window.
  refresh() {
    if (this.running?.kind === 'still') this.running.abort.abort();
    this.wanted = 'still';
    this.next();
  }

  // As long as the camera rests, the size stays: strokes are in its pixels.
  learnFromStill() {
    if (this.shown?.kind !== 'still' || this.shown.learnt) return;
    this.shown.learnt = true;
    this.still.learn(this.shown.ms);
  }

  freeze(frozen) {
    this.frozen = frozen;
    if (!frozen) this.next();
  }

  // Pixels of a frame whose longer side is `longest`, in the window's proportions, never more than the screen has.
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
