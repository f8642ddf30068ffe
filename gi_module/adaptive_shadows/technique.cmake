sunfleck_technique(adaptive_shadows
  SOURCES receiver_cells.cpp tile_selection.cpp tile_store.cpp tile_listing.cpp punctual_kernel.cpp adaptive_shadows_technique.cpp
  SHADERS punctual_lists.comp punctual_blocks.comp punctual_light_16.comp punctual_light_32.comp)
