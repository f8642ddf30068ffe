list(APPEND truth_sources techniques/splatting/splatting_test.cpp techniques/splatting/splat_error_test.cpp
     techniques/splatting/splat_truth_test.cpp)
