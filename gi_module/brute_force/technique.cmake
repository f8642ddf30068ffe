sunfleck_technique(brute_force
  SOURCES brute_force.cpp brute_force_technique.cpp
  SHADERS brute_force.comp)
