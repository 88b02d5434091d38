// What a test, or a curious person at the browser's own console, may read: `window.vrduino`.

export function expose({ samples, history, picture, terminal, shown }) {
  const now = {
    /** Samples taken in since the page was opened. */
    count: () => samples.count,
    /** The latest: w, x, y, z, body to world; its moment in s; its flags (samples.js). */
    quaternion: () => Array.from(samples.quaternion),
    time: () => samples.latest.time,
    flags: () => samples.latest.flags,
    angles: () => Array.from(history.angles),
    hertz: () => history.hertz,
    lost: () => history.lost,
    mode: () => picture.mode,
    /** Who wears the headset, as the matrices have it. */
    viewer: () => ({ ...picture.worn(), position: [...picture.viewer.position] }),
    /** The matrices of the latest picture, and what it was turned by. */
    picture: () => ({
      frames: picture.frames,
      quaternion: Array.from(picture.quaternion),
      model: Array.from(picture.model),
      left: Array.from(picture.views.left),
      right: Array.from(picture.views.right),
      leftLens: Array.from(picture.projections.left),
      rightLens: Array.from(picture.projections.right),
    }),
    /** "drawn", "lost" for the moment, or "none". */
    graphics: () => {
      if (!picture.gl) return "none";
      return picture.lost ? "lost" : "drawn";
    },
    status: () => shown.status,
    truth: () => shown.truth,
    lines: () => [...terminal.latest],
  };
  const properties = Object.entries(now).map(([name, get]) => [name, { get, enumerable: true }]);
  window.vrduino = Object.freeze(Object.defineProperties({
    /** The orientation at a moment of the stream's time in the last seconds, or null. */
    at: (time) => samples.at(time),
  }, Object.fromEntries(properties)));
}
