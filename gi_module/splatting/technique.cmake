sunfleck_technique(splatting
  SOURCES splatting_settings.cpp nearest_places.cpp followed_lights.cpp visible_contribution.cpp splat_lights.cpp
          splat_occlusion.cpp splat_levels.cpp splat_kernel.cpp splatting_technique.cpp
  SHADERS splat_lists.comp splat_patches.comp splat_tiles.comp splat_levels.comp splat_nodes.comp splat_light.comp)
