#version 460
#extension GL_GOOGLE_include_directive : require
// Packs the host's shading and geometric normals, flipped towards the camera. Geometric normals that the host does not
// provide are derived from depth.
#include "engine/core/octahedral.h"
#include "engine/scene/camera_shared.h"
#include "gi_module/g_buffer/conversion_shared.h"

layout(local_size_x = 8, local_size_y = 8) in;
layout(constant_id = 0) const uint shading_encoding = normal_signed;
layout(constant_id = 1) const uint geometric_encoding = normal_missing;

layout(set = 0, binding = 0) uniform Camera { CameraRow camera; };
layout(set = 0, binding = 1) uniform sampler2D depth_image; // near / distance
layout(set = 0, binding = 2) uniform sampler2D shading_normals;
layout(set = 0, binding = 3) uniform sampler2D geometric_normals;
layout(set = 0, binding = 4) writeonly uniform uimage2D normals_image;
layout(push_constant) uniform Constants { NormalConversionConstants constants; };

// Angle, radians, up to which a shading normal counts as equal to that of its triangle: normals with 8 bits per
// component are accurate to about 0.005.
const float same_normal = 0.01;

vec3 decoded(vec3 value, uint encoding) { return encoding == normal_unsigned ? value * 2.0 - 1.0 : value; }

float depth_at(ivec2 pixel) {
    return texelFetch(depth_image, clamp(pixel, ivec2(0), ivec2(constants.width, constants.height) - 1), 0).r;
}

// Changes of depth from the pixel to the next one to the right and down. On a plane, depth is linear in screen space: of
// the four corners round the pixel, that one is used whose five depths are nearest to lying on a plane with this pixel's.
// So no difference spans an edge, and both are those of the same triangle.
vec2 depth_slopes(ivec2 pixel, float depth) {
    const ivec2 size = ivec2(constants.width, constants.height);
    vec2 best = vec2(0.0);
    float least = 3.4e38;
    for (int corner = 0; corner < 4; ++corner) {
        const ivec2 toward = 1 - 2 * ivec2(corner & 1, corner >> 1), across = ivec2(toward.x, 0), along = ivec2(0, toward.y);
        if (any(lessThan(pixel + 2 * toward, ivec2(0))) || any(greaterThanEqual(pixel + 2 * toward, size)))
            continue;
        const float x = depth_at(pixel + across), y = depth_at(pixel + along);
        const float miss = abs(2.0 * x - depth_at(pixel + 2 * across) - depth) +
                           abs(2.0 * y - depth_at(pixel + 2 * along) - depth) +
                           abs(x + y - depth_at(pixel + toward) - depth);
        if (miss < least) {
            least = miss;
            best = vec2(x - depth, y - depth) * vec2(toward);
        }
    }
    return best;
}

// The plane of this pixel's surface, from its neighbours: near * dot(plane, ray) is the depth at every pixel. Its
// direction is the normal, its length the reciprocal of the camera's distance from the plane.
vec3 plane_of(ivec2 pixel, float depth) {
    const vec2 slope = depth_slopes(pixel, depth);
    const vec3 ray = camera_ray(camera, vec2(pixel) + 0.5);
    const vec3 right = camera.right.xyz * (2.0 / camera.forward.w), down = camera.down.xyz * (2.0 / camera.right.w);
    const vec3 sum = depth * cross(right, down) + slope.x * cross(down, ray) + slope.y * cross(ray, right);
    return sum / (dot(ray, cross(right, down)) * camera.position.w);
}

// Light leaks where the plane is tilted by error: by quantised depth, or on surfaces that are one pixel wide. So the
// shading normal is used if the two differ by no more than that noise, and if they are far apart.
vec3 derived_normal(ivec2 pixel, float depth, vec3 to_camera, inout vec3 shading) {
    const vec3 plane = plane_of(pixel, depth);
    vec3 normal = normalize(plane);
    if (dot(normal, to_camera) < 0.0)
        normal = -normal;
    const bool shading_faces = dot(shading, to_camera) > 0.0;
    if (dot(shading, normal) < 0.0 && !shading_faces)
        shading = -shading; // of a triangle seen from behind
    const float pixel_size = 2.0 * length(camera.right.xyz) / camera.forward.w;
    const float noise = 3.0 * max(constants.depth_step, 1e-7 * depth) / (camera.position.w * pixel_size * length(plane));
    const float apart = length(shading - normal); // the angle, if small
    const bool same = apart < same_normal + noise || apart > 1.0;
    return same && dot(shading, to_camera) > 0.0 ? shading : normal;
}

void main() {
    const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (pixel.x >= int(constants.width) || pixel.y >= int(constants.height))
        return;
    const float depth = depth_at(pixel);
    if (depth <= 0.0) {
        imageStore(normals_image, pixel, uvec4(0u));
        return;
    }
    const vec3 to_camera = -camera_ray(camera, vec2(pixel) + 0.5);
    vec3 shading = decoded(texelFetch(shading_normals, pixel, 0).xyz, shading_encoding);
    shading = dot(shading, shading) > 1e-8 ? normalize(shading) : normalize(to_camera);
    vec3 geometric;
    if (geometric_encoding == normal_missing) {
        geometric = derived_normal(pixel, depth, to_camera, shading);
    } else {
        geometric = decoded(texelFetch(geometric_normals, pixel, 0).xyz, geometric_encoding);
        geometric = dot(geometric, to_camera) < 0.0 ? -geometric : geometric;
    }
    if (dot(shading, geometric) < 0.0)
        shading = -shading;
    imageStore(normals_image, pixel, uvec4(pack_normal(shading), pack_normal(geometric), 0u, 0u));
}
