list(APPEND unit_sources techniques/transfer/transfer_data_test.cpp)
list(APPEND thread_sources techniques/transfer/transfer_data_test.cpp)
list(APPEND gpu_sources techniques/transfer/transfer_pictures_test.cpp)
list(APPEND tool_sources techniques/transfer/transfer_in_demo_test.cpp)
