// The G-buffer that the module reads, and the images that it writes. All images have the same size.
//
// Input: sampled images, read in compute and fragment shaders in VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL.
// Required:
//   depth               D32_SFLOAT or R32_SFLOAT. Reverse Z with an infinite far plane: near / distance along the view
//                       axis, with the near distance of the CameraRow. 0 is background.
//   normals             R32G32_UINT, world space. x: shading normal, y: geometric normal, each packed by
//                       engine/core/octahedral.h. The geometric normal faces the camera, and the shading normal lies on
//                       the same side.
//   surface             R32_UINT or R16_UINT. Row of scene::GpuScene + 1 in the bits of surface_row_mask
//                       (engine/scene/instance_shared.h); 0 is background.
// Optional; they cost nothing while no technique reads them:
//   motion              R16G16_SFLOAT or R32G32_SFLOAT. Position in the previous frame minus position in this one,
//   where
//                       1 is the width or height of the picture.
//   metallic_roughness  R8G8_UNORM, R8G8B8A8_UNORM or R16G16_SFLOAT. x: metallic, y: roughness, as in glTF.
//   base_colour         R8G8B8A8_UNORM. Square roots of red, green and blue. Without it and the one before, glossy
//   light
//                       takes the values of the instance's material.
//
// Output: storage images, written in compute shaders in VK_IMAGE_LAYOUT_GENERAL, every pixel.
//   irradiance          R16G16B16A16_SFLOAT or R32G32B32A32_SFLOAT. W/m2 without albedo; alpha is 1, background 0.
//   specular            The same formats; optional. Only pixels of glossy surfaces are written (metals, and dielectrics
//                       under a coat). rgb: radiance that their facets reflect, W/(sr m2); a: share of the diffuse
//                       base's light that leaves it: base_colour * irradiance / pi * a + rgb is what the camera sees.
//
// With the engine's frame graph these are graph resources, and barriers follow from the declared accesses. G-buffers in
// other forms (projections, depth and normal formats) are converted to this one by gi_module/g_buffer/.
#pragma once

#include "engine/gpu/frame_graph.h"

namespace sunfleck::gi {

struct GBufferInput {
    gpu::ResourceId depth, normals, surface;
    std::uint32_t width = 0, height = 0;
    gpu::ResourceId motion, metallic_roughness, base_colour; // may be invalid
};

} // namespace sunfleck::gi
