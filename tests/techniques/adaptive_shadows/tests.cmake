list(APPEND unit_sources techniques/adaptive_shadows/tiles_test.cpp)
list(APPEND gpu_sources techniques/adaptive_shadows/lit_blocks_test.cpp techniques/adaptive_shadows/sharp_shadows_test.cpp)
