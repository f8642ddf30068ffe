sunfleck_technique(many_light
  SOURCES many_light_settings.cpp many_light_technique.cpp light_map_jobs.cpp light_maps.cpp
          baked_light.cpp refined_light.cpp nearby_light.cpp surface_tables.cpp many_light.cpp many_light_passes.cpp pass_counter.cpp pass_grouping.cpp
          pass_optimisation.cpp pass_cover.cpp visible_nodes.cpp
  SHADERS gather.comp classify.comp light.comp rough_entries.comp light_maps.comp baked_light.comp
          baked_light_cells.comp refined_light.comp nearby_light.comp nearby_sources.comp classify_baked.comp show.comp)
