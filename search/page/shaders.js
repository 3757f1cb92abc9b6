/**
 * GLSL for the figure: tapered capsules, their soft shadow on the ground, and the ground's grid.
 * Colours have premultiplied alpha, as the canvas expects.
 */

/** A capsule of two rings of vertices is stretched from a.xyz to b.xyz with radii a.w and b.w. */
export const capsuleVertex = `
attribute vec4 a, b, tint;
varying vec3 side;
varying vec4 colour;
void main() {
  float far = step(0.0, position.y);
  vec3 outward = position - vec3(0.0, far - 0.5, 0.0);
  vec3 along = b.xyz - a.xyz;
  float size = length(along);
  vec3 y = size > 1e-5 ? along / size : vec3(0.0, 1.0, 0.0);
  vec3 x = normalize(cross(abs(y.y) < 0.95 ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0), y));
  vec3 turned = mat3(x, y, cross(x, y)) * outward;
  side = mat3(viewMatrix) * turned;
  colour = tint;
  gl_Position = projectionMatrix * viewMatrix * vec4(mix(a.xyz, b.xyz, far) + turned * mix(a.w, b.w, far), 1.0);
}`;

/** Wrapped diffuse light from above the viewer's left shoulder, and a thin rim against the background. */
export const capsuleFragment = `
varying vec3 side;
varying vec4 colour;
void main() {
  vec3 n = normalize(side);
  float lit = 0.5 + 0.5 * dot(n, normalize(vec3(-0.45, 0.8, 0.5)));
  float rim = pow(1.0 - max(n.z, 0.0), 3.0);
  vec3 shaded = colour.rgb * mix(0.5, 1.16, lit * lit * (3.0 - 2.0 * lit)) + 0.12 * rim * lit;
  gl_FragColor = vec4(min(shaded, 1.0) * colour.a, colour.a);
}`;

/** A square on the ground around a bone's projection; the higher the bone, the softer its shadow. */
export const shadowVertex = `
attribute vec4 a, b;
varying vec2 at, from, to;
varying float radius, soft, fade;
void main() {
  float height = max(0.5 * (a.y + b.y), 0.0);
  soft = 0.05 + 0.16 * height;
  fade = 1.0 / (1.0 + 1.3 * height);
  radius = 0.5 * (a.w + b.w);
  from = a.xz;
  to = b.xz;
  vec2 middle = 0.5 * (from + to);
  at = middle + position.xy * (0.5 * length(to - from) + radius + soft);
  gl_Position = projectionMatrix * viewMatrix * vec4(at.x, 0.0, at.y, 1.0);
}`;

/** The distance to a segment with round ends, as a soft edge. */
export const shadowFragment = `
uniform float strength;
varying vec2 at, from, to;
varying float radius, soft, fade;
void main() {
  vec2 along = to - from, here = at - from;
  float t = clamp(dot(here, along) / max(dot(along, along), 1e-6), 0.0, 1.0);
  float edge = length(here - t * along) - radius;
  gl_FragColor = vec4(0.0, 0.0, 0.0, strength * fade * (1.0 - smoothstep(-soft, soft, edge)));
}`;

export const groundVertex = `
uniform vec2 centre;
varying vec2 at;
void main() {
  vec2 spread = position.xy * 2.6;
  at = centre + spread;
  gl_Position = projectionMatrix * viewMatrix * vec4(at.x, 0.0, at.y, 1.0);
}`;

/** Lines half a metre apart, fading outward. */
export const groundFragment = `
uniform vec2 centre;
uniform vec3 line;
varying vec2 at;
void main() {
  vec2 cell = at * 2.0, width = fwidth(cell);
  vec2 near = abs(fract(cell - 0.5) - 0.5) / max(width, 1e-4);
  float drawn = 1.0 - min(min(near.x, near.y), 1.0);
  float alpha = 0.75 * drawn * (1.0 - smoothstep(0.3, 2.4, length(at - centre)));
  gl_FragColor = vec4(line * alpha, alpha);
}`;
