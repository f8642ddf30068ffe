# Headers that most files of some folders include, compiled once for all of them (SUNFLECK_PRECOMPILE): parsing them is
# most of what compiling a file costs. Files still include what they use; the debug preset builds without this.
#
# Which headers: a folder's CMakeLists.txt sets SUNFLECK_PRECOMPILED to one of the targets below. They are named as
# found in include folders, never by their place, so that ccache knows them in every copy of the project.
set(SUNFLECK_COMMON_HEADERS <algorithm> <array> <atomic> <bit> <chrono> <cmath> <cstdint> <cstring> <cstdio> <cstdlib>
    <filesystem> <functional> <map> <memory> <mutex> <numeric> <optional> <set> <span> <sstream> <string> <string_view>
    <thread> <unordered_map> <utility> <variant> <vector> <engine/core/maths.h>)
set(SUNFLECK_SCENE_HEADERS ${SUNFLECK_COMMON_HEADERS} <engine/scene/gpu_scene.h> <engine/raytrace/ray_scene.h>)
set(SUNFLECK_PROGRAM_HEADERS ${SUNFLECK_SCENE_HEADERS} <gi_module/technique.h> <nlohmann/json.hpp>)

# sunfleck_precompile(name position_independent headers...): a target whose precompiled headers others use.
function(sunfleck_precompile name position_independent)
  add_library(${name} OBJECT "${PROJECT_BINARY_DIR}/generated/precompiled.cpp")
  target_include_directories(${name} PRIVATE "${PROJECT_SOURCE_DIR}" "${PROJECT_BINARY_DIR}/generated"
                             "${PROJECT_SOURCE_DIR}/gi_module/include")
  target_link_libraries(${name} PRIVATE sunfleck_flags)
  set_target_properties(${name} PROPERTIES POSITION_INDEPENDENT_CODE ${position_independent})
  target_precompile_headers(${name} PRIVATE ${ARGN})
endfunction()

# Called once, when all packages are found.
function(sunfleck_precompile_headers)
  if(NOT SUNFLECK_PRECOMPILE)
    return()
  endif()
  file(CONFIGURE OUTPUT "${PROJECT_BINARY_DIR}/generated/precompiled.cpp"
       CONTENT "// Only there to compile the headers.\n")
  sunfleck_precompile(sunfleck_precompiled_common ON ${SUNFLECK_COMMON_HEADERS})
  sunfleck_precompile(sunfleck_precompiled_scene ON ${SUNFLECK_SCENE_HEADERS})
  if(SUNFLECK_BUILD_APPLICATIONS)
    sunfleck_precompile(sunfleck_precompiled_programs ON ${SUNFLECK_PROGRAM_HEADERS})
  endif()
  if(SUNFLECK_BUILD_TESTS)
    sunfleck_precompile(sunfleck_precompiled_tests OFF ${SUNFLECK_PROGRAM_HEADERS} <gtest/gtest.h>)
    target_link_libraries(sunfleck_precompiled_tests PRIVATE GTest::gtest) # for its definitions
  endif()
endfunction()
