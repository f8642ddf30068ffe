# sunfleck_technique(folder SOURCES a.cpp ... SHADERS b.comp ...)
# Called by the technique.cmake of a folder of gi_module: its sources and shaders become part of sunfleck_gi. One source
# defines `const TechniqueEntry& FOLDER_technique()`; the shaders are returned by sunfleck_gi_FOLDER_shaders().
macro(sunfleck_technique folder)
  cmake_parse_arguments(TECHNIQUE "" "" "SOURCES;SHADERS" ${ARGN})
  list(TRANSFORM TECHNIQUE_SOURCES PREPEND "${folder}/")
  sunfleck_sources(sunfleck_gi ${TECHNIQUE_SOURCES})
  if(TECHNIQUE_SHADERS)
    list(TRANSFORM TECHNIQUE_SHADERS PREPEND "${folder}/")
    sunfleck_shaders(sunfleck_gi NAME sunfleck_gi_${folder} FILES ${TECHNIQUE_SHADERS})
  endif()
  string(APPEND SUNFLECK_TECHNIQUE_DECLARATIONS "const TechniqueEntry& ${folder}_technique();\n")
  list(APPEND SUNFLECK_TECHNIQUE_CALLS "${folder}_technique()")
endmacro()

# sunfleck_techniques(folder ...)
# Reads the technique.cmake of each folder and writes the list that techniques() returns, in this order. The global
# property SUNFLECK_TECHNIQUES is the list of folders.
function(sunfleck_techniques)
  foreach(folder IN LISTS ARGN)
    include("${CMAKE_CURRENT_SOURCE_DIR}/${folder}/technique.cmake")
  endforeach()
  set_property(GLOBAL PROPERTY SUNFLECK_TECHNIQUES "${ARGN}")
  list(JOIN SUNFLECK_TECHNIQUE_CALLS ", " SUNFLECK_TECHNIQUE_CALLS)
  configure_file(techniques.cpp.in "${CMAKE_CURRENT_BINARY_DIR}/techniques.cpp" @ONLY)
  target_sources(sunfleck_gi PRIVATE "${CMAKE_CURRENT_BINARY_DIR}/techniques.cpp")
endfunction()
