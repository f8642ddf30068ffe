#version 460
#extension GL_GOOGLE_include_directive : require
layout(set = 0, binding = 7, rgba32f) uniform image2D picture;
#include "gi_module/adaptive_shadows/punctual_light.glsl"
