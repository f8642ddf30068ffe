// What the passes of the module read of the geometry pass, and what they write. All images have one size.
//
// Read as sampled images in compute and fragment shaders, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL; required:
//   depth               D32_SFLOAT or R32_SFLOAT. Reverse Z without a far plane: near / distance along the camera's
//                       axis, with the near distance of the CameraRow. 0 where nothing is.
//   normals             R32G32_UINT. x: shading normal, y: geometric normal, each packed by engine/core/octahedral.h;
//                       world space. The geometric normal faces the camera, the shading normal is on its side.
//   surface             R32_UINT or R16_UINT. Row of scene::GpuScene + 1 in the bits of surface_row_mask
//                       (engine/scene/instance_shared.h); 0 where nothing is.
// The same; optional, and free of cost while no technique reads them:
//   motion              R16G16_SFLOAT or R32G32_SFLOAT. Place in the previous frame minus place in this one; 1 is the
//                       picture's width or height.
//   metallic_roughness  R8G8_UNORM, R8G8B8A8_UNORM or R16G16_SFLOAT. x: metallic, y: roughness, as in glTF.
//
// Written as storage images in compute shaders, VK_IMAGE_LAYOUT_GENERAL, all pixels:
//   irradiance          R16G16B16A16_SFLOAT or R32G32B32A32_SFLOAT. W/m2 without albedo; alpha 1, 0 where nothing is.
//   specular            The same formats; optional. Radiance reflected specularly, W/(sr m2); 0 while no technique
//                       lights it.
//
// With the engine's frame graph these are graph resources, and barriers follow from the declarations. What geometry
// passes write in other forms (projections, depth and normal formats), gi_module/g_buffer/ converts to this one.
#pragma once

#include "engine/gpu/frame_graph.h"

namespace sunfleck::gi {

struct GBufferInput {
    gpu::ResourceId depth, normals, surface;
    std::uint32_t width = 0, height = 0;
    gpu::ResourceId motion, metallic_roughness; // may be invalid
};

} // namespace sunfleck::gi
