# What `cmake --install` puts where: the module's libraries and headers, the package that find_package(sunfleck) reads,
# and the programs with their scenes.
include(CMakePackageConfigHelpers)
set(package_folder "${CMAKE_INSTALL_LIBDIR}/cmake/sunfleck")
install(EXPORT sunfleckTargets NAMESPACE sunfleck:: DESTINATION "${package_folder}")
configure_package_config_file("${PROJECT_SOURCE_DIR}/cmake/sunfleckConfig.cmake.in"
  "${PROJECT_BINARY_DIR}/sunfleckConfig.cmake" INSTALL_DESTINATION "${package_folder}")
write_basic_package_version_file("${PROJECT_BINARY_DIR}/sunfleckConfigVersion.cmake" COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/sunfleckConfig.cmake" "${PROJECT_BINARY_DIR}/sunfleckConfigVersion.cmake"
        DESTINATION "${package_folder}")
# sunfleck/host.h is what a foreign host needs. The headers of the module and of the engine's lower half are there for
# hosts that use gi::System itself, and for shaders that pack normals.
install(DIRECTORY gi_module/include/ DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}")
foreach(folder engine/core engine/statistics engine/ecs engine/gpu engine/scene engine/raytrace gi_module)
  install(DIRECTORY "${folder}/" DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/sunfleck/${folder}"
          FILES_MATCHING PATTERN "*.h" PATTERN "include" EXCLUDE PATTERN "reference" EXCLUDE)
endforeach()
install(FILES "${PROJECT_BINARY_DIR}/generated/sunfleck_vulkan_names.h"
        DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/sunfleck")
if(SUNFLECK_BUILD_APPLICATIONS)
  install(TARGETS sunfleck sunfleck_demo RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
  install(TARGETS sunfleck_draco sunfleck_image_codec LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
  set_target_properties(sunfleck sunfleck_demo PROPERTIES INSTALL_RPATH "$ORIGIN/../${CMAKE_INSTALL_LIBDIR}")
  install(DIRECTORY "${PROJECT_BINARY_DIR}/scenes" DESTINATION "${CMAKE_INSTALL_DATADIR}/sunfleck"
          FILES_MATCHING PATTERN "*.glb" PATTERN "*.json" PATTERN "*.walk")
endif()
