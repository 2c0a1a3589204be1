#include "manipulators/render/shaders.h"

namespace render::shaders {

namespace {

constexpr const char* header = R"(#version 330 core
layout(std140) uniform Frame {
  mat4 clip_from_world;
  mat4 shadow_from_world;   // into the left part of the shadow map
  mat4 near_from_world;     // into its right part, where shadows near the camera are finer
  vec4 ray_centre;          // view ray of unit depth through the middle of the picture
  vec4 ray_right;           // its change toward the right edge
  vec4 ray_down;            // its change toward the lower edge
  vec4 eye;                 // camera position; w: time
  vec4 zenith;              // linear colours; w: ambient strength
  vec4 horizon;             // w: distance at which the ground has faded into the horizon
  vec4 earth;               // w: ground height
  vec4 picture;             // width, height, 1/width, 1/height
  vec4 shadow;              // what keeps shadows off surfaces, in world; texel size in map, strength, kind of ground
  vec4 near_shadow;         // what keeps shadows off surfaces, in world; share of the map that is one part
  vec4 lights;              // count, -, -, occlusion strength
  vec4 lens;                // focal length in picture heights
  vec4 light_toward[6];     // w: 1 distant, 0 near
  vec4 light_color[6];
};

// the display's gamma, x^(1/2.2), by square roots: within 0.003 of the power, and much cheaper
vec3 displayed(vec3 x) {
  vec3 a = sqrt(x);
  vec3 b = sqrt(a);
  return 0.585122 * a + 0.783140 * b - 0.368263 * sqrt(b);
}

// the way back, a cubic fit to the sRGB curve
vec3 linear(vec3 x) { return x * (x * (x * 0.305306 + 0.682171) + 0.012523); }

vec3 ray_at(vec2 at) { return ray_centre.xyz + ray_right.xyz * at.x + ray_down.xyz * at.y; }
)";

constexpr const char* light_functions = R"(
uniform sampler2DShadow shadow_map;
uniform sampler2D occlusion_map;

// filmic curve of K. Narkowicz (2016), a fit to the ACES reference
vec3 developed(vec3 x) {
  x *= 0.74;
  return displayed(clamp(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14), 0.0, 1.0));
}

float key_visibility(vec3 p, vec3 n, float slope) {
  vec3 off = n * (1.2 + 2.0 * slope);
  vec3 far = (shadow_from_world * vec4(p + off * shadow.x, 1.0)).xyz;
  vec3 near = (near_from_world * vec4(p + off * near_shadow.x, 1.0)).xyz;
  vec3 in_near = abs(near - 0.5), in_far = abs(far - 0.5);
  bool is_near = max(max(in_near.x, in_near.y), in_near.z) < 0.495;
  if (!is_near && max(max(in_far.x, in_far.y), in_far.z) > 0.499) return 1.0;
  vec3 s = is_near ? near : far;
  s.x = s.x * near_shadow.y + (is_near ? 0.5 : 0.0);
  float t = shadow.y * 0.9;
  float h = t * near_shadow.y;
  float sum = texture(shadow_map, s + vec3(h, 0.35 * t, 0.0)) + texture(shadow_map, s + vec3(-h, -0.35 * t, 0.0)) +
              texture(shadow_map, s + vec3(-0.35 * h, t, 0.0)) + texture(shadow_map, s + vec3(0.35 * h, -t, 0.0));
  return mix(1.0, sum * 0.25, shadow.z);
}

float seen_sky(vec2 at) { return mix(1.0, texture(occlusion_map, at * picture.zw).r, lights.w); }

vec3 sky_color(vec3 d) {
  float up = max(d.y, 0.0);
  float low = 1.0 - up;
  float low2 = low * low;
  vec3 sky = mix(zenith.rgb, horizon.rgb, low2 * low2);
  float sun = max(dot(d, light_toward[0].xyz), 0.0) * light_toward[0].w;
  float glow = sun * sun;
  glow *= glow;
  glow *= glow;
  glow *= glow;
  return sky + light_color[0].rgb * (0.05 * glow);
}

// light that leaves a surface point toward the eye; n and v have unit length, albedo is linear
vec3 shaded(vec3 p, vec3 n, vec3 v, vec3 albedo, float roughness, float sheen, float skin, float sky) {
  float nv = clamp(dot(n, v), 0.0, 1.0);
  float alpha = roughness * roughness;
  float power = 2.0 / max(alpha * alpha, 1e-3) - 2.0;
  float grazing = 1.0 - nv;
  float fresnel = grazing * grazing;
  fresnel *= fresnel;
  vec3 wrap = skin * vec3(0.28, 0.11, 0.06);
  vec3 unwrap = 1.0 / (1.0 + wrap);
  vec3 diffuse = vec3(0.0);
  vec3 glossy = vec3(0.0);
  int count = int(lights.x);
  for (int i = 0; i < count; ++i) {
    vec3 l = light_toward[i].xyz;
    float gain = 1.0;
    if (light_toward[i].w < 0.5) {
      l -= p;
      float d2 = dot(l, l);
      l *= inversesqrt(max(d2, 1e-6));
      gain = 1.0 / max(d2, 0.01);
    }
    float nl = dot(n, l);
    vec3 open = vec3(gain);
    float spot = gain;
    if (i == 0) {
      float s = key_visibility(p, n, 1.0 - clamp(nl, 0.0, 1.0));
      // light that seeps through skin at the shadow's edge is red
      open = gain * (vec3(s) + skin * vec3(0.09, 0.02, 0.01) * (s * (1.0 - s) * 4.0));
      spot = gain * s;
    }
    diffuse += light_color[i].rgb * open * clamp((nl + wrap) * unwrap, 0.0, 1.0);
    vec3 h = normalize(l + v);
    float nh = dot(n, h);
    // normalized Blinn-Phong lobe as a Gaussian
    float lobe = (power + 8.0) * 0.0398 * exp2(power * (nh - 1.0) * 1.4427);
    glossy += light_color[i].rgb * (spot * clamp(nl, 0.0, 1.0) * min(lobe, 24.0));
  }
  vec3 above = zenith.rgb * 0.6 + horizon.rgb * 0.4;
  vec3 ambient = mix(earth.rgb * 0.6, above, n.y * 0.5 + 0.5) * (zenith.w * sky);
  vec3 mirrored = mix(earth.rgb * 0.5, above, clamp(2.0 * nv * n.y - v.y + 0.5, 0.0, 1.0)) * (zenith.w * sky);
  float reflectance = 0.04 + 0.36 * fresnel * (1.0 - roughness);
  vec3 color = albedo * (diffuse + ambient) + glossy * reflectance * 0.5;
  color += mirrored * (reflectance * (1.0 - 0.6 * roughness));
  return color + albedo * (sheen * fresnel * 2.0) * (ambient + diffuse * 0.35);
}
)";

constexpr const char* surface_outputs = R"(
layout(location = 0) out vec4 color_out;     // sRGB; skin in 1 bit, roughness in 4, sheen in 3
layout(location = 1) out vec4 geometry_out;  // normal, depth along the view [m]
uniform vec4 base;      // sRGB colour, opacity
uniform vec4 surface;   // x: the eight bits above; for eyes: iris, pupil
)";

}  // namespace

std::string surface_vertex() {
  return std::string(header) + R"(
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec4 color;
uniform mat4 world_from_geometry;
uniform mat3 normal_from_geometry;
out vec3 p_W;
out vec3 n_W;
out vec3 p_G;
out vec4 tint;
void main() {
  vec4 p = world_from_geometry * vec4(position, 1.0);
  p_W = p.xyz;
  n_W = normal_from_geometry * normal;
  p_G = position;
  tint = color;
  gl_Position = clip_from_world * p;
}
)";
}

std::string surface_fragment() {
  return std::string(header) + surface_outputs + R"(
in vec3 n_W;
in vec4 tint;
void main() {
  // a surface seen from behind (cloth edges, open meshes) is lit on the side that is seen
  color_out = vec4(base.rgb * tint.rgb, surface.x);
  geometry_out = vec4(gl_FrontFacing ? n_W : -n_W, 1.0 / gl_FragCoord.w);
}
)";
}

std::string eye_fragment() {
  return std::string(header) + surface_outputs + R"(
in vec3 p_W;
in vec3 n_W;
in vec3 p_G;
uniform mat3 normal_from_geometry;

float hash(float x) { return fract(sin(x * 12.9898) * 43758.5453); }
float noise(float x) { float i = floor(x), f = x - i; return mix(hash(i), hash(i + 1.0), f * f * (3.0 - 2.0 * f)); }

void main() {
  vec3 d = normalize(p_G);
  float angle = acos(clamp(d.z, -1.0, 1.0));
  float around = atan(d.y, d.x);
  float blur = fwidth(angle) * 0.6 + 0.004;

  // white of the eye, warmer and redder toward the corners
  vec3 white = mix(vec3(0.80, 0.785, 0.77), vec3(0.74, 0.58, 0.54), smoothstep(0.6, 1.35, angle) * 0.85);
  // iris: radial fibres, a lighter ring round the pupil, a dark edge
  float r = angle / surface.x;
  float fibres = noise(around * 18.0 + 3.0) * 0.5 + noise(around * 41.0 + r * 3.0) * 0.3 + noise(around * 7.0) * 0.3;
  vec3 iris = base.rgb * (0.72 + 0.55 * fibres) * mix(1.2, 0.85, smoothstep(0.3, 1.0, r));
  iris = mix(iris, base.rgb * 0.4, smoothstep(0.76, 1.0, r) * 0.85);
  vec3 color = mix(iris, white, smoothstep(surface.x - blur, surface.x + blur + 0.015, angle));
  color = mix(color, vec3(0.03), 1.0 - smoothstep(surface.y - blur, surface.y + blur, angle));

  // the cornea bulges: its normals spread faster than the eyeball's
  float bulge = 1.0 - smoothstep(surface.x * 0.8, surface.x * 1.25, angle);
  vec3 ball = normalize(n_W);
  vec3 n = normalize(ball + normal_from_geometry * vec3(d.xy, 0.0) * (0.45 * bulge));
  // the upper lid shades the ball below it
  color *= 1.0 - 0.6 * smoothstep(-0.12, 0.20, ball.y);
  // the key light mirrored in the cornea, a little brighter than the lids would let it through: eyes live by it
  vec3 v = normalize(eye.xyz - p_W);
  vec3 to_light = light_toward[0].w > 0.5 ? light_toward[0].xyz : normalize(light_toward[0].xyz - p_W);
  vec3 lamp = normalize(to_light + vec3(0.0, -0.25, 0.0) + v * 0.35);
  float glint = dot(reflect(-v, n), lamp);
  color = mix(color, vec3(1.0), smoothstep(0.962, 0.975, glint) * bulge);
  color_out = vec4(color, 24.0 / 255.0);
  geometry_out = vec4(n, 1.0 / gl_FragCoord.w);
}
)";
}

std::string ground_vertex() {
  return std::string(header) + R"(
layout(location = 0) in vec3 position;
out vec3 p_W;
void main() {
  // a disc that follows the camera and reaches the horizon
  p_W = vec3(eye.x, earth.w, eye.z) + position * horizon.w;
  gl_Position = clip_from_world * vec4(p_W, 1.0);
}
)";
}

std::string studio_vertex() {
  return std::string(header) + light_functions + R"(
layout(location = 0) in vec3 position;
invariant gl_Position;  // two programs draw parts of one ground
out vec3 p_W;
out vec3 shade;    // with the key light
out vec3 shadow_shade;  // without it
void main() {
  p_W = vec3(eye.x, earth.w, eye.z) + position * horizon.w;
  vec3 v = normalize(eye.xyz - p_W);
  vec3 light = (zenith.rgb * 0.6 + horizon.rgb * 0.4) * zenith.w;
  for (int i = 1; i < int(lights.x); ++i) light += light_color[i].rgb * max(light_toward[i].y, 0.0);
  vec3 key = light_color[0].rgb * max(light_toward[0].y, 0.0);
  // it fades into the horizon
  float haze = smoothstep(0.0, 0.35, length(eye.xyz - p_W) / horizon.w);
  vec3 far = sky_color(vec3(-v.x, 0.0, -v.z));
  shade = developed(mix(earth.rgb * (light + key), far, haze));
  shadow_shade = developed(mix(earth.rgb * light, far, haze));
  gl_Position = clip_from_world * vec4(p_W, 1.0);
}
)";
}

std::string studio_fragment() {
  return std::string(header) + light_functions + R"(
in vec3 p_W;
in vec3 shade;
in vec3 shadow_shade;
out vec4 pixel;
void main() {
  float open = key_visibility(p_W, vec3(0.0, 1.0, 0.0), 1.0 - light_toward[0].y);
  pixel = vec4(mix(shadow_shade, shade, open) * (0.4 + 0.6 * seen_sky(gl_FragCoord.xy)), 1.0);
}
)";
}

std::string grid_fragment() {
  return std::string(header) + light_functions + R"(
in vec3 p_W;
out vec4 pixel;

// a pattern of lines, one pixel wide at least and fading out where it gets too fine
float line(float x, float period, float width, float footprint) {
  float d = abs(fract(x / period - 0.5) - 0.5) * period;
  return (1.0 - smoothstep(width, width + footprint, d)) * clamp(period / (6.0 * footprint) - 0.2, 0.0, 1.0);
}

void main() {
  vec3 v = eye.xyz - p_W;
  float distance = length(v);
  v /= distance;
  vec3 albedo = earth.rgb;
  float footprint = distance * picture.w / lens.x / max(v.y, 0.05) + 1e-5;
  float fine = max(line(p_W.x, 0.1, 0.0008, footprint), line(p_W.z, 0.1, 0.0008, footprint));
  float coarse = max(line(p_W.x, 1.0, 0.004, footprint), line(p_W.z, 1.0, 0.004, footprint));
  albedo *= 1.0 - (0.14 * fine + 0.38 * coarse) * (shadow.w < 1.5 ? 1.0 : 0.0);
  // matt and level: only the key's visibility and the sky's differ from place to place
  vec3 light = (zenith.rgb * 0.6 + horizon.rgb * 0.4) * (zenith.w * seen_sky(gl_FragCoord.xy));
  int count = int(lights.x);
  for (int i = 0; i < count; ++i) {
    vec3 l = light_toward[i].xyz;
    float gain = 1.0;
    if (light_toward[i].w < 0.5) {
      l -= p_W;
      float d2 = dot(l, l);
      l *= inversesqrt(max(d2, 1e-6));
      gain = 1.0 / max(d2, 0.01);
    }
    if (i == 0) gain *= key_visibility(p_W, vec3(0.0, 1.0, 0.0), 1.0 - l.y);
    light += light_color[i].rgb * (gain * max(l.y, 0.0));
  }
  float haze = smoothstep(0.0, 0.35, distance / horizon.w);
  pixel = vec4(developed(mix(albedo * light, sky_color(vec3(-v.x, 0.0, -v.z)), haze)), 1.0);
}
)";
}

std::string sea_fragment() {
  return std::string(header) + light_functions + R"(
in vec3 p_W;
out vec4 pixel;

// slope of one travelling wave: direction, waves per metre times 2 pi, speed times that, steepness
vec2 wave(vec2 direction, float k, float w, float steep) {
  return direction * (cos(dot(p_W.xz, direction) * k + eye.w * w) * steep);
}

void main() {
  vec3 v = eye.xyz - p_W;
  float distance = length(v);
  v /= distance;
  vec2 slope = wave(vec2(0.91, 0.41), 0.55, 1.1, 0.07) + wave(vec2(-0.53, 0.85), 1.3, 1.7, 0.07) +
               wave(vec2(0.30, 0.95), 2.9, 2.6, 0.06) + wave(vec2(0.80, -0.60), 5.7, 3.9, 0.045);
  // flatter with distance, where a pixel covers many waves
  vec2 bent = slope / (1.0 + distance * 0.035);
  vec3 n = normalize(vec3(-bent.x, 1.0, -bent.y));
  float away = 1.0 - clamp(dot(n, v), 0.0, 1.0);
  float away2 = away * away;
  float fresnel = 0.02 + 0.98 * away2 * away2 * away;
  vec3 up = reflect(-v, n);
  up.y = abs(up.y);
  vec3 water = vec3(0.012, 0.055, 0.075) * (1.0 + 3.0 * max(slope.x, 0.0));
  float glitter = exp2(220.0 * (dot(up, light_toward[0].xyz) - 1.0)) * light_toward[0].w;
  vec3 c = mix(water, mix(horizon.rgb, zenith.rgb, clamp(up.y * 1.6, 0.0, 1.0)), fresnel);
  c += light_color[0].rgb * (glitter * 0.7);
  float haze = smoothstep(0.25, 1.0, distance / horizon.w);
  pixel = vec4(developed(mix(c, sky_color(vec3(-v.x, 0.0, -v.z)), haze)), 1.0);
}
)";
}

std::string screen_vertex() {
  return std::string(header) + R"(
out vec2 at;
out vec3 ray;
void main() {
  at = vec2(float((gl_VertexID & 1) << 2) - 1.0, float((gl_VertexID & 2) << 1) - 1.0);
  ray = ray_at(at);
  gl_Position = vec4(at, 1.0, 1.0);
}
)";
}

std::string sky_vertex() {
  return std::string(header) + light_functions + R"(
layout(location = 0) in vec3 position;
out vec3 shade;

float hash(vec2 x) { return fract(sin(dot(x, vec2(127.1, 311.7))) * 43758.5453); }
float noise(vec2 x) {
  vec2 i = floor(x), f = x - i;
  f = f * f * (3.0 - 2.0 * f);
  return mix(mix(hash(i), hash(i + vec2(1.0, 0.0)), f.x), mix(hash(i + vec2(0.0, 1.0)), hash(i + 1.0), f.x), f.y);
}

void main() {
  // the sky changes so slowly that a grid over the picture says it all
  vec3 d = normalize(ray_at(position.xy));
  vec3 sky = sky_color(d);
  // thin clouds over the sea, on a plane far above; they drift
  if (shadow.w > 2.5 && d.y > 0.0) {
    vec2 at = d.xz / (d.y + 0.12) * 1.3 + vec2(eye.w * 0.004, 3.7);
    float cover = 0.55 * noise(at) + 0.28 * noise(at * 2.1 + 5.0) + 0.17 * noise(at * 4.3 + 9.0);
    cover = smoothstep(0.42, 0.78, cover) * smoothstep(0.02, 0.22, d.y);
    sky = mix(sky, horizon.rgb * 1.12 + light_color[0].rgb * 0.06, 0.75 * cover);
  }
  shade = developed(sky);
  gl_Position = vec4(position.xy, 1.0, 1.0);
}
)";
}

std::string shade_fragment() {
  return std::string(R"(#version 330 core
in vec3 shade;
out vec4 pixel;
void main() { pixel = vec4(shade, 1.0); }
)");
}

std::string light_fragment() {
  return std::string(header) + light_functions + R"(
uniform sampler2D color_map;
uniform sampler2D geometry_map;
in vec3 ray;
out vec4 pixel;
void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  vec4 geometry = texelFetch(geometry_map, at, 0);
  vec4 color = texelFetch(color_map, at, 0);
  vec3 step = ray * geometry.w;
  vec3 v = -normalize(step);
  float code = floor(color.a * 255.0 + 0.5);
  float skin = floor(code * (1.0 / 128.0));
  code -= skin * 128.0;
  float roughness = floor(code * 0.125);
  float sheen = (code - roughness * 8.0) * (1.0 / 7.0);
  pixel = vec4(developed(shaded(eye.xyz + step, normalize(geometry.xyz), v, linear(color.rgb),
                                roughness * (1.0 / 15.0), sheen, skin, seen_sky(gl_FragCoord.xy))), 1.0);
}
)";
}

std::string clear_fragment() {
  return std::string(header) + light_functions + R"(
in vec3 p_W;
in vec3 n_W;
in vec4 tint;
uniform vec4 base;
uniform vec4 surface;   // z: roughness, w: skin
out vec4 pixel;
void main() {
  vec3 v = normalize(eye.xyz - p_W);
  vec3 n = normalize(n_W);
  if (!gl_FrontFacing) n = -n;
  pixel = vec4(developed(shaded(p_W, n, v, linear(base.rgb * tint.rgb), surface.z, 0.0, surface.w, 1.0)),
               base.a * tint.a);
}
)";
}

std::string flat_fragment() {
  return std::string(header) + R"(
in vec4 tint;
uniform vec4 base;
out vec4 pixel;
void main() { pixel = vec4(base.rgb * tint.rgb, base.a * tint.a); }
)";
}

std::string depth_vertex() {
  return std::string(R"(#version 330 core
layout(location = 0) in vec3 position;
uniform mat4 clip_from_geometry;
void main() { gl_Position = clip_from_geometry * vec4(position, 1.0); }
)");
}

std::string depth_fragment() {
  return std::string(R"(#version 330 core
void main() {}
)");
}

std::string occlusion_fragment() {
  return std::string(header) + R"(
uniform sampler2D geometry_map;
in vec2 at;
in vec3 ray;
out float open;

// where nothing was drawn there is the ground, or nothing at all
float ground_depth(vec3 ray) {
  float t = (earth.w - eye.y) / ray.y;
  return t > 0.0 && shadow.w > 0.5 ? t : 1e4;
}

void main() {
  vec2 uv = at * 0.5 + 0.5;
  vec4 own = textureLod(geometry_map, uv, 0.0);
  bool on_ground = own.w <= 0.0;
  float z = on_ground ? ground_depth(ray) : own.w;
  vec3 n = on_ground ? vec3(0.0, 1.0, 0.0) : normalize(own.xyz);
  vec3 p = ray * z;
  // the neighbourhood is 22 cm, and at most 9 % of the picture's height
  float radius = min(0.22 * lens.x / z, 0.09);
  float reach = radius * z / lens.x;
  float fade = -0.8 / (reach * reach);
  // the sample pattern turns from pixel to pixel in a 4 x 4 tile, which the blur removes
  ivec2 tile = ivec2(gl_FragCoord.xy) & 3;
  float turn = float((tile.x * 4 + tile.y) * 5 & 15) * 0.3926991;
  vec2 dir = vec2(cos(turn), sin(turn)) * radius;
  vec2 across = vec2(picture.y * picture.z, 1.0);
  float hidden = 0.0;
  for (int i = 0; i < 6; ++i) {
    // a spiral by the golden angle: each sample turns the one before by 137.5 degrees
    dir = vec2(dir.x * -0.7373688 - dir.y * 0.6754903, dir.x * 0.6754903 + dir.y * -0.7373688);
    vec2 there = uv + dir * across * ((float(i) + 0.6) * (1.0 / 6.0));
    float zt = textureLod(geometry_map, there, 0.0).w;
    vec3 rt = ray_at(there * 2.0 - 1.0);
    vec3 d = rt * (zt > 0.0 ? zt : ground_depth(rt)) - p;
    float d2 = dot(d, d);
    // elevation of the neighbour over the tangent plane, fading out beyond the neighbourhood
    float lift = dot(d, n) * inversesqrt(d2 + 1e-9) - 0.12;
    hidden += clamp(lift, 0.0, 1.0) * clamp(1.6 + d2 * fade, 0.0, 1.0);
  }
  open = z > 25.0 ? 1.0 : clamp(1.0 - hidden * 0.35, 0.0, 1.0);
}
)";
}

std::string blur_fragment() {
  return std::string(header) + R"(
uniform sampler2D occlusion_map;
in vec2 at;
out float open;
void main() {
  vec2 uv = at * 0.5 + 0.5;
  // four linear taps between texels cover the 4 x 4 tile exactly
  vec2 t = picture.zw;
  open = 0.25 * (textureLod(occlusion_map, uv + vec2(-1.5, -1.5) * t, 0.0).r +
                 textureLod(occlusion_map, uv + vec2(0.5, -1.5) * t, 0.0).r +
                 textureLod(occlusion_map, uv + vec2(-1.5, 0.5) * t, 0.0).r +
                 textureLod(occlusion_map, uv + vec2(0.5, 0.5) * t, 0.0).r);
}
)";
}

}  // namespace render::shaders
