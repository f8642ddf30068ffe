# What `cmake --install` puts where: the module's libraries and headers, the package that find_package(sunfleck) reads,
# and the programs with their scenes.
include(CMakePackageConfigHelpers)

# The module and all that it stands on as one object in one archive, of which a host's linker sees the functions of
# sunfleck/host.h alone. In archives as they are built, everything is seen: of two definitions of one inline function the
# linker keeps either, so that a host with other settings of glm (or another fmt) would change the module, or be changed.
set(package_libraries sunfleck_core sunfleck_statistics sunfleck_ecs sunfleck_gpu sunfleck_scene sunfleck_raytrace sunfleck_gi)
list(TRANSFORM package_libraries REPLACE "(.+)" "$<TARGET_FILE:\\1>" OUTPUT_VARIABLE package_archives)
set(package_object "${PROJECT_BINARY_DIR}/sunfleck_host.o")
add_custom_command(OUTPUT "${package_object}"
  COMMAND "${CMAKE_CXX_COMPILER}" -r -nostdlib -o "${package_object}" -Wl,--force-group-allocation
          -Wl,--whole-archive ${package_archives} -Wl,--no-whole-archive
  # What GCC marks as unique in a process (nm's "u") can only be made local once it is weak.
  COMMAND sh -c "'${CMAKE_NM}' -g --defined-only '${package_object}' | sed -n 's/.* u //p' >'${package_object}.unique'"
  COMMAND "${CMAKE_OBJCOPY}" "--weaken-symbols=${package_object}.unique" "${package_object}"
  COMMAND "${CMAKE_OBJCOPY}" --wildcard "--keep-global-symbol=_ZN8sunfleck4host*" "--keep-global-symbol=_ZNK8sunfleck4host*"
          "${package_object}"
  DEPENDS ${package_libraries} COMMENT "Hiding all but the functions of sunfleck/host.h" VERBATIM)
add_library(sunfleck_package STATIC "${package_object}")
set_source_files_properties("${package_object}" PROPERTIES EXTERNAL_OBJECT TRUE GENERATED TRUE)
set_target_properties(sunfleck_package PROPERTIES LINKER_LANGUAGE CXX OUTPUT_NAME sunfleck_gi EXPORT_NAME gi
                      ARCHIVE_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/package")
target_link_libraries(sunfleck_package INTERFACE Vulkan::Headers glm::glm TBB::tbb embree meshoptimizer::meshoptimizer
                      ${CMAKE_DL_LIBS})
target_include_directories(sunfleck_package INTERFACE "$<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>"
                           "$<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/sunfleck>")
target_compile_features(sunfleck_package INTERFACE cxx_std_20)
install(TARGETS sunfleck_package EXPORT sunfleckTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})

set(package_folder "${CMAKE_INSTALL_LIBDIR}/cmake/sunfleck")
install(EXPORT sunfleckTargets NAMESPACE sunfleck:: DESTINATION "${package_folder}")
configure_package_config_file("${PROJECT_SOURCE_DIR}/cmake/sunfleckConfig.cmake.in"
  "${PROJECT_BINARY_DIR}/sunfleckConfig.cmake" INSTALL_DESTINATION "${package_folder}")
write_basic_package_version_file("${PROJECT_BINARY_DIR}/sunfleckConfigVersion.cmake" COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/sunfleckConfig.cmake" "${PROJECT_BINARY_DIR}/sunfleckConfigVersion.cmake"
        DESTINATION "${package_folder}")
# What sunfleck/host.h includes, and what shaders that pack normals do.
install(DIRECTORY gi_module/include/ DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}")
install(FILES engine/core/result.h engine/core/octahedral.h engine/core/shader_language.h engine/core/maths.h
        DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/sunfleck/engine/core")
install(FILES README.md LICENCE.md CHANGELOG.md docs/scene.schema.json DESTINATION "${CMAKE_INSTALL_DOCDIR}")
if(SUNFLECK_BUILD_APPLICATIONS)
  install(TARGETS sunfleck sunfleck_demo sunfleck_editor RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
  install(TARGETS sunfleck_draco sunfleck_image_codec LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
  set_target_properties(sunfleck sunfleck_demo sunfleck_editor PROPERTIES INSTALL_RPATH "$ORIGIN/../${CMAKE_INSTALL_LIBDIR}")
  install(DIRECTORY "${PROJECT_BINARY_DIR}/scenes" DESTINATION "${CMAKE_INSTALL_DATADIR}/sunfleck"
          FILES_MATCHING PATTERN "*.glb" PATTERN "*.json" PATTERN "*.walk")
endif()
