sunfleck_technique(gloss
  SOURCES gloss_technique.cpp gloss_lights.cpp
  SHADERS gloss.comp)
