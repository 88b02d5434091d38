// The few things that are wanted of WebGL2: programs, meshes, textures.

/** Numbers of a vertex: position 3, normal 3, colour and shine 4, place in the texture 2. */
export const VERTEX = 12;
const LAYOUT = [[0, 3, 0], [1, 3, 3], [2, 4, 6], [3, 2, 10]];

/** What takes an array of so many numbers. */
const SETTERS = { 2: "uniform2fv", 3: "uniform3fv", 4: "uniform4fv" };

export class Program {
  constructor(gl, { vertex, fragment }) {
    this.gl = gl;
    this.program = gl.createProgram();
    for (const [type, source] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(type);
      gl.shaderSource(shader, source);
      gl.compileShader(shader);
      gl.attachShader(this.program, shader);
    }
    gl.linkProgram(this.program);
    if (!gl.getProgramParameter(this.program, gl.LINK_STATUS) && !gl.isContextLost()) {
      throw new Error(`a shader does not build: ${gl.getProgramInfoLog(this.program)}`);
    }
    this.places = {};
    const count = gl.getProgramParameter(this.program, gl.ACTIVE_UNIFORMS) ?? 0;
    for (let i = 0; i < count; i += 1) {
      const { name } = gl.getActiveUniform(this.program, i);
      this.places[name] = gl.getUniformLocation(this.program, name);
    }
    // OpenGL takes single precision; the matrices are worked out in double.
    this.single = new Float32Array(16);
  }

  use() {
    this.gl.useProgram(this.program);
  }

  matrix(name, value) {
    this.single.set(value);
    this.gl.uniformMatrix4fv(this.places[name] ?? null, false, this.single);
  }

  /** A number, or an array of two to four. */
  set(name, value) {
    const place = this.places[name] ?? null;
    if (typeof value === "number") this.gl.uniform1f(place, value);
    else this.gl[SETTERS[value.length]](place, value);
  }
}

export class Mesh {
  constructor(gl, { vertices, indices }) {
    this.gl = gl;
    this.count = indices.length;
    this.array = gl.createVertexArray();
    gl.bindVertexArray(this.array);
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(vertices), gl.STATIC_DRAW);
    for (const [place, size, start] of LAYOUT) {
      gl.enableVertexAttribArray(place);
      gl.vertexAttribPointer(place, size, gl.FLOAT, false, 4 * VERTEX, 4 * start);
    }
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, new Uint16Array(indices), gl.STATIC_DRAW);
    gl.bindVertexArray(null);
  }

  draw() {
    this.gl.bindVertexArray(this.array);
    this.gl.drawElements(this.gl.TRIANGLES, this.count, this.gl.UNSIGNED_SHORT, 0);
  }
}

/** Of a 2-D canvas, its first row at place 0. */
export function texture(gl, canvas) {
  const made = gl.createTexture();
  gl.bindTexture(gl.TEXTURE_2D, made);
  gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, gl.RGBA, gl.UNSIGNED_BYTE, canvas);
  gl.generateMipmap(gl.TEXTURE_2D);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR_MIPMAP_LINEAR);
  const sharp = gl.getExtension("EXT_texture_filter_anisotropic");
  if (sharp) gl.texParameterf(gl.TEXTURE_2D, sharp.TEXTURE_MAX_ANISOTROPY_EXT, 4);
  return made;
}

/** What has no picture on it is multiplied with this. */
export function white(gl) {
  const made = gl.createTexture();
  gl.bindTexture(gl.TEXTURE_2D, made);
  gl.texImage2D(
    gl.TEXTURE_2D, 0, gl.RGBA, 1, 1, 0, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array([255, 255, 255, 255]),
  );
  return made;
}
