#version 460
#extension GL_GOOGLE_include_directive : require
#include "engine/scene/instance_shared.h"
#include "engine/scene/material_shared.h"
#include "engine/scene/pattern_shared.h"

layout(constant_id = 0) const uint has_holes = 0;
layout(constant_id = 1) const uint pattern_kind = pattern_none;
layout(constant_id = 2) const uint is_textured = 0;

layout(set = 0, binding = 2) readonly buffer Rows { InstanceRow rows[]; };
layout(set = 0, binding = 3) readonly buffer Materials { MaterialRow materials[]; };
layout(set = 0, binding = 4) uniform sampler2D colour_texture;
layout(push_constant) uniform Constants { DrawConstants draw; };

layout(location = 0) in vec2 in_place;
layout(location = 1) in vec4 in_colour;
layout(location = 2) in vec3 in_local;
layout(location = 3) in flat vec4 in_pattern;
layout(location = 0) out vec4 out_surface; // sample_surface.glsl

#include "engine/render/pattern_albedo.glsl"
#include "engine/render/sample_surface.glsl"

void main() {
    vec4 colour = in_colour;
    if (has_holes != 0 || is_textured != 0)
        colour *= texture(colour_texture, in_place);
    if (has_holes != 0) { // of what is blended nothing is left out (the cutoff is below 0): the picture is blended by now
        const vec4 factors = materials[rows[surface_row(draw.surface)].material.x].factors;
        if (colour.a * factors.x < factors.y)
            discard;
    }
    if (pattern_kind != pattern_none)
        out_surface = detailed_sample(pattern_albedo(in_local, in_pattern));
    else if (is_textured != 0)
        out_surface = detailed_sample(base_colour_of(draw) * colour.rgb);
    else
        out_surface = vec4(vec3(0.0), emitting_surface(draw.surface));
}
