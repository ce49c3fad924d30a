// Masks of everything in a picture: a network is prompted at the points of a grid, and stable, different masks are kept.

const kPoints = 16; // along each side of the picture
const kStable = 0.8; // least IoU of the masks at logits above 1 and above -1, as in Segment Anything
const kSame = 0.7; // IoU from which two masks are one
const kLeastPixels = 12; // of the network's mask
const kLarge = 0.05; // part of the picture: below a larger mask, smaller things are looked for

/** Points of the grid in [0, 1]², every fourth row and column first, then every second: large things are found first. */
function gridPoints() {
  const level = (i) => (i % 4 === 1 ? 0 : i % 2 === 1 ? 1 : 2);
  const points = [];
  for (let j = 0; j < kPoints; ++j)
    for (let i = 0; i < kPoints; ++i)
      points.push({ x: (i + 0.5) / kPoints, y: (j + 0.5) / kPoints, level: Math.max(level(i), level(j)) });
  return points.sort((a, b) => a.level - b.level); // stable
}

function countBoth(a, b) {
  let both = 0;
  for (let p = 0; p < a.length; ++p) both += a[p] & b[p];
  return both;
}

/**
 * Kept masks [{logits, pixels}], the largest first. `decodeAt(x, y)` returns the logits [height x width] of the thing at a
 * point in [0, 1]²; `width` and `height` are those of the logits.
 */
export async function masksOfEverything(width, height, decodeAt) {
  const kept = [];
  for (const { x, y } of gridPoints()) {
    const at = Math.floor(y * height) * width + Math.floor(x * width);
    if (kept.some((k) => k.mask[at] && k.pixels < kLarge * width * height)) continue;
    const logits = await decodeAt(x, y);
    const mask = Uint8Array.from(logits, (l) => (l > 0 ? 1 : 0));
    let [pixels, sure, possible] = [0, 0, 0];
    for (let p = 0; p < logits.length; ++p) {
      pixels += mask[p];
      sure += logits[p] > 1;
      possible += logits[p] > -1;
    }
    if (pixels < kLeastPixels || sure < kStable * possible) continue;
    const isKnown = (k) => {
      const both = countBoth(k.mask, mask);
      return both >= kSame * (k.pixels + pixels - both);
    };
    if (!kept.some(isKnown)) kept.push({ logits, mask, pixels });
  }
  return kept.sort((a, b) => b.pixels - a.pixels);
}
