# The installed tree and its CMake package: find_package(xgc CONFIG [COMPONENTS runtime c load vulkan bake]). Each component
# has an export set of its own, so that a user of the runtime core needs GLM and nothing else.
include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/xgc)

function(xgc_install_component component)
  install(TARGETS xgc_${component} EXPORT xgc-${component}
          ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
  install(EXPORT xgc-${component} NAMESPACE xgc:: DESTINATION ${package_dir} FILE xgc-${component}.cmake)
endfunction()

xgc_install_component(runtime)
install(DIRECTORY runtime/include/xgc DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
if(TARGET xgc_c)
  xgc_install_component(c)
endif()
if(TARGET xgc_load)
  xgc_install_component(load)
  install(DIRECTORY runtime/load/include/xgc DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
endif()
if(TARGET xgc_vulkan)
  xgc_install_component(vulkan)
  install(DIRECTORY runtime/vulkan/include/xgc DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
endif()
if(TARGET xgc_bake)
  xgc_install_component(bake)
  install(DIRECTORY tools/include/xgc DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
endif()
if(TARGET xgc_tool)
  install(TARGETS xgc_tool RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()

configure_package_config_file(tools/cmake/xgcConfig.cmake.in ${PROJECT_BINARY_DIR}/xgcConfig.cmake
                              INSTALL_DESTINATION ${package_dir} NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/xgcConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/xgcConfig.cmake ${PROJECT_BINARY_DIR}/xgcConfigVersion.cmake
        DESTINATION ${package_dir})
install(FILES LICENSE README.md CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DOCDIR})
