// The picture: the board turned by the stream (algorithm 1), or what a head that wears it sees with
// two eyes (algorithms 2 and 3). One draw in an animation frame, and none when nothing has changed.

import * as view from "./view.js";
import { Mesh, Program, texture, white } from "./gl.js";
import { GROUND, PLAIN, SKY, SOLID } from "./shaders.js";
import { Shapes } from "./shapes.js";
import * as board from "./board.js";
import { EYES, lettering, room, signs } from "./room.js";
import { LIGHTS } from "./theme.js";

const FIELD_OF_VIEW = { board: (32 * Math.PI) / 180, stereo: (75 * Math.PI) / 180 };
/** The eyes' windows are one at this distance, in millimetres. */
const SCREEN = 2500;
/** Under the board, in millimetres. */
const FLOOR = -78;
const SUN = new Float64Array([0.42, 0.78, 0.46]);
const ROOM_SUN = new Float64Array([-0.5, 0.62, -0.6]);
const IDENTITY = view.matrix();
/** Sharper than this is more work than it shows. */
const SHARPEST = 2;

export class Picture {
  constructor(canvas) {
    this.canvas = canvas;
    this.mode = "board";
    this.viewer = { turnedAround: false, ipd: 64, neck: 150, head: 100, position: EYES };
    this.neckOn = true;
    this.dark = true;
    this.quaternion = new Float64Array([1, 0, 0, 0]);
    this.model = view.matrix();
    this.views = { left: view.matrix(), right: view.matrix() };
    this.camera = view.matrix();
    this.projections = { left: view.matrix(), right: view.matrix() };
    this.lens = view.matrix();
    this.shadow = view.matrix();
    this.under = view.matrix();
    this.eye = new Float64Array(3);
    this.frames = 0;
    this.lost = false;
    this.gl = canvas.getContext("webgl2", { antialias: true, alpha: true, stencil: true });
    if (this.gl) this.build();
    canvas.addEventListener("webglcontextlost", (event) => {
      event.preventDefault(); // or it would not come back
      this.lost = true;
    });
    canvas.addEventListener("webglcontextrestored", () => {
      this.build();
      this.lost = false;
      this.restored?.();
    });
  }

  /** Everything that the graphics processor holds; again after it has lost it. */
  build() {
    const { gl } = this;
    this.programs = Object.fromEntries(
      Object.entries({ solid: SOLID, plain: PLAIN, ground: GROUND, sky: SKY })
        .map(([name, source]) => [name, new Program(gl, source)]),
    );
    const sheet = new Shapes().quad([[-1, 0, 1], [1, 0, 1], [1, 0, -1], [-1, 0, -1]], [0, 1, 0]);
    // On the floor, straight ahead.
    const pointer = new Shapes().quad([[-9, 0, -128], [9, 0, -128], [0, 0, -152], [0, 0, -152]], [0, 1, 0]);
    this.meshes = Object.fromEntries(
      Object.entries({
        solids: board.solids(), faces: board.faces(), axes: board.axes(),
        room: room(), signs: signs(), sheet, pointer,
      }).map(([name, shapes]) => [name, new Mesh(gl, shapes)]),
    );
    this.textures = {
      white: white(gl), prints: texture(gl, board.prints()), letters: texture(gl, lettering()),
    };
    this.bare = gl.createVertexArray();
    gl.enable(gl.DEPTH_TEST);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
  }

  /** The matrices of this moment, whether they are drawn or not. */
  turn(q) {
    this.quaternion.set(q);
    view.rotation(this.model, q);
    const worn = this.worn();
    view.viewOfEye(this.views.left, worn, q, view.LEFT);
    view.viewOfEye(this.views.right, worn, q, view.RIGHT);
  }

  /** The viewer, whose neck can be left out. */
  worn() {
    return this.neckOn ? this.viewer : { ...this.viewer, neck: 0, head: 0 };
  }

  draw(q, orbit) {
    this.turn(q);
    if (!this.gl || this.lost) return;
    const { gl, canvas } = this;
    this.fit();
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT | gl.STENCIL_BUFFER_BIT);
    if (this.mode === "stereo") this.drawStereo();
    else this.drawBoard(orbit);
    this.frames += 1;
  }

  /** The camera's right, in the world. */
  right() {
    const camera = this.mode === "stereo" ? this.views.left : this.camera;
    return [camera[0], camera[4], camera[8]];
  }

  fit() {
    const scale = Math.min(window.devicePixelRatio || 1, SHARPEST);
    const width = Math.max(1, Math.round(this.canvas.clientWidth * scale));
    const height = Math.max(1, Math.round(this.canvas.clientHeight * scale));
    if (this.canvas.width !== width) this.canvas.width = width;
    if (this.canvas.height !== height) this.canvas.height = height;
  }

  drawBoard(orbit) {
    const { canvas, lens, camera } = this;
    const aspect = canvas.width / canvas.height;
    // A narrow picture must show as much from side to side.
    const eye = orbit.position(Math.max(1, 1.15 / aspect));
    view.straight(lens, FIELD_OF_VIEW.board, aspect, 20, 4000);
    view.lookAt(camera, eye, [0, -8, 0]);
    const light = LIGHTS[this.dark ? "dark" : "light"];
    this.drawGround(camera, lens, light.bench, 40, 420, FLOOR, 0);
    this.drawPointer(camera, lens, light.bench.line);
    this.drawShadow(camera, lens);
    this.drawSolid(camera, lens, light.bench, eye, SUN, [
      [this.meshes.solids, this.textures.white, this.model],
      [this.meshes.faces, this.textures.prints, this.model],
      [this.meshes.axes, this.textures.white, this.model],
    ]);
  }

  drawStereo() {
    const { gl, canvas, viewer } = this;
    const half = Math.floor(canvas.width / 2);
    const light = LIGHTS[this.dark ? "dark" : "light"].court;
    for (const [side, name] of [[view.LEFT, "left"], [view.RIGHT, "right"]]) {
      const start = side === view.LEFT ? 0 : canvas.width - half;
      gl.viewport(start, 0, half, canvas.height);
      const [lens, camera] = [this.projections[name], this.views[name]];
      const aspect = half / canvas.height;
      // As much of the court is seen in a tall half as in a wide one.
      const slope = Math.tan(FIELD_OF_VIEW.stereo / 2) / Math.min(1, Math.max(aspect, 0.6));
      const upright = 2 * Math.atan(slope);
      view.frustumOfEye(lens, side, viewer.ipd, SCREEN, upright, aspect, 60, 90000);
      this.drawSky(camera, lens, light);
      this.drawGround(camera, lens, light, 1000, 60000, 0, 1);
      this.drawSolid(camera, lens, light, this.positionOf(camera), ROOM_SUN, [
        [this.meshes.room, this.textures.white, IDENTITY],
        [this.meshes.signs, this.textures.letters, IDENTITY],
      ]);
    }
  }

  /** Where a camera is: −Rᵀ t. */
  positionOf(camera) {
    const [x, y, z] = camera.subarray(12, 15);
    for (let row = 0; row < 3; row += 1) {
      this.eye[row] = -(camera[4 * row] * x + camera[4 * row + 1] * y + camera[4 * row + 2] * z);
    }
    return this.eye;
  }

  begin(program, camera, lens) {
    program.use();
    program.matrix("view", camera);
    program.matrix("projection", lens);
    return program;
  }

  drawSolid(camera, lens, light, eye, sun, things) {
    const { gl } = this;
    const program = this.begin(this.programs.solid, camera, lens);
    program.set("eye", eye);
    program.set("sun", sun);
    for (const name of ["sunlight", "skylight", "groundlight", "haze", "hazy"]) program.set(name, light[name]);
    for (const [mesh, picture, model] of things) {
      gl.bindTexture(gl.TEXTURE_2D, picture);
      program.matrix("model", model);
      mesh.draw();
    }
  }

  drawPointer(camera, lens, [red, green, blue]) {
    const program = this.begin(this.programs.plain, camera, lens);
    this.under.set(IDENTITY);
    this.under[13] = FLOOR + 0.3;
    program.matrix("model", this.under);
    program.set("tint", [red, green, blue, 1]);
    this.meshes.pointer.draw();
  }

  /** The board's own shadow on the bench; the stencil keeps it from lying on itself. */
  drawShadow(camera, lens) {
    const { gl, shadow } = this;
    shadow.set(IDENTITY);
    shadow[4] = -SUN[0] / SUN[1];
    shadow[6] = -SUN[2] / SUN[1];
    shadow[5] = 0;
    shadow[12] = (FLOOR * SUN[0]) / SUN[1];
    shadow[14] = (FLOOR * SUN[2]) / SUN[1];
    shadow[13] = FLOOR + 0.5;
    const program = this.begin(this.programs.plain, camera, lens);
    program.matrix("model", view.multiply(this.under, shadow, this.model));
    program.set("tint", LIGHTS[this.dark ? "dark" : "light"].bench.shade);
    gl.enable(gl.BLEND);
    gl.enable(gl.STENCIL_TEST);
    gl.depthMask(false);
    gl.stencilFunc(gl.EQUAL, 0, 255);
    gl.stencilOp(gl.KEEP, gl.KEEP, gl.INCR);
    this.meshes.solids.draw();
    gl.depthMask(true);
    gl.disable(gl.STENCIL_TEST);
    gl.disable(gl.BLEND);
  }

  drawGround(camera, lens, light, ring, end, height, solid) {
    const { gl } = this;
    const program = this.begin(this.programs.ground, camera, lens);
    this.under.set(IDENTITY);
    this.under[0] = this.under[10] = end;
    this.under[13] = height;
    program.matrix("model", this.under);
    program.set("line", light.line);
    program.set("ground", light.ground);
    program.set("ring", ring);
    program.set("end", end);
    program.set("solid", solid);
    gl.enable(gl.BLEND);
    gl.depthMask(solid === 1);
    this.meshes.sheet.draw();
    gl.depthMask(true);
    gl.disable(gl.BLEND);
  }

  drawSky(camera, lens, light) {
    const { gl } = this;
    const program = this.begin(this.programs.sky, camera, lens);
    program.set("sun", ROOM_SUN);
    for (const name of ["zenith", "horizon", "starry"]) program.set(name, light[name]);
    gl.bindVertexArray(this.bare);
    gl.depthMask(false);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    gl.depthMask(true);
  }

  /** Where a point of the board view is on the canvas, in CSS pixels; null behind the camera. */
  project(point, model = IDENTITY) {
    const clip = [...point, 1];
    for (const m of [model, this.camera, this.lens]) {
      const [x, y, z, w] = clip;
      for (let row = 0; row < 4; row += 1) {
        clip[row] = m[row] * x + m[4 + row] * y + m[8 + row] * z + m[12 + row] * w;
      }
    }
    if (clip[3] <= 0) return null;
    return [
      (0.5 + (0.5 * clip[0]) / clip[3]) * this.canvas.clientWidth,
      (0.5 - (0.5 * clip[1]) / clip[3]) * this.canvas.clientHeight,
    ];
  }
}
