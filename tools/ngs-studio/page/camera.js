// The camera of the page: position, orbit target, and how input moves it. Lengths in world units of the splat, angles
// in radians; requests to the server give the field of view in degrees.
export const add = (a, b) => a.map((x, k) => x + b[k]);
export const subtract = (a, b) => a.map((x, k) => x - b[k]);
export const scale = (a, s) => a.map((x) => x * s);
export const dot = (a, b) => a.reduce((sum, x, k) => sum + x * b[k], 0);
export const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
export const length = (a) => Math.hypot(...a);
export const normalise = (a) => scale(a, 1 / (length(a) || 1));

// a turned about the unit vector axis, by the right-hand rule.
export function rotate(a, axis, angle) {
  const along = scale(axis, dot(axis, a) * (1 - Math.cos(angle)));
  return add(add(scale(a, Math.cos(angle)), scale(cross(axis, a), Math.sin(angle))), along);
}

const kSteepest = 0.02;   // radians, least angle between line of sight and vertical
const kUprighting = 0.25; // share of the roll removed per orbit step, to avoid a jump
const kMinDistance = 1e-4; // of the scene's radius

export class Camera {
  constructor(start, bounds) {
    this.bounds = bounds;
    this.vertical = normalise(bounds.up);
    this.place(start);
  }

  // Takes over a camera sent by the server.
  place({ position, look_at, up, fov_y_deg }) {
    this.position = [...position];
    this.target = [...look_at];
    this.up = normalise(up);
    this.fovDegrees = fov_y_deg;
  }

  get distance() { return length(subtract(this.target, this.position)); }
  get forward() { return normalise(subtract(this.target, this.position)); }
  get right() { return normalise(cross(this.forward, this.up)); }
  get upright() { return cross(this.right, this.forward); }

  // Turns about the target: to the left by `across`, upwards by `along`.
  orbit(across, along) {
    this.straighten();
    const arm = rotate(subtract(this.position, this.target), this.vertical, -across);
    const steep = Math.acos(Math.max(-1, Math.min(1, dot(normalise(arm), this.vertical))));
    const turned = Math.max(kSteepest, Math.min(Math.PI - kSteepest, steep - along));
    const side = normalise(cross(this.vertical, arm));
    this.position = add(this.target, rotate(arm, side, turned - steep));
  }

  // Turns the line of sight at a fixed position: to the right by `across`, upwards by `along`.
  look(across, along) {
    this.straighten();
    const sight = rotate(subtract(this.target, this.position), this.vertical, -across);
    const steep = Math.acos(Math.max(-1, Math.min(1, dot(normalise(sight), this.vertical))));
    const turned = Math.max(kSteepest, Math.min(Math.PI - kSteepest, steep - along));
    this.target = add(this.position, rotate(sight, normalise(cross(this.vertical, sight)), turned - steep));
  }

  // Takes another direction as vertical and shows the same side of the splat, upright.
  turnUpright(vertical) {
    const up = normalise(vertical), axis = cross(this.vertical, up);
    const across = length(axis) > 1e-6 ? normalise(axis) : this.right;
    const angle = Math.acos(Math.max(-1, Math.min(1, dot(this.vertical, up))));
    this.position = add(this.target, rotate(subtract(this.position, this.target), across, angle));
    this.vertical = this.up = up;
  }

  straighten() {
    this.up = normalise(add(scale(this.up, 1 - kUprighting), scale(this.vertical, kUprighting)));
  }

  // Half the height of the picture, at distance 1. The field of view spans the shorter side: a portrait window shows
  // more above and below, and the same width.
  halfHeight(aspect) { return Math.tan((this.fovDegrees * Math.PI) / 360) / Math.min(1, aspect); }

  // Moves points at the target's depth by fractions of the picture's height.
  pan(across, along, aspect) {
    const height = 2 * this.distance * this.halfHeight(aspect);
    this.move(0, -across * height, along * height);
  }

  // Moves nearer (factor < 1) or farther. At the least distance the target moves ahead, so that zooming in continues.
  zoom(factor) {
    const distance = this.distance, least = kMinDistance * this.bounds.radius;
    const wanted = Math.min(distance * factor, 20 * this.bounds.radius);
    const forward = this.forward;
    this.position = subtract(this.target, scale(forward, wanted));
    if (wanted < least) this.target = add(this.position, scale(forward, least));
  }

  // Moves position and target together.
  move(ahead, rightwards, upwards) {
    const step = add(add(scale(this.forward, ahead), scale(this.right, rightwards)), scale(this.upright, upwards));
    this.position = add(this.position, step);
    this.target = add(this.target, step);
  }

  // Fits a ball into the picture, with the same viewing direction.
  fit({ centre, radius }) {
    const forward = this.forward;
    this.target = [...centre];
    this.position = subtract(centre, scale(forward, (1.1 * radius) / Math.sin((this.fovDegrees * Math.PI) / 360)));
  }

  // The camera as the server expects it, for a picture of this size in pixels.
  toJson(width, height) {
    const fovY = (360 / Math.PI) * Math.atan(this.halfHeight(width / height));
    return {
      position: this.position, look_at: this.target, up: this.up, fov_y_deg: fovY,
      width: Math.round(width), height: Math.round(height),
    };
  }
}
