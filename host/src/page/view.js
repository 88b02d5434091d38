// From the orientation to a picture: the matrices of the library's `vrduino::view`, which are
// algorithms 1 to 3 of the course notes with what is misprinted there put right (docs/errata.md).
//
// A quaternion is w, x, y, z, body to world; the world has y up and −z ahead. A matrix is sixteen
// numbers, column after column, as OpenGL takes them. Lengths are millimetres. Every function
// writes into `out`, so that a picture allocates nothing.

export const LEFT = -1;
export const RIGHT = 1;

export const matrix = () => new Float64Array([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]);

/** Of unit length again (section 5.4). False, and `out` as it was, if it is no rotation. */
export function unit(out, w, x, y, z) {
  const length = Math.hypot(w, x, y, z);
  if (!(length > 0 && length < Infinity)) return false;
  out[0] = w / length;
  out[1] = x / length;
  out[2] = y / length;
  out[3] = z / length;
  return true;
}

/** Eq. 33: what a board of this orientation is drawn with (algorithm 1, `glRotate`). */
export function rotation(out, [w, x, y, z]) {
  out[0] = 1 - 2 * (y * y + z * z);
  out[1] = 2 * (x * y + w * z);
  out[2] = 2 * (x * z - w * y);
  out[4] = 2 * (x * y - w * z);
  out[5] = 1 - 2 * (x * x + z * z);
  out[6] = 2 * (y * z + w * x);
  out[8] = 2 * (x * z + w * y);
  out[9] = 2 * (y * z - w * x);
  out[10] = 1 - 2 * (x * x + y * y);
  out[3] = out[7] = out[11] = out[12] = out[13] = out[14] = 0;
  out[15] = 1;
  return out;
}

/** The head's orientation, if the board is taped to the headset turned round (figure 8): F q F⁻¹. */
function mounted(out, q, turnedAround) {
  const sign = turnedAround ? -1 : 1;
  out[0] = q[0];
  out[1] = sign * q[1];
  out[2] = q[2];
  out[3] = sign * q[3];
  return out;
}

const head = new Float64Array(4);

/**
 * The view of one eye, world to camera:
 * T(∓ipd/2, 0, 0) · T(0, −l_n, l_h) · R⁻¹ · T(0, l_n, −l_h) · T(−position).
 *
 * `viewer` has `turnedAround`, `ipd`, `neck` (l_n), `head` (l_h) and `position`; `eye` is LEFT,
 * RIGHT, or 0 for the middle between them.
 */
export function viewOfEye(out, viewer, q, eye) {
  rotation(out, mounted(head, q, viewer.turnedAround));
  transposeRotation(out);
  const x = -viewer.position[0];
  const y = viewer.neck - viewer.position[1];
  const z = -viewer.head - viewer.position[2];
  out[12] = out[0] * x + out[4] * y + out[8] * z - (eye * viewer.ipd) / 2;
  out[13] = out[1] * x + out[5] * y + out[9] * z - viewer.neck;
  out[14] = out[2] * x + out[6] * y + out[10] * z + viewer.head;
  return out;
}

/** The inverse of a rotation. */
function transposeRotation(m) {
  for (const [above, below] of [[4, 1], [8, 2], [9, 6]]) {
    const kept = m[above];
    m[above] = m[below];
    m[below] = kept;
  }
}

/** OpenGL's look-at, y upwards in the picture. */
export function lookAt(out, eye, target) {
  let [fx, fy, fz] = [target[0] - eye[0], target[1] - eye[1], target[2] - eye[2]];
  const far = Math.hypot(fx, fy, fz);
  [fx, fy, fz] = [fx / far, fy / far, fz / far];
  // Side = sight × y, up = side × sight.
  const flat = Math.hypot(fx, fz);
  const [sx, sz] = [-fz / flat, fx / flat];
  const [ux, uy, uz] = [-sz * fy, sz * fx - sx * fz, sx * fy];
  out.set([sx, ux, -fx, 0, 0, uy, -fy, 0, sz, uz, -fz, 0, 0, 0, 0, 1]);
  out[12] = -(sx * eye[0] + sz * eye[2]);
  out[13] = -(ux * eye[0] + uy * eye[1] + uz * eye[2]);
  out[14] = fx * eye[0] + fy * eye[1] + fz * eye[2];
  return out;
}

/** `glFrustum`: through a window in the near plane that need not be straight ahead. */
export function through(out, left, right, bottom, top, near, far) {
  out.fill(0);
  out[0] = (2 * near) / (right - left);
  out[5] = (2 * near) / (top - bottom);
  out[8] = (right + left) / (right - left);
  out[9] = (top + bottom) / (top - bottom);
  out[10] = -(far + near) / (far - near);
  out[11] = -1;
  out[14] = (-2 * near * far) / (far - near);
  return out;
}

/** `gluPerspective`: straight ahead; `fieldOfView` from bottom to top in radians. */
export function straight(out, fieldOfView, aspect, near, far) {
  const top = near * Math.tan(fieldOfView / 2);
  return through(out, -top * aspect, top * aspect, -top, top, near, far);
}

/**
 * The same for one eye of two: the windows of both are the same piece of the world, `screen`
 * millimetres ahead, so that what is there needs no squint.
 */
export function frustumOfEye(out, eye, ipd, screen, fieldOfView, aspect, near, far) {
  const top = near * Math.tan(fieldOfView / 2);
  const aside = (-eye * ipd * near) / (2 * screen);
  return through(out, aside - top * aspect, aside + top * aspect, -top, top, near, far);
}

export function multiply(out, a, b) {
  for (let column = 0; column < 16; column += 4) {
    const [x, y, z, w] = [b[column], b[column + 1], b[column + 2], b[column + 3]];
    for (let row = 0; row < 4; row += 1) {
      out[column + row] = a[row] * x + a[4 + row] * y + a[8 + row] * z + a[12 + row] * w;
    }
  }
  return out;
}

const DEGREES = 180 / Math.PI;

/** Yaw about y, pitch about x, roll about z, in degrees, as the library's `EulerAngles::of`. */
export function angles(out, w, x, y, z) {
  const ofSum = Math.hypot(w - x, y + z);
  const ofDifference = Math.hypot(w + x, y - z);
  let halfSum = Math.atan2(y + z, w - x);
  let halfDifference = Math.atan2(y - z, w + x);
  // Straight up or down only the sum or difference of yaw and roll is defined: roll is zero there.
  if (ofSum < 1e-7) halfSum = halfDifference;
  else if (ofDifference < 1e-7) halfDifference = halfSum;
  out[0] = shortWay((halfSum + halfDifference) * DEGREES);
  out[1] = Math.atan2(2 * (w * x - y * z), ofSum * ofDifference) * DEGREES;
  out[2] = shortWay((halfSum - halfDifference) * DEGREES);
  return out;
}

function shortWay(degrees) {
  if (degrees > 180) return degrees - 360;
  return degrees < -180 ? degrees + 360 : degrees;
}

/** The angle between two orientations in degrees. */
export function apart(p, q) {
  const w = p[0] * q[0] + p[1] * q[1] + p[2] * q[2] + p[3] * q[3];
  const x = p[0] * q[1] - p[1] * q[0] - p[2] * q[3] + p[3] * q[2];
  const y = p[0] * q[2] + p[1] * q[3] - p[2] * q[0] - p[3] * q[1];
  const z = p[0] * q[3] - p[1] * q[2] + p[2] * q[1] - p[3] * q[0];
  return 2 * Math.atan2(Math.hypot(x, y, z), Math.abs(w)) * DEGREES;
}

/** The angle between where two orientations have up, in degrees: what a turn about y leaves alone. */
export function tiltApart(p, q) {
  const up = ([w, x, y, z]) => [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)];
  const [a, b] = [up(p), up(q)];
  const cross = Math.hypot(
    a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0],
  );
  return Math.atan2(cross, a[0] * b[0] + a[1] * b[1] + a[2] * b[2]) * DEGREES;
}
