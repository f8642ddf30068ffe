list(APPEND gpu_sources techniques/brute_force/brute_force_test.cpp)
list(APPEND truth_sources techniques/brute_force/truth_test.cpp)
