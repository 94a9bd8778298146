// One object under one small lamp, seen from the z axis.
uniform vec2 view_size;
uniform float view_distance, view_slope;   // tan of half the vertical field of view
uniform mat3 turn;                         // object to world
uniform int shape;                         // 0 plane, 1 disc, 2 cylinder
uniform vec2 extent;                       // half width and height; outer and inner radius; radius, half height
uniform vec3 lamp;                         // world
uniform float lamp_power, exposure, specular, roughness, diffraction;
uniform vec3 diffuse, f0;
out vec4 shown;

struct Hit { bool found; vec3 at, normal, tangent, bitangent; };

Hit on_plane(vec3 eye, vec3 ray) {
  Hit hit;
  float way = -eye.z / ray.z;
  hit.at = eye + way * ray;
  hit.normal = vec3(0.0, 0.0, sign(eye.z));
  float radius = length(hit.at.xy);
  hit.tangent = shape == 1 ? vec3(hit.at.xy / max(radius, 1e-9), 0.0) : vec3(1.0, 0.0, 0.0);
  hit.bitangent = vec3(-hit.tangent.y, hit.tangent.x, 0.0);
  bool inside = shape == 1 ? radius <= extent.x && radius >= extent.y
                           : all(lessThanEqual(abs(hit.at.xy), extent));
  hit.found = way > 0.0 && inside;
  return hit;
}

// The nearer wall within the height: from outside, or the inner one seen through an open end.
Hit on_cylinder(vec3 eye, vec3 ray) {
  Hit hit;
  hit.found = false;
  float a = dot(ray.xz, ray.xz), b = dot(eye.xz, ray.xz), c = dot(eye.xz, eye.xz) - extent.x * extent.x;
  float root = b * b - a * c;
  for (float side = -1.0; side < 2.0; side += 2.0) {
    float way = (-b + side * sqrt(max(root, 0.0))) / a;
    hit.at = eye + way * ray;
    hit.found = root > 0.0 && way > 0.0 && abs(hit.at.y) <= extent.y;
    if (hit.found) break;
  }
  vec3 outward = vec3(hit.at.x, 0.0, hit.at.z) / extent.x;
  hit.normal = dot(outward, ray) < 0.0 ? outward : -outward;
  hit.tangent = vec3(outward.z, 0.0, -outward.x);
  hit.bitangent = vec3(0.0, 1.0, 0.0);
  return hit;
}

vec3 encoded(vec3 linear) {
  vec3 light = clamp(linear, 0.0, 1.0);
  return mix(12.92 * light, 1.055 * pow(light, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, light));
}

void main() {
  vec2 place = (2.0 * gl_FragCoord.xy - view_size) / view_size.y * view_slope;
  mat3 back = transpose(turn);
  vec3 eye = back * vec3(0.0, 0.0, view_distance);
  vec3 ray = back * normalize(vec3(place, -1.0));
  Hit hit;
  if (shape == 2) hit = on_cylinder(eye, ray); else hit = on_plane(eye, ray);
  vec3 light = vec3(0.0);
  if (hit.found) {
    vec3 way = back * lamp - hit.at;
    vec3 to_light = normalize(way);
    float cosine = dot(hit.normal, to_light);
    vec3 brdf = diffuse / AUREOLE_PI + specular * aureole_specular(to_light, -ray, hit.normal, roughness, f0)
                + diffraction * aureole_diffraction(to_light, -ray, hit.tangent, hit.bitangent, f0);
    light = cosine > 0.0 ? brdf * cosine * lamp_power / dot(way, way) : vec3(0.0);
  }
  shown = vec4(encoded(light * exposure), 1.0);
}
