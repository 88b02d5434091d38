// What a test, or a curious person in the browser's console, may read: `window.vrduino`.

import { rotation, matrix, viewOfEye, LEFT, RIGHT } from "./view.js";

export function expose({ samples, history, picture, terminal, shown }) {
  const worn = () => ({
    turnedAround: picture.viewer.turnedAround,
    ipd: picture.viewer.ipd,
    neck: picture.neckOn ? picture.viewer.neck : 0,
    head: picture.neckOn ? picture.viewer.head : 0,
    position: [...picture.viewer.position],
  });
  const eye = (side) => Array.from(viewOfEye(matrix(), worn(), samples.quaternion, side));
  const now = {
    count: () => samples.count,
    quaternion: () => Array.from(samples.quaternion),
    time: () => samples.latest.time,
    flags: () => samples.latest.flags,
    sequence: () => samples.latest.sequence,
    hertz: () => history.hertz,
    lost: () => history.lost,
    angles: () => Array.from(history.angles),
    model: () => Array.from(rotation(matrix(), samples.quaternion)),
    /** What the last picture was drawn with. */
    drawn: () => ({
      model: Array.from(picture.model), left: Array.from(picture.views.left), right: Array.from(picture.views.right),
    }),
    left: () => eye(LEFT),
    right: () => eye(RIGHT),
    projections: () => ({ left: Array.from(picture.projections.left), right: Array.from(picture.projections.right) }),
    viewer: worn,
    mode: () => picture.mode,
    frames: () => picture.frames,
    graphics: () => (picture.gl ? (picture.lost ? "lost" : "drawn") : "none"),
    status: () => shown.status,
    truth: () => shown.truth,
    lines: () => [...terminal.latest],
  };
  const properties = Object.entries(now).map(([name, get]) => [name, { get, enumerable: true }]);
  window.vrduino = Object.freeze(Object.defineProperties({
    /** The orientation at a moment of the device's time between samples of the last seconds, or null. */
    at: (time) => samples.at(time),
  }, Object.fromEntries(properties)));
}
