#version 460
#extension GL_GOOGLE_include_directive : require
#include "engine/scene/instance_shared.h"
#include "engine/scene/material_shared.h"

layout(constant_id = 0) const uint has_holes = 0;

layout(set = 0, binding = 2) readonly buffer Rows { InstanceRow rows[]; };
layout(set = 0, binding = 3) readonly buffer Materials { MaterialRow materials[]; };
layout(set = 0, binding = 4) uniform sampler2D colour_texture;
layout(push_constant) uniform Constants { DrawConstants draw; };

layout(location = 0) in vec2 in_place;
layout(location = 1) in float in_alpha;
layout(location = 0) out float out_surface;

#include "engine/render/emitting_surface.glsl"

void main() {
    if (has_holes != 0) { // of what is blended nothing is left out (the cutoff is below 0): the picture is blended by now
        const vec4 factors = materials[rows[surface_row(draw.surface)].material.x].factors;
        if (texture(colour_texture, in_place).a * in_alpha * factors.x < factors.y)
            discard;
    }
    out_surface = emitting_surface(draw.surface);
}
