# Flags shared by every target of the project. They are private to it: nothing leaks to whoever links a library.
add_library(sunfleck_flags INTERFACE)
target_compile_options(sunfleck_flags INTERFACE -Wall -Wextra -Wshadow -Wnon-virtual-dtor -Woverloaded-virtual
                       # Vulkan structs are filled field by field after their type
                       -Wno-missing-field-initializers -Werror)
# g++ 12 warns of overlapping copies inside std::string's own operator+ (GCC bug 105651).
target_compile_options(sunfleck_flags INTERFACE $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>)
# Nor does it see that the standard library's own code is a system header's once that is precompiled.
if(SUNFLECK_PRECOMPILE)
  target_compile_options(sunfleck_flags INTERFACE $<$<CXX_COMPILER_ID:GNU>:-Wno-array-bounds>
                         $<$<CXX_COMPILER_ID:GNU>:-Wno-stringop-overflow> $<$<CXX_COMPILER_ID:GNU>:-Wno-stringop-overread>)
endif()
if(SUNFLECK_SANITIZE)
  target_compile_options(sunfleck_flags INTERFACE -fsanitize=${SUNFLECK_SANITIZE} -fno-omit-frame-pointer
                         -fno-sanitize-recover=all)
  # Debug information names files from the project's root. The compiler cache otherwise takes the folder that a checkout
  # lies in for part of what it compiles, and another checkout finds nothing there.
  target_compile_options(sunfleck_flags INTERFACE -fdebug-prefix-map=${PROJECT_SOURCE_DIR}=.)
  target_link_options(sunfleck_flags INTERFACE -fsanitize=${SUNFLECK_SANITIZE})
endif()

# In builds with the address sanitizer, targets whose code runs briefly in their tests: optimising it (or precompiling
# headers for it with the flags of the others) takes longer than it saves. Left to be optimised are sampling, visibility and
# rays, and all in builds with the thread sanitizer: functions of std::string that are not inlined there are those that
# Embree calls, too, and it is not instrumented.
set(SUNFLECK_BRIEF_TARGETS sunfleck_core sunfleck_gpu sunfleck_io sunfleck_statistics
    sunfleck_render sunfleck_assets sunfleck_viewer sunfleck_shader_compiler file_tests sanitizer_tests)

# sunfleck_use_precompiled(target owner): the target takes the headers that the owner precompiles.
function(sunfleck_use_precompiled target owner)
  if(SUNFLECK_SANITIZE MATCHES "address" AND target IN_LIST SUNFLECK_BRIEF_TARGETS)
    target_compile_options(${target} PRIVATE -O0)
  elseif(SUNFLECK_PRECOMPILE)
    target_precompile_headers(${target} REUSE_FROM ${owner})
  endif()
endfunction()

# sunfleck_library(name SOURCES ... [LINK public libraries] [PRIVATE_LINK private libraries])
# A static library with the project's flags; headers are included by their path from the project's root.
function(sunfleck_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK;PRIVATE_LINK" ${ARGN})
  add_library(${name} STATIC)
  sunfleck_sources(${name} ${ARG_SOURCES})
  target_include_directories(${name} PUBLIC "${PROJECT_SOURCE_DIR}" "${PROJECT_BINARY_DIR}/generated")
  target_link_libraries(${name} PUBLIC ${ARG_LINK} PRIVATE sunfleck_flags ${ARG_PRIVATE_LINK})
  target_compile_features(${name} PUBLIC cxx_std_20)
  set_target_properties(${name} PROPERTIES POSITION_INDEPENDENT_CODE ON)
  sunfleck_use_precompiled(${name} "${SUNFLECK_PRECOMPILED}")
  string(REPLACE sunfleck_ "" short "${name}")
  add_library(sunfleck::${short} ALIAS ${name})
endfunction()

# sunfleck_program(name SOURCES ... LINK libraries)
function(sunfleck_program name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK" ${ARGN})
  add_executable(${name})
  sunfleck_sources(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE sunfleck_flags ${ARG_LINK})
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/bin")
endfunction()
