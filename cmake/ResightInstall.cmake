# Installs what find_package(resight) needs: resight::<module> for each module, and resight::resight for all.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

get_property(modules GLOBAL PROPERTY RESIGHT_MODULES)
add_library(resight_all INTERFACE)
set_target_properties(resight_all PROPERTIES EXPORT_NAME resight)
target_link_libraries(resight_all INTERFACE ${modules})
add_library(resight::resight ALIAS resight_all)

install(TARGETS ${modules} resight_all resight_build_flags EXPORT resightTargets
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(EXPORT resightTargets NAMESPACE resight:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/resight)
configure_package_config_file(cmake/resightConfig.cmake.in resightConfig.cmake
                              INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/resight)
write_basic_package_version_file(resightConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/resightConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/resightConfigVersion.cmake
              cmake/ResightDependencies.cmake
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/resight)
