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
# What sunfleck/host.h includes, and what shaders that pack normals do.
install(DIRECTORY gi_module/include/ DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}")
install(FILES engine/core/result.h engine/core/octahedral.h engine/core/shader_language.h engine/core/maths.h
        DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/sunfleck/engine/core")
install(FILES README.md CHANGELOG.md docs/scene.schema.json DESTINATION "${CMAKE_INSTALL_DOCDIR}")
if(SUNFLECK_BUILD_APPLICATIONS)
  install(TARGETS sunfleck sunfleck_demo sunfleck_editor RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
  install(TARGETS sunfleck_draco sunfleck_image_codec LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
  set_target_properties(sunfleck sunfleck_demo sunfleck_editor PROPERTIES INSTALL_RPATH "$ORIGIN/../${CMAKE_INSTALL_LIBDIR}")
  install(DIRECTORY "${PROJECT_BINARY_DIR}/scenes" DESTINATION "${CMAKE_INSTALL_DATADIR}/sunfleck"
          FILES_MATCHING PATTERN "*.glb" PATTERN "*.json" PATTERN "*.walk")
endif()
