list(APPEND truth_sources techniques/gloss/gloss_test.cpp)
