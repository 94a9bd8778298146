// Light scattered by a diffractive surface, from a table that Aureole wrote.
//
// h = to_light + to_eye is not normalised; its components along the tangent and the bitangent, each in [-2, 2],
// find the table's colour. Row 0 of the table is the largest h along the bitangent, column 0 the smallest along
// the tangent. Define AUREOLE_ROW_0_BELOW where the loader stores row 0 last (three.js' EXRLoader does).
// Every direction is a unit vector away from the surface. The colours hold the light's own spectrum: multiply
// them by a neutral radiance. Load the table as float RGB, without mipmaps, without any change of colour.

uniform highp sampler2D aureole_table;
uniform float aureole_scale;       // what one unit of the texture stands for, 1/sr
uniform float aureole_half_range;  // |h| at the table's border
uniform float aureole_warp;        // h = half_range * sign(u) * |u|^warp

const float AUREOLE_PI = 3.14159265358979;

vec2 aureole_warped(vec2 h) {
  return sign(h) * pow(abs(h) / aureole_half_range, vec2(1.0 / aureole_warp));
}

// S_d(h), blended between the four nearest samples; the first and the last sample lie on the border, beyond
// which there is nothing.
vec3 aureole_pattern(vec2 h) {
  if (any(greaterThan(abs(h), vec2(aureole_half_range)))) return vec3(0.0);
  ivec2 size = textureSize(aureole_table, 0);
  vec2 u = aureole_warped(h);
#ifndef AUREOLE_ROW_0_BELOW
  u.y = -u.y;
#endif
  vec2 place = 0.5 * (u + 1.0) * vec2(size - 1);
  ivec2 first = min(ivec2(place), size - 2);
  vec2 part = place - vec2(first);
  vec3 low = mix(texelFetch(aureole_table, first, 0).rgb, texelFetch(aureole_table, first + ivec2(1, 0), 0).rgb,
                 part.x);
  vec3 high = mix(texelFetch(aureole_table, first + ivec2(0, 1), 0).rgb,
                  texelFetch(aureole_table, first + ivec2(1, 1), 0).rgb, part.x);
  return aureole_scale * mix(low, high, part.y);
}

// Schlick's reflectance at the cosine between a direction and the half vector.
vec3 aureole_fresnel(float cosine, vec3 f0) {
  return f0 + (1.0 - f0) * pow(1.0 - clamp(cosine, 0.0, 1.0), 5.0);
}

// The diffracted part of the BRDF, 4 pi^2 F^2 G S_d(h) with G = 1 (surface paper, Eq. 10), in 1/sr.
vec3 aureole_diffraction(vec3 to_light, vec3 to_eye, vec3 tangent, vec3 bitangent, vec3 f0) {
  vec3 h = to_light + to_eye;
  vec3 fresnel = aureole_fresnel(0.5 * length(h), f0);
  return 4.0 * AUREOLE_PI * AUREOLE_PI * fresnel * fresnel
         * aureole_pattern(vec2(dot(h, tangent), dot(h, bitangent)));
}

// Cook and Torrance's facets with Beckmann's distribution, without Fresnel's factor, in 1/sr.
float aureole_facets(vec3 to_light, vec3 to_eye, vec3 normal, float roughness) {
  vec3 h = to_light + to_eye;
  float oh = 0.5 * length(h);
  float nh = min(dot(normal, h) / (2.0 * oh), 1.0), ni = dot(normal, to_light), no = dot(normal, to_eye);
  if (min(ni, no) <= 0.0) return 0.0;
  float c2 = nh * nh, m2 = roughness * roughness;
  float spread = exp(-(1.0 - c2) / (c2 * m2)) / (AUREOLE_PI * m2 * c2 * c2);
  return spread * min(1.0, 2.0 * nh * min(ni, no) / oh) / (4.0 * ni * no);
}
