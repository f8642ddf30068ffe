// A camera as shaders read it, and reconstruction of positions from depth.
#ifndef SUNFLECK_ENGINE_SCENE_CAMERA_SHARED_H
#define SUNFLECK_ENGINE_SCENE_CAMERA_SHARED_H
#include "engine/core/shader_language.h"
SHARED_BEGIN

struct CameraRow {
    mat4 view_projection;          //   0: world, or the scene's space, to clip; reverse Z without far plane, y down
    mat4 previous_view_projection; //  64
    vec4 position;                 // 128: xyz; w: near distance, m
    vec4 forward;                  // 144: xyz, ray through the picture's centre; w: picture width in pixels
    vec4 right;                    // 160: xyz, half the picture's width at distance 1; w: picture height in pixels
    vec4 down;                     // 176: xyz, half the picture's height at distance 1
    vec4 axis;                     // 192: xyz, unit, across the image plane; `forward`, unless off-centre or jittered
};

// Ray through the centre of a pixel; its length along `axis` is 1.
SHARED_FUNCTION vec3 camera_ray(CameraRow camera, vec2 pixel_centre) {
    vec2 ndc = pixel_centre / vec2(camera.forward.w, camera.right.w) * 2.0f - 1.0f;
    return vec3(camera.forward) + vec3(camera.right) * ndc.x + vec3(camera.down) * ndc.y;
}

// World position from depth > 0 (reverse Z: depth = near / distance along the axis).
SHARED_FUNCTION vec3 camera_position_at(CameraRow camera, vec2 pixel_centre, float depth) {
    return vec3(camera.position) + camera_ray(camera, pixel_centre) * (camera.position.w / depth);
}

SHARED_END
#ifdef __cplusplus
static_assert(sizeof(sunfleck::shared::CameraRow) == 208);
#endif
#endif
