#version 460
#extension GL_GOOGLE_include_directive : require
#include "engine/render/composition_shared.h"
#include "engine/scene/camera_shared.h"

layout(set = 0, binding = 3) uniform Camera { CameraRow camera; };
layout(push_constant) uniform Constants { EmissionConstants draw; };

layout(location = 0) in vec3 in_position;

#include "engine/render/draw_position.glsl"

void main() { gl_Position = camera.view_projection * vec4(world_position(in_position), 1.0); }
