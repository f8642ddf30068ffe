# Tests of the many-light system; those that hold it against brute force need both.
list(APPEND unit_sources techniques/many_light/pass_optimisation_test.cpp
     techniques/many_light/light_map_jobs_test.cpp)
list(APPEND address_sources techniques/many_light/pass_optimisation_test.cpp)
list(APPEND gpu_sources techniques/many_light/light_maps_test.cpp techniques/many_light/baked_light_test.cpp
     techniques/many_light/scene_changes_test.cpp techniques/many_light/refined_light_test.cpp)
if(brute_force IN_LIST techniques)
  list(APPEND gpu_sources techniques/many_light/many_light_test.cpp techniques/many_light/light_map_pictures_test.cpp)
endif()
