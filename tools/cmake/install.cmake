# find_package(apertura) and pkg-config for what was installed. The targets themselves are in tools/cmake/rooms.cmake.
include(CMakePackageConfigHelpers)
set(package ${CMAKE_INSTALL_LIBDIR}/cmake/apertura)
get_property(rooms GLOBAL PROPERTY APERTURA_PUBLIC_ROOMS)
foreach(room ${rooms})
  install(EXPORT apertura-${room} NAMESPACE apertura:: FILE apertura-${room}.cmake DESTINATION ${package})
endforeach()
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/aperturaConfig.cmake.in ${PROJECT_BINARY_DIR}/aperturaConfig.cmake
  INSTALL_DESTINATION ${package} PATH_VARS CMAKE_INSTALL_INCLUDEDIR NO_CHECK_REQUIRED_COMPONENTS_MACRO)
# Before 1.0 each minor version may change what is declared.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/aperturaConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/aperturaConfig.cmake ${PROJECT_BINARY_DIR}/aperturaConfigVersion.cmake DESTINATION ${package})

# These libraries are static, so that what they use is named to everybody who links them.
# Folders below the prefix are named from where the .pc file lies, so that it may be moved; others as they are.
if(IS_ABSOLUTE ${CMAKE_INSTALL_LIBDIR})
  set(pcPrefix ${CMAKE_INSTALL_PREFIX})
  set(pcLibraries ${CMAKE_INSTALL_LIBDIR})
else()
  file(RELATIVE_PATH up /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
  set(pcPrefix "\${pcfiledir}/${up}")
  set(pcLibraries "\${prefix}/${CMAKE_INSTALL_LIBDIR}")
endif()
set(pcIncludes "\${prefix}/${CMAKE_INSTALL_INCLUDEDIR}")
if(IS_ABSOLUTE ${CMAKE_INSTALL_INCLUDEDIR})
  set(pcIncludes ${CMAKE_INSTALL_INCLUDEDIR})
endif()
function(apertura_install_pc room what requires libs)
  configure_file(${PROJECT_SOURCE_DIR}/tools/cmake/apertura.pc.in ${PROJECT_BINARY_DIR}/apertura-${room}.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/apertura-${room}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
endfunction()
apertura_install_pc(sh "what is stored: four SH coefficients of visibility, the models' parameters, their lighting formulas" "glm" "")
apertura_install_pc(asset "baked assets: reading them, and the light that a vertex receives"
  "apertura-sh = ${PROJECT_VERSION}, OpenImageIO, spng, Imath, OpenEXR" "-lmeshoptimizer")
if(APERTURA_RENDER)
  apertura_install_pc(renderer "draws baked assets with Vulkan" "apertura-asset = ${PROJECT_VERSION}, vulkan" "")
endif()
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
