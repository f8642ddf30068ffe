#version 460
#extension GL_GOOGLE_include_directive : require
// Marks the rows of the surfaces that a picture's pixels show.
#include "engine/scene/instance_shared.h"

layout(local_size_x = 64) in;
const int run = 8; // pixels of an invocation, one below the other

layout(set = 0, binding = 0) uniform usampler2D surface_image;
layout(set = 0, binding = 1) writeonly buffer Shown { uint shown[]; };
layout(push_constant) uniform Constants { ivec2 size; }
constants;

void main() {
    const int x = int(gl_GlobalInvocationID.x), first = int(gl_GlobalInvocationID.y) * run;
    if (x >= constants.size.x)
        return;
    uint above = 0u;
    for (int y = first; y < min(first + run, constants.size.y); ++y) {
        const uint surface = texelFetch(surface_image, ivec2(x, y), 0).r;
        if (surface != above && surface != 0u)
            shown[surface_row(surface)] = 1u;
        above = surface;
    }
}
