// What the graphics processor runs. Light is added up in linear colours: a square root at the end
// makes them what a screen wants.

const HEAD = `#version 300 es
precision highp float;
uniform mat4 model, view, projection;
`;

/** Solid things under a sun, a sky and a ground. */
export const SOLID = {
  vertex: `${HEAD}
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec4 colour;
layout(location = 3) in vec2 place;
out vec3 v_world, v_normal;
out vec4 v_colour;
out vec2 v_place;
void main() {
  vec4 world = model * vec4(position, 1.0);
  v_world = world.xyz;
  v_normal = mat3(model) * normal;
  v_colour = colour;
  v_place = place;
  gl_Position = projection * view * world;
}`,
  // The fourth of a colour is its shine: 0 matt, 1 polished, 2 a light of its own.
  fragment: `${HEAD}
uniform vec3 eye, sun, sunlight, skylight, groundlight, haze;
uniform float hazy;
uniform sampler2D picture;
in vec3 v_world, v_normal;
in vec4 v_colour;
in vec2 v_place;
out vec4 pixel;
void main() {
  vec3 base = v_colour.rgb * texture(picture, v_place).rgb;
  base *= base;
  vec3 n = normalize(v_normal);
  vec3 to_eye = eye - v_world;
  float far = length(to_eye);
  vec3 half_way = normalize(to_eye / far + sun);
  float shine = min(v_colour.a, 1.0);
  float facing = max(dot(n, sun), 0.0);
  vec3 lit = base * (mix(groundlight, skylight, 0.5 + 0.5 * n.y) + sunlight * facing);
  lit += sunlight * shine * pow(max(dot(n, half_way), 0.0), mix(12.0, 90.0, shine)) * step(0.0001, facing);
  lit = mix(lit, base * 1.6, step(1.5, v_colour.a));
  lit = mix(lit, haze, 1.0 - exp(-far * hazy));
  pixel = vec4(sqrt(lit), 1.0);
}`,
};

/** One colour: shadows. */
export const PLAIN = {
  vertex: `${HEAD}
layout(location = 0) in vec3 position;
void main() { gl_Position = projection * view * model * vec4(position, 1.0); }`,
  fragment: `${HEAD}
uniform vec4 tint;
out vec4 pixel;
void main() { pixel = tint; }`,
};

/** The ground: rings every `ring` millimetres and a spoke every 30°, fading out at `end`. */
export const GROUND = {
  vertex: `${HEAD}
layout(location = 0) in vec3 position;
out vec3 v_world;
void main() {
  v_world = (model * vec4(position, 1.0)).xyz;
  gl_Position = projection * view * vec4(v_world, 1.0);
}`,
  fragment: `${HEAD}
uniform vec3 line, ground;
uniform float ring, end, solid;
in vec3 v_world;
out vec4 pixel;
float drawn(float value, float width) {
  float wide = fwidth(value) * width;
  float off = abs(fract(value + 0.5) - 0.5);
  return (1.0 - smoothstep(wide * 0.5, wide * 1.5, off)) * clamp(0.35 / wide, 0.0, 1.0);
}
void main() {
  vec2 p = v_world.xz;
  float far = length(p);
  // The angle has a seam behind, where its derivative must not be taken across.
  float angle = atan(abs(p.x), -p.y);
  float spokes = drawn(angle * 6.0 / 3.14159265, 0.9) * smoothstep(ring * 0.8, ring, far);
  float lines = max(drawn(far / ring, 0.9), spokes);
  float fade = 1.0 - smoothstep(end * 0.35, end, far);
  float alpha = mix(lines * fade, 1.0, solid);
  vec3 colour = mix(ground, line, mix(1.0, lines * fade, solid));
  pixel = vec4(colour, 1.0) * alpha;
}`,
};

/** Behind everything: where each pixel looks, made of the matrices. */
export const SKY = {
  vertex: `${HEAD}
out vec3 v_ray;
void main() {
  vec2 corner = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
  vec2 slope = (corner + vec2(projection[2][0], projection[2][1]))
    / vec2(projection[0][0], projection[1][1]);
  v_ray = transpose(mat3(view)) * vec3(slope, -1.0);
  gl_Position = vec4(corner, 0.0, 1.0);
}`,
  fragment: `${HEAD}
uniform vec3 zenith, horizon, sun;
uniform float starry;
in vec3 v_ray;
out vec4 pixel;
void main() {
  vec3 ray = normalize(v_ray);
  float up = max(ray.y, 0.0);
  vec3 colour = mix(horizon, zenith, pow(up, 0.55));
  float near = max(dot(ray, sun), 0.0);
  colour += vec3(1.0, 0.8, 0.5) * (pow(near, 900.0) + 0.18 * pow(near, 12.0)) * (1.0 - 0.7 * starry);
  vec3 cell = floor(ray * 80.0);
  float chance = fract(sin(dot(cell, vec3(12.9898, 78.233, 37.719))) * 43758.5453);
  float spot = 1.0 - smoothstep(0.1, 0.45, length(fract(ray * 80.0) - 0.5));
  colour += starry * step(0.985, chance) * spot * up * 1.5;
  pixel = vec4(colour, 1.0);
}`,
};
