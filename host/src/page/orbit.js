// Going round the board: a finger or the mouse drags, the wheel or two fingers go nearer.

const START = { azimuth: 0.5, elevation: 0.36, distance: 320 };
const [NEAREST, FARTHEST] = [150, 900];
/** Not over the pole, where left and right would change places. */
const STEEPEST = 1.5;
/** Radians a pixel. */
const SPEED = 0.008;

export class Orbit {
  /**
   * `changed` is called when the picture must be drawn again, `begun` where a drag begins, and
   * `taken(across, down, event)` with every step of it: whether it was meant for something else.
   */
  constructor(canvas, changed, begun, taken) {
    this.changed = changed;
    this.taken = taken;
    this.fingers = new Map();
    this.eye = new Float64Array(3);
    this.reset();
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      this.fingers.set(event.pointerId, [event.clientX, event.clientY]);
      begun();
    });
    canvas.addEventListener("pointermove", (event) => this.drag(event));
    for (const over of ["pointerup", "pointercancel"]) {
      canvas.addEventListener(over, (event) => this.fingers.delete(event.pointerId));
    }
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      this.zoom(Math.exp(event.deltaY * 0.001));
    }, { passive: false });
    canvas.addEventListener("dblclick", () => this.reset());
  }

  reset() {
    Object.assign(this, START);
    this.changed();
  }

  drag(event) {
    const before = this.fingers.get(event.pointerId);
    if (!before) return;
    const now = [event.clientX, event.clientY];
    const other = [...this.fingers].find(([id]) => id !== event.pointerId)?.[1];
    this.fingers.set(event.pointerId, now);
    if (other) {
      const apart = ([x, y]) => Math.hypot(x - other[0], y - other[1]);
      this.zoom(apart(before) / Math.max(apart(now), 1));
      return;
    }
    const [across, down] = [now[0] - before[0], now[1] - before[1]];
    if (this.taken(across, down, event)) return;
    this.azimuth -= SPEED * across;
    const elevation = this.elevation + SPEED * down;
    this.elevation = Math.min(STEEPEST, Math.max(-STEEPEST, elevation));
    this.changed();
  }

  zoom(factor) {
    this.distance = Math.min(FARTHEST, Math.max(NEAREST, this.distance * factor));
    this.changed();
  }

  /** Where the camera is, `farther` times as far as it would be in a wide picture. */
  position(farther) {
    const distance = this.distance * farther;
    const flat = distance * Math.cos(this.elevation);
    this.eye[0] = flat * Math.sin(this.azimuth);
    this.eye[1] = distance * Math.sin(this.elevation);
    this.eye[2] = flat * Math.cos(this.azimuth);
    return this.eye;
  }
}
