list(APPEND unit_sources techniques/splatting/followed_lights_test.cpp techniques/splatting/splat_occlusion_test.cpp)
list(APPEND truth_sources techniques/splatting/splatting_test.cpp techniques/splatting/splat_error_test.cpp
     techniques/splatting/splat_truth_test.cpp techniques/splatting/splat_levels_test.cpp
     techniques/splatting/splat_glass_test.cpp)
