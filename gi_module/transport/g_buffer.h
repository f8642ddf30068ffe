// What the module reads of the host's geometry pass, and what it writes.
//
// | image    | format                    | content                                               | at record() |
// |----------|---------------------------|-------------------------------------------------------|-----------------------|
// | depth    | D32_SFLOAT                | reverse Z: near / distance; 0 where nothing is        | sampled by compute |
// | normals  | R32G32_UINT               | x shading, y geometric normal (engine/core/octahedral.h), both towards the
// camera's side | sampled by compute | | surface  | R32_UINT                  | 0 where nothing is; any other value is
// the host's     | sampled by compute    | | output   | RGBA16F or RGBA32F        | irradiance W/m2 without albedo;
// alpha 1, 0 where nothing is | storage write by compute, all pixels |
//
// With the engine's frame graph these are graph resources and barriers follow from the declarations. All have one size.
#pragma once

#include "engine/gpu/frame_graph.h"

namespace sunfleck::gi {

struct GBufferInput {
    gpu::ResourceId depth, normals, surface;
    std::uint32_t width = 0, height = 0;
};

} // namespace sunfleck::gi
