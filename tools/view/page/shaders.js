// Rods are quads that face the eye and are shaded as cylinders, particles likewise as spheres.

const POINT = `
uniform sampler2D points;
vec4 point(uint i) { return texelFetch(points, ivec2(int(i) % 1024, int(i) / 1024), 0); }
`;
const VIEW = `
uniform mat4 view, projection;
uniform vec3 shift;
uniform float alpha;
uniform vec4 flatten; // a plane (normal, offset) onto which shadows fall; w > 1e8: none
vec3 seen(vec3 p) {
  if (flatten.w < 1e8) p -= (dot(flatten.xyz, p) - flatten.w) * flatten.xyz;
  return (view * vec4(p + shift, 1)).xyz;
}
`;
const LIGHT = `
uniform float flatColor;
vec3 lit(vec3 color, vec3 normal) {
  vec3 n = normalize(normal);
  float key = max(dot(n, normalize(vec3(0.35, 0.75, 0.55))), 0.0);
  float rim = pow(1.0 - max(n.z, 0.0), 2.0);
  vec3 shaded = color * (0.48 + 0.6 * key) + 0.10 * pow(key, 24.0) - 0.10 * rim;
  return mix(shaded, color, flatColor);
}
`;

export const rodVertex = `
layout(location = 0) in uvec2 ends;
layout(location = 1) in float radius;
layout(location = 2) in vec4 tint;
${POINT}${VIEW}
uniform float scale;
out vec3 across, facing;
out float side;
out vec4 color;
void main() {
  int corner = gl_VertexID;
  vec3 a = seen(point(ends.x).xyz), b = seen(point(ends.y).xyz);
  vec3 along = b - a;
  along = length(along) > 1e-12 ? normalize(along) : vec3(1, 0, 0);
  vec3 toEye = normalize(-(a + b));
  across = cross(along, toEye);
  across = length(across) > 1e-6 ? normalize(across) : vec3(0, 1, 0);
  facing = normalize(cross(across, along));
  if (dot(facing, toEye) < 0.0) facing = -facing;
  side = (corner & 1) == 0 ? -1.0 : 1.0;
  vec3 p = ((corner & 2) == 0 ? a : b) + side * radius * scale * across;
  color = tint;
  gl_Position = projection * vec4(p, 1);
  if (tint.a == 0.0) gl_Position = vec4(2, 2, 2, 1);
}`;
export const rodFragment = `
${LIGHT}
uniform float alpha;
in vec3 across, facing;
in float side;
in vec4 color;
out vec4 pixel;
void main() {
  vec3 normal = side * across + sqrt(max(0.0, 1.0 - side * side)) * facing;
  pixel = vec4(lit(color.rgb, normal), color.a * alpha);
}`;

export const ballVertex = `
layout(location = 0) in uint number;
layout(location = 1) in float radius;
layout(location = 2) in vec4 tint;
${POINT}${VIEW}
uniform float scale;
out vec2 at;
out vec4 color;
void main() {
  at = vec2((gl_VertexID & 1) == 0 ? -1.0 : 1.0, (gl_VertexID & 2) == 0 ? -1.0 : 1.0);
  vec3 center = seen(point(number).xyz);
  float r = radius * scale;
  color = tint;
  // As near as it is at its own size, so that one within another is not behind it.
  gl_Position = projection * vec4(center + vec3(at * r, 0.5 * radius), 1);
  if (tint.a == 0.0) gl_Position = vec4(2, 2, 2, 1);
}`;
export const ballFragment = `
${LIGHT}
uniform float alpha;
in vec2 at;
in vec4 color;
out vec4 pixel;
void main() {
  float r2 = dot(at, at);
  if (r2 > 1.0) discard;
  pixel = vec4(lit(color.rgb, vec3(at, sqrt(1.0 - r2))), color.a * alpha);
}`;

export const solidVertex = `
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
${VIEW}
out vec3 turned;
void main() {
  turned = mat3(view) * normal;
  gl_Position = projection * vec4(seen(position), 1);
}`;
export const solidFragment = `
${LIGHT}
uniform vec4 tint;
in vec3 turned;
out vec4 pixel;
void main() {
  vec3 n = normalize(turned);
  pixel = vec4(lit(tint.rgb, n.z < 0.0 ? -n : n), tint.a);
}`;

export const gridVertex = `
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
${VIEW}
out vec3 world;
void main() {
  world = position;
  gl_Position = projection * vec4(seen(position), 1);
}`;
export const gridFragment = `
uniform vec4 tint;
uniform vec3 center, u, v;
uniform float cell, extent;
in vec3 world;
out vec4 pixel;
float lines(vec2 p, float size) {
  vec2 q = p / size, w = fwidth(q);
  vec2 d = abs(fract(q - 0.5) - 0.5) / max(w, 1e-6);
  vec2 thin = clamp(1.1 - d, 0.0, 1.0) * clamp(0.35 / max(w, 1e-6), 0.0, 1.0);
  return max(thin.x, thin.y);
}
void main() {
  vec2 p = vec2(dot(world, u), dot(world, v));
  float fade = 1.0 - smoothstep(0.35, 1.0, length(world - center) / extent);
  float strength = 0.5 * lines(p, cell) + 0.5 * lines(p, 5.0 * cell);
  pixel = vec4(tint.rgb, tint.a * fade * (0.10 + 0.9 * strength));
}`;
