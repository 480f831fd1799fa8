# The target `package`: taut, taut-dev and, with TAUT_BUILD_PYTHON, python3-taut, for the Debian that builds them.  The preset
# `package` sets what they need: shared libraries below /usr.
set(TAUT_PACKAGE_MAINTAINER "The taut authors <taut@packages.invalid>" CACHE STRING "Who answers for the packages")

# A tag v1.2.3 is version 1.2.3, which CMakeLists.txt has to name; any other commit is later than the version it names.
function(package_version result)
  set(${result} ${PROJECT_VERSION} PARENT_SCOPE)
  find_package(Git QUIET)
  if(NOT Git_FOUND OR NOT EXISTS ${PROJECT_SOURCE_DIR}/.git)
    return()
  endif()
  set(git ${GIT_EXECUTABLE} -C ${PROJECT_SOURCE_DIR})
  execute_process(COMMAND ${git} describe --tags --exact-match --match "v[0-9]*" OUTPUT_VARIABLE tag ERROR_QUIET
                  OUTPUT_STRIP_TRAILING_WHITESPACE)
  if(tag AND NOT tag STREQUAL "v${PROJECT_VERSION}")
    message(FATAL_ERROR "This commit is ${tag}, but CMakeLists.txt says version ${PROJECT_VERSION}")
  elseif(NOT tag)
    execute_process(COMMAND ${git} log -1 --format=%cd.%h --date=format:%Y%m%d%H%M OUTPUT_VARIABLE commit
                    OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
    set(${result} ${PROJECT_VERSION}+git${commit} PARENT_SCOPE)
  endif()
endfunction()

# The recipes beside this file name it, too.
foreach(file CITATION.cff cmake/packaging/vcpkg/taut/vcpkg.json cmake/packaging/conda/recipe.yaml)
  file(STRINGS ${PROJECT_SOURCE_DIR}/${file} line REGEX "^ *\"?version\"?: \"?${PROJECT_VERSION}\"?,?$")
  if(NOT line)
    message(FATAL_ERROR "${file} does not say version ${PROJECT_VERSION}")
  endif()
endforeach()

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "")  # each package has its own
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)  # CPack then says that the Python module has no soname, which is right
package_version(CPACK_PACKAGE_VERSION)
set(CPACK_PACKAGE_CONTACT ${TAUT_PACKAGE_MAINTAINER})
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_COMPONENTS_ALL runtime development)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

set(about "taut simulates rigid bodies with very many joints, such as nets, bridges,
cables and linkages, with contact and friction.  All joints are solved
together with a sparse Cholesky factor, in position and in velocity.
.
")
set(CPACK_DEBIAN_RUNTIME_PACKAGE_NAME taut)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SECTION science)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_RECOMMENDS libopenblas0-pthread)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SUGGESTS gnuplot-nox)
set(CPACK_DEBIAN_RUNTIME_DESCRIPTION "simulation of rigid bodies with very many joints
${about}This package has the program, the shared libraries, example scenes and
what pages with a view of a simulation need.")
set(CPACK_DEBIAN_RUNTIME_PACKAGE_CONTROL_EXTRA ${CMAKE_CURRENT_LIST_DIR}/debian/triggers)

set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME taut-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "taut (= ${CPACK_PACKAGE_VERSION}), libeigen3-dev (>= 3.4)")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SUGGESTS "g++, cmake, pkg-config")
set(CPACK_DEBIAN_DEVELOPMENT_DESCRIPTION "simulation of rigid bodies with very many joints: C++ headers
${about}This package has headers, and what CMake and pkg-config need.")

# Of each package: its licence, and what is new.
find_program(GZIP_PROGRAM gzip REQUIRED)
set(changes ${PROJECT_BINARY_DIR}/changelog.gz)
add_custom_command(OUTPUT ${changes} DEPENDS ${PROJECT_SOURCE_DIR}/CHANGELOG.md VERBATIM
                   COMMAND sh -c "\"$0\" -9nc \"$1\" >\"$2\"" ${GZIP_PROGRAM} ${PROJECT_SOURCE_DIR}/CHANGELOG.md ${changes})
set(package_files ${changes})
function(package_documents component package)
  install(FILES ${PROJECT_SOURCE_DIR}/cmake/packaging/debian/copyright ${changes}
          DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${package} COMPONENT ${component})
endfunction()
package_documents(runtime taut)
package_documents(development taut-dev)

# The page of `man taut` is what `taut --help` says.
find_program(HELP2MAN_PROGRAM help2man REQUIRED)
set(manual ${PROJECT_BINARY_DIR}/taut.1.gz)
add_custom_command(OUTPUT ${manual} DEPENDS taut_program VERBATIM
                   COMMAND ${HELP2MAN_PROGRAM} --no-info --name=${PROJECT_DESCRIPTION}
                           --include=${CMAKE_CURRENT_LIST_DIR}/debian/taut.h2m --output=taut.1 $<TARGET_FILE:taut_program>
                   COMMAND ${GZIP_PROGRAM} -9nf taut.1)
list(APPEND package_files ${manual})
install(FILES ${manual} DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT runtime)

if(TAUT_BUILD_PYTHON)
  list(APPEND CPACK_COMPONENTS_ALL python)
  find_package(Python REQUIRED COMPONENTS Interpreter)  # again, since what scenes/python found is known there only
  math(EXPR next_minor "${Python_VERSION_MINOR} + 1")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-taut)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
  set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${PROJECT_BINARY_DIR})
  string(JOIN ", " CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "taut (= ${CPACK_PACKAGE_VERSION})"
         "python3 (>= 3.${Python_VERSION_MINOR}~)" "python3 (<< 3.${next_minor})" python3-numpy python3-scipy)
  set(CPACK_DEBIAN_PYTHON_DESCRIPTION "simulation of rigid bodies with very many joints: Python module
${about}This package has the module taut for Debian's Python 3.")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA ${CMAKE_CURRENT_LIST_DIR}/debian/postinst
      ${CMAKE_CURRENT_LIST_DIR}/debian/prerm)
  package_documents(python python3-taut)
  # What `pip list` and importlib.metadata read.
  file(CONFIGURE OUTPUT taut.dist-info CONTENT
       "Metadata-Version: 2.1\nName: taut\nVersion: ${PROJECT_VERSION}\nSummary: ${PROJECT_DESCRIPTION}\n")
  cmake_path(GET TAUT_PYTHON_DIR PARENT_PATH modules)
  install(FILES ${PROJECT_BINARY_DIR}/taut.dist-info DESTINATION ${modules}/taut-${PROJECT_VERSION}.dist-info RENAME METADATA
          COMPONENT python)
endif()
add_custom_target(taut_package_files ALL DEPENDS ${package_files})
include(CPack)
