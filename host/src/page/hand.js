// The emulated board in a person's hand: where the picture is dragged, the simulated sensor turns,
// and all that is seen of it has gone through gyro, estimator and USB.

/** Radians a pixel. */
const SPEED = 0.008;
/** So long the hand takes to get there, in milliseconds: a drag goes on from where the last was to lead. */
const ARRIVES = 1500;

export const isInHand = ({ kind, motion }) => kind === "emulated" && motion === "hand";

export class Hand {
  /** `ask` takes what is wanted of the emulated board. */
  constructor(ask) {
    this.ask = ask;
    this.target = [1, 0, 0, 0];
    this.movedAt = -Infinity;
    this.begins = false;
    this.waiting = false;
  }

  /** A finger or the mouse is put down. */
  begin() {
    this.begins = performance.now() - this.movedAt > ARRIVES;
  }

  /** By so many pixels, as seen by a camera whose right is this axis; it is asked for with the next picture. */
  drag(across, down, right, truth) {
    if (this.begins && truth) {
      this.target = [...truth.q];
      this.begins = false;
    }
    this.movedAt = performance.now();
    this.target = product(about([0, 1, 0], SPEED * across), product(about(right, SPEED * down), this.target));
    this.waiting = true;
  }

  /** Once in an animation frame. */
  move() {
    if (!this.waiting) return;
    this.waiting = false;
    this.ask({ turn: this.target });
  }
}

function about([x, y, z], angle) {
  const s = Math.sin(angle / 2) / Math.hypot(x, y, z);
  return [Math.cos(angle / 2), s * x, s * y, s * z];
}

/** p q, of unit length again. */
function product([a, b, c, d], [w, x, y, z]) {
  const q = [
    a * w - b * x - c * y - d * z,
    a * x + b * w + c * z - d * y,
    a * y - b * z + c * w + d * x,
    a * z + b * y - c * x + d * w,
  ];
  const length = Math.hypot(...q);
  return q.map((value) => value / length);
}
