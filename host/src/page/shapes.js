// Boxes, rods, balls: triangles with normals and colours, in millimetres.

import { VERTEX } from "./gl.js";

/** Collects the triangles of one mesh. `paint` and `put` hold until they are called again. */
export class Shapes {
  constructor() {
    this.vertices = [];
    this.indices = [];
    this.paint("#ffffff");
    this.put(0, 0, 0);
  }

  /** A colour as in CSS, `#rrggbb`, and how it shines (shaders.js). */
  paint(colour, shine = 0) {
    const channel = (at) => parseInt(colour.slice(at, at + 2), 16) / 255;
    this.colour = [channel(1), channel(3), channel(5), shine];
    return this;
  }

  /** Where the next shapes stand, with their own y along `up`: "x", "y" or "z"; turned about y. */
  put(x, y, z, up = "y", turn = 0) {
    const [s, c] = [Math.sin(turn), Math.cos(turn)];
    const along = {
      x: ([a, b, d]) => [b, d, a],
      y: ([a, b, d]) => [c * a + s * d, b, c * d - s * a],
      z: ([a, b, d]) => [d, a, b],
    };
    this.turned = along[up];
    this.origin = [x, y, z];
    return this;
  }

  vertex(position, normal, place = [0, 0]) {
    const at = this.turned(position).map((value, i) => value + this.origin[i]);
    this.vertices.push(...at, ...this.turned(normal), ...this.colour, ...place);
    return this.vertices.length / VERTEX - 1;
  }

  triangles(...indices) {
    this.indices.push(...indices);
  }

  /** Four corners, counter-clockwise as seen from where the normal points. */
  quad(corners, normal, places = []) {
    const [a, b, c, d] = corners.map((corner, i) => this.vertex(corner, normal, places[i]));
    this.triangles(a, b, c, a, c, d);
    return this;
  }

  /** Around the origin. */
  box(width, height, depth) {
    const [x, y, z] = [width / 2, height / 2, depth / 2];
    this.quad([[x, -y, z], [x, -y, -z], [x, y, -z], [x, y, z]], [1, 0, 0]);
    this.quad([[-x, -y, -z], [-x, -y, z], [-x, y, z], [-x, y, -z]], [-1, 0, 0]);
    this.quad([[-x, y, z], [x, y, z], [x, y, -z], [-x, y, -z]], [0, 1, 0]);
    this.quad([[-x, -y, -z], [x, -y, -z], [x, -y, z], [-x, -y, z]], [0, -1, 0]);
    this.quad([[-x, -y, z], [x, -y, z], [x, y, z], [-x, y, z]], [0, 0, 1]);
    this.quad([[x, -y, -z], [-x, -y, -z], [-x, y, -z], [x, y, -z]], [0, 0, -1]);
    return this;
  }

  /** Along y from 0 to `height`; another radius at the top makes it a cone. */
  rod(radius, height, sides = 16, top = radius) {
    const slope = (radius - top) / height;
    const around = (i) => {
      const angle = (2 * Math.PI * i) / sides;
      return [Math.sin(angle), Math.cos(angle)];
    };
    const flat = 1 / Math.hypot(1, slope);
    let before = null;
    for (let i = 0; i <= sides; i += 1) {
      const [s, c] = around(i);
      const normal = [s * flat, slope * flat, c * flat];
      const low = this.vertex([radius * s, 0, radius * c], normal);
      const high = this.vertex([top * s, height, top * c], normal);
      if (before) this.triangles(before[0], low, high, before[0], high, before[1]);
      before = [low, high];
    }
    this.disc(radius, 0, -1, sides);
    if (top > 0) this.disc(top, height, 1, sides);
    return this;
  }

  /** Lying at a height, seen from above (`side` 1) or below (−1). */
  disc(radius, height, side, sides = 16) {
    const middle = this.vertex([0, height, 0], [0, side, 0]);
    const first = middle + 1;
    for (let i = 0; i < sides; i += 1) {
      const angle = (side * 2 * Math.PI * i) / sides;
      this.vertex([radius * Math.sin(angle), height, radius * Math.cos(angle)], [0, side, 0]);
      this.triangles(middle, first + i, first + ((i + 1) % sides));
    }
    return this;
  }

  /** Around the origin. */
  ball(radius, sides = 20) {
    const rows = sides / 2;
    const first = this.vertices.length / VERTEX;
    for (let row = 0; row <= rows; row += 1) {
      const polar = (Math.PI * row) / rows;
      for (let i = 0; i <= sides; i += 1) {
        const angle = (2 * Math.PI * i) / sides;
        const [x, z] = [Math.sin(polar) * Math.sin(angle), Math.sin(polar) * Math.cos(angle)];
        const normal = [x, Math.cos(polar), z];
        this.vertex(normal.map((value) => value * radius), normal);
        if (row === rows || i === sides) continue;
        const [a, b] = [first + row * (sides + 1) + i, first + (row + 1) * (sides + 1) + i];
        this.triangles(a, b, b + 1, a, b + 1, a + 1);
      }
    }
    return this;
  }

  /** A ring lying around the origin, `inner` to `outer`, 0 to `height`. */
  ring(inner, outer, height, sides = 48) {
    for (let i = 0; i < sides; i += 1) {
      const [a, b] = [(2 * Math.PI * i) / sides, (2 * Math.PI * (i + 1)) / sides];
      const at = (radius, angle, y) => [radius * Math.sin(angle), y, radius * Math.cos(angle)];
      const out = [Math.sin((a + b) / 2), 0, Math.cos((a + b) / 2)];
      const sheet = (radius, from, to, normal) => this.quad(
        [at(radius, from, 0), at(radius, to, 0), at(radius, to, height), at(radius, from, height)], normal,
      );
      sheet(outer, a, b, out);
      sheet(inner, b, a, out.map((value) => -value));
      this.quad([at(inner, b, 0), at(outer, b, 0), at(outer, a, 0), at(inner, a, 0)], [0, -1, 0]);
      this.quad(
        [at(inner, a, height), at(outer, a, height), at(outer, b, height), at(inner, b, height)], [0, 1, 0],
      );
    }
    return this;
  }

  /** A plate with round corners around the origin, facing z; only its faces towards and away, and its rim. */
  plate(width, height, depth, radius, places = null) {
    const outline = [];
    for (const [sx, sy, start] of [[1, 1, 0], [-1, 1, 1], [-1, -1, 2], [1, -1, 3]]) {
      for (let i = 0; i <= 6; i += 1) {
        const angle = (Math.PI / 2) * (start + i / 6);
        const out = [Math.cos(angle), Math.sin(angle)];
        outline.push({
          at: [sx * (width / 2 - radius) + radius * out[0], sy * (height / 2 - radius) + radius * out[1]],
          out,
        });
      }
    }
    const face = (z, side) => {
      const corners = outline.map(({ at: [x, y] }) => this.vertex(
        [x, y, z], [0, 0, side], places?.(0.5 + x / width, 0.5 - y / height),
      ));
      for (let i = 1; i + 1 < corners.length; i += 1) {
        const [b, c] = side > 0 ? [i, i + 1] : [i + 1, i];
        this.triangles(corners[0], corners[b], corners[c]);
      }
    };
    face(depth / 2, 1);
    if (places) return this;
    face(-depth / 2, -1);
    outline.forEach((from, i) => {
      const to = outline[(i + 1) % outline.length];
      const rim = ({ at: [x, y], out: [nx, ny] }, z) => this.vertex([x, y, z], [nx, ny, 0]);
      const [a, b, c, d] = [rim(from, -depth / 2), rim(to, -depth / 2), rim(to, depth / 2), rim(from, depth / 2)];
      this.triangles(a, b, c, a, c, d);
    });
    return this;
  }
}
