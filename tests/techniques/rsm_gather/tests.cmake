list(APPEND unit_sources techniques/rsm_gather/gather_pattern_test.cpp)
list(APPEND gpu_sources techniques/rsm_gather/rsm_gather_test.cpp)
