sunfleck_technique(rsm_gather
  SOURCES gather_pattern.cpp gather_maps.cpp rsm_gather_settings.cpp rsm_gather_technique.cpp
  SHADERS rsm_gather.comp)
