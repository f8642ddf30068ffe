#version 460
#extension GL_GOOGLE_include_directive : require
layout(set = 0, binding = 4, rgba32f) uniform image2D picture;
#include "gi_module/light_sum/light_sum.glsl"
