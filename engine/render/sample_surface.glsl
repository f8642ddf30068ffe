// What a sample of the screen (subpixel_edges.h) says of its surface, beside depth, in 8 bits a channel. rgb: square root
// of the albedo, where a texture or a pattern makes it differ from place to place, else 0. Alpha: emitting_surface().
#include "engine/scene/instance_shared.h"

// Which surface that emits a sample shows: 0 is none. They may share a plane with what they are set into, and are far
// brighter. Rows that have one number are not told apart.
float emitting_surface(uint surface) {
    return (surface & surface_emits) == 0u ? 0.0 : float(1u + surface_row(surface) % 255u) / 255.0;
}

// Black is told from 0.
vec4 detailed_sample(vec3 albedo) { return vec4(max(sqrt(albedo), 1.0 / 255.0), 0.0); }
bool is_detailed(vec4 surface_sample) { return surface_sample.r > 0.0; }
