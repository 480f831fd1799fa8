# cmake --install: the library, its headers, the program, and what find_package(taut) and pkg-config need.
include(CMakePackageConfigHelpers)

set_target_properties(taut PROPERTIES VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
set(TAUT_CMAKE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/taut)

install(TARGETS taut EXPORT taut-targets)
if(TAUT_BUILD_PROGRAM)
  install(TARGETS taut_program)
  # For editors; `taut new` names it in the scenes that it writes.
  install(FILES ${TAUT_SCENE_SCHEMA} DESTINATION ${CMAKE_INSTALL_DATADIR}/taut)
  # What a page needs of three.js, where the installed program looks for it; nothing if npm did not get it.
  foreach(file build/three.core.js build/three.module.js examples/jsm/controls/OrbitControls.js LICENSE)
    get_filename_component(folder ${file} DIRECTORY)
    install(FILES ${TAUT_THREE_DIR}/${file} DESTINATION ${CMAKE_INSTALL_DATADIR}/taut/three/${folder} OPTIONAL)
  endforeach()
endif()
include(cmake/public_headers.cmake)
public_headers(TAUT_PUBLIC_HEADERS solvers/taut.h solvers/friction/friction_solver.h)
foreach(header IN LISTS TAUT_PUBLIC_HEADERS)
  get_filename_component(folder ${header} DIRECTORY)
  install(FILES ${header} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/taut/${folder})
endforeach()
install(FILES solvers/taut.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/taut)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})

install(EXPORT taut-targets NAMESPACE taut:: DESTINATION ${TAUT_CMAKE_DIR})
get_target_property(TAUT_LIBRARY_TYPE taut TYPE)
configure_package_config_file(cmake/taut-config.cmake.in ${PROJECT_BINARY_DIR}/taut-config.cmake
                              INSTALL_DESTINATION ${TAUT_CMAKE_DIR})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/taut-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/taut-config.cmake ${PROJECT_BINARY_DIR}/taut-config-version.cmake
              cmake/FindCHOLMOD.cmake
        DESTINATION ${TAUT_CMAKE_DIR})

# pkg-config.  The prefix is found from where the file is, so that an installed tree may be moved.
file(RELATIVE_PATH TAUT_PREFIX_FROM_PC ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig ${CMAKE_INSTALL_PREFIX})
string(REGEX REPLACE "/$" "" TAUT_PREFIX_FROM_PC "${TAUT_PREFIX_FROM_PC}")
get_target_property(definitions taut INTERFACE_COMPILE_DEFINITIONS)
list(TRANSFORM definitions PREPEND -D OUTPUT_VARIABLE TAUT_PC_DEFINITIONS)
list(JOIN TAUT_PC_DEFINITIONS " " TAUT_PC_DEFINITIONS)
set(private "-lcholmod -lsuitesparseconfig -lfcl -lccd -lassimp ${OpenMP_CXX_FLAGS} ${CMAKE_THREAD_LIBS_INIT}")
if(CMAKE_DL_LIBS)
  string(APPEND private " -l${CMAKE_DL_LIBS}")
endif()
# A static library needs them in any case; who links a shared one need not know.
if(TAUT_LIBRARY_TYPE STREQUAL STATIC_LIBRARY)
  set(TAUT_PC_LIBS " ${private}")
else()
  set(TAUT_PC_LIBS_PRIVATE " ${private}")
endif()
configure_file(cmake/taut.pc.in ${PROJECT_BINARY_DIR}/taut.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/taut.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
