#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
// Which lights of a batch may light any pixel of a block, by the ball around all that it shows: of spots, few do. Where
// the picture holds nothing yet, it is set to zero.
#include "engine/scene/camera_shared.h"
#include "gi_module/adaptive_shadows/adaptive_shadows_shared.h"

layout(local_size_x = 8, local_size_y = 8) in;
layout(constant_id = 0) const uint pixels = 8; // of an invocation
layout(constant_id = 1) const uint clears = 0; // 1: sets the picture to zero

layout(set = 0, binding = 0) uniform Camera { CameraRow camera; };
layout(set = 0, binding = 1) uniform sampler2D depth_image;
layout(set = 0, binding = 2) uniform Lights { TileLight lights[lights_per_pass]; };
layout(set = 0, binding = 3) writeonly buffer Masks { uint block_lights[]; };
layout(set = 0, binding = 4) writeonly uniform image2D picture;
layout(push_constant) uniform Constants { PunctualConstants constants; };

shared uint nearest, farthest, reaching; // the depths' bits, which are in the order of the depths

struct Ball {
    vec3 centre;
    float radius;
};

Ball ball_around(vec2 low, vec2 high, float near, float far) {
    vec3 corners[8];
    vec3 centre = vec3(0.0);
    [[unroll]] for (int i = 0; i < 8; ++i) {
        const vec2 place = vec2((i & 1) != 0 ? high.x : low.x, (i & 2) != 0 ? high.y : low.y);
        corners[i] = camera_position_at(camera, place, i < 4 ? near : far);
        centre += 0.125 * corners[i];
    }
    float squared = 0.0;
    [[unroll]] for (int i = 0; i < 8; ++i)
        squared = max(squared, dot(corners[i] - centre, corners[i] - centre));
    return Ball(centre, sqrt(squared) * 1.001);
}

// False only where the ball is outside of the light's cone; see unshadowed_factor.
bool may_reach(LightRow light, Ball ball) {
    const vec3 v = ball.centre - light.position_bound.xyz;
    const float cosine = -light.normal_offset.w / light.tangent_scale.w; // of the cone's half angle
    if (light.tangent_scale.w <= 0.0 || cosine <= 0.0)
        return true;
    const float along = dot(light.normal_offset.xyz, v), square = dot(v, v);
    // From the plane that touches the cone where it comes nearest to the ball.
    const float outside = sqrt(max(square - along * along, 0.0)) * cosine - along * sqrt(max(1.0 - cosine * cosine, 0.0));
    return outside <= ball.radius + 1e-3 * sqrt(square);
}

void main() {
    if (gl_LocalInvocationIndex == 0u) {
        nearest = reaching = 0u;
        farthest = ~0u;
    }
    barrier();
    const ivec2 size = ivec2(constants.width, constants.height);
    const ivec2 first = ivec2(gl_WorkGroupID.xy) * ivec2(8u * pixels, block_rows);
    uint near = 0u, far = ~0u;
    [[unroll]] for (uint k = 0; k < pixels; ++k) {
        const ivec2 wanted = first + ivec2(gl_LocalInvocationID.xy) + ivec2(int(k) * 8, 0);
        const ivec2 pixel = min(wanted, size - 1);
        const float depth = texelFetch(depth_image, pixel, 0).r;
        const uint bits = floatBitsToUint(depth);
        near = max(near, bits);
        far = depth > 0.0 ? min(far, bits) : far;
        if (clears != 0u && wanted == pixel)
            imageStore(picture, pixel, vec4(0.0, 0.0, 0.0, depth > 0.0 ? 1.0 : 0.0));
    }
    atomicMax(nearest, near);
    atomicMin(farthest, far);
    barrier();
    const vec2 last = vec2(min(first + ivec2(8u * pixels, block_rows), size));
    const Ball ball = ball_around(vec2(first), last, uintBitsToFloat(nearest), uintBitsToFloat(farthest));
    const uint i = gl_LocalInvocationIndex;
    if (nearest != 0u && i < constants.light_count && may_reach(lights[min(i, lights_per_pass - 1u)].row, ball))
        atomicOr(reaching, 1u << i);
    barrier();
    if (i == 0u)
        block_lights[gl_WorkGroupID.y * constants.block_columns + gl_WorkGroupID.x] = reaching;
}
