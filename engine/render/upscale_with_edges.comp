#version 460
#extension GL_GOOGLE_include_directive : require
#define LISTS_EDGES
#include "engine/render/upscale.glsl"
