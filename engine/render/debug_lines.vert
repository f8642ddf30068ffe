#version 460
#extension GL_GOOGLE_include_directive : require
#include "engine/scene/camera_shared.h"

layout(set = 0, binding = 0) uniform Camera { CameraRow camera; };
layout(location = 0) in vec4 in_position_colour; // xyz: world position; w: colour, RGBA8 packed in the bits
layout(location = 0) out vec4 out_colour;

void main() {
    out_colour = unpackUnorm4x8(floatBitsToUint(in_position_colour.w));
    gl_Position = camera.view_projection * vec4(in_position_colour.xyz, 1.0);
}
