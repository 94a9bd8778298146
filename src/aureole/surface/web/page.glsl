// One object under one small lamp. The page's axes are the picture's: x right, y up, z toward the eye.
uniform vec2 view_size;
uniform vec3 eye;
uniform float view_slope;                  // tan of half the vertical field of view
uniform mat3 turn;                         // object to page
uniform int shape;                         // 0 plane, 1 disc, 2 cylinder
uniform vec2 extent;                       // half width and height; outer and inner radius; radius, half height
uniform float sweep;                       // angle of a cylinder, about +z
uniform bool radial;                       // a disc's tangents
uniform vec3 lamp;
uniform bool lamp_distant, stam, soft;
uniform vec3 lamp_light;
uniform float exposure, specular, roughness, diffraction;
uniform vec3 diffuse, background;
uniform vec2 inverse_window;               // 1 / (2 sigma^2)
uniform int samples;
uniform vec3 fresnel[65];                  // over the cosine between light and half vector
out vec4 shown;

struct Hit { bool found; vec3 at, normal, tangent, bitangent; };

Hit on_plane(vec3 origin, vec3 ray) {
  Hit hit;
  float way = -origin.z / ray.z;
  hit.at = origin + way * ray;
  hit.normal = vec3(0.0, 0.0, sign(origin.z));
  float radius = length(hit.at.xy);
  hit.tangent = shape == 1 && radial ? vec3(hit.at.xy / max(radius, 1e-9), 0.0) : vec3(1.0, 0.0, 0.0);
  hit.bitangent = vec3(-hit.tangent.y, hit.tangent.x, 0.0);
  bool inside = shape == 1 ? radius <= extent.x && radius >= extent.y
                           : all(lessThanEqual(abs(hit.at.xy), extent));
  hit.found = way > 0.0 && inside;
  return hit;
}

// The nearer wall within height and sweep: from outside, or the inner one seen through an open side.
Hit on_cylinder(vec3 origin, vec3 ray) {
  Hit hit;
  hit.found = false;
  float a = dot(ray.xz, ray.xz), b = dot(origin.xz, ray.xz);
  float root = b * b - a * (dot(origin.xz, origin.xz) - extent.x * extent.x);
  for (float side = -1.0; side < 2.0; side += 2.0) {
    float way = (-b + side * sqrt(max(root, 0.0))) / a;
    hit.at = origin + way * ray;
    hit.found = root > 0.0 && way > 0.0 && abs(hit.at.y) <= extent.y
                && abs(atan(hit.at.x, hit.at.z)) <= 0.5 * sweep;
    if (hit.found) break;
  }
  vec3 outward = vec3(hit.at.x, 0.0, hit.at.z) / extent.x;
  hit.normal = dot(outward, ray) < 0.0 ? outward : -outward;
  hit.tangent = vec3(outward.z, 0.0, -outward.x);
  hit.bitangent = vec3(0.0, 1.0, 0.0);
  return hit;
}

vec3 mirrored(float cosine) {
  float place = clamp(cosine, 0.0, 1.0) * 64.0;
  int cell = min(int(place), 63);
  return mix(fresnel[cell], fresnel[cell + 1], place - float(cell));
}

// What the surface sends to the eye at a place of the picture, and 1 where it is.
vec4 seen(vec2 pixel) {
  vec2 place = (2.0 * pixel - view_size) / view_size.y * view_slope;
  mat3 back = transpose(turn);
  vec3 origin = back * eye, ray = back * normalize(vec3(place, -1.0));
  Hit hit;
  if (shape == 2) hit = on_cylinder(origin, ray); else hit = on_plane(origin, ray);
  if (!hit.found) return vec4(0.0);
  vec3 way = back * lamp - (lamp_distant ? vec3(0.0) : hit.at);
  vec3 to_light = normalize(way), h = to_light - ray;
  float ni = dot(hit.normal, to_light), no = -dot(hit.normal, ray), oh = 0.5 * length(h);
  if (ni <= 0.0 || no <= 0.0) return vec4(vec3(0.0), 1.0);
  vec2 h_tb = vec2(dot(h, hit.tangent), dot(h, hit.bitangent));
  float gain = diffraction * exp(-dot(inverse_window, h_tb * h_tb)) * (stam ? oh * oh * oh * oh / (ni * no) : 1.0);
  vec3 mirror = mirrored(oh);
  vec3 brdf = diffuse / AUREOLE_PI
              + specular * mirror * aureole_facets(to_light, -ray, hit.normal, roughness)
              + gain * 4.0 * AUREOLE_PI * AUREOLE_PI * mirror * mirror * aureole_pattern(h_tb);
  return vec4(brdf * ni * lamp_light / (lamp_distant ? 1.0 : dot(way, way)), 1.0);
}

vec3 encoded(vec3 linear) {
  vec3 light = clamp(linear, 0.0, 1.0);
  return mix(12.92 * light, 1.055 * pow(light, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, light));
}

// Colours beyond what a screen shows: paler until no part is negative, then whiter the brighter they are.
vec3 softened(vec3 light) {
  float grey = max(dot(light, vec3(0.2126, 0.7152, 0.0722)), 0.0);
  float low = min(light.r, min(light.g, light.b));
  if (low < 0.0) light = mix(light, vec3(grey), low / (low - max(grey, 1e-6)));
  float top = max(light.r, max(light.g, light.b));
  return top > 1.0 ? mix(vec3(1.0), light / top, inversesqrt(top)) : light;
}

void main() {
  vec4 total = vec4(0.0);
  vec2 corner = gl_FragCoord.xy - 0.5;
  for (int k = 0; k < samples * samples; k++) {
    total += seen(corner + (vec2(k % samples, k / samples) + 0.5) / float(samples));
  }
  total /= float(samples * samples);
  vec3 light = total.rgb * exposure;
  shown = vec4(encoded((soft ? softened(light) : light) + background * (1.0 - total.a)), total.a);
}
