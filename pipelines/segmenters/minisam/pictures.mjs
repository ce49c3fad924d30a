// Scaling of one plane of numbers, row by row.

/** Taps of a triangle filter, widened to an output pixel when downscaling: [first source, weights] per output pixel. */
function taps(from, to) {
  const step = from / to;
  const reach = Math.max(1, step);
  return Array.from({ length: to }, (_, i) => {
    const centre = (i + 0.5) * step;
    const first = Math.max(0, Math.floor(centre - reach));
    const last = Math.min(from - 1, Math.ceil(centre + reach));
    const weights = [];
    for (let s = first; s <= last; ++s) weights.push(Math.max(0, 1 - Math.abs(s + 0.5 - centre) / reach));
    const sum = weights.reduce((a, b) => a + b, 0);
    return [first, weights.map((w) => w / sum)];
  });
}

export function resize(plane, width, height, toWidth, toHeight) {
  const across = new Float32Array(height * toWidth);
  taps(width, toWidth).forEach(([first, weights], x) => {
    for (let y = 0; y < height; ++y) {
      let sum = 0;
      for (let k = 0; k < weights.length; ++k) sum += weights[k] * plane[y * width + first + k];
      across[y * toWidth + x] = sum;
    }
  });
  const out = new Float32Array(toHeight * toWidth);
  taps(height, toHeight).forEach(([first, weights], y) => {
    for (let x = 0; x < toWidth; ++x) {
      let sum = 0;
      for (let k = 0; k < weights.length; ++k) sum += weights[k] * across[(first + k) * toWidth + x];
      out[y * toWidth + x] = sum;
    }
  });
  return out;
}

/** The picture {width, height, data} in the corner of a padded square of `side` px, of the shape `width` x `height`. */
export function cropped(square, side, width, height) {
  const scale = side / Math.max(width, height);
  const low = { width: Math.round(width * scale), height: Math.round(height * scale) };
  low.data = new Float32Array(low.width * low.height);
  for (let y = 0; y < low.height; ++y) low.data.set(square.subarray(y * side, y * side + low.width), y * low.width);
  return low;
}

/** The same, resized to `width` x `height` px. */
export function enlarge(square, side, width, height) {
  const low = cropped(square, side, width, height);
  return resize(low.data, low.width, low.height, width, height);
}
