# OpenMP::OpenMP_CXX.  Taut only tells the OpenMP runtime of CHOLMOD and OpenBLAS to start no threads of its own; that is
# GCC's, whoever compiles taut.  Clang without a runtime of its own therefore talks to it, too; GCC's header is not for it.
find_package(OpenMP QUIET COMPONENTS CXX)
if(NOT OpenMP_CXX_FOUND AND CMAKE_CXX_COMPILER_ID STREQUAL Clang)
  execute_process(COMMAND g++ -print-file-name=libgomp.so OUTPUT_VARIABLE libgomp OUTPUT_STRIP_TRAILING_WHITESPACE)
  if(EXISTS "${libgomp}")
    file(WRITE ${CMAKE_CURRENT_BINARY_DIR}/gomp/omp.h
         "extern \"C\" {\nint omp_get_max_active_levels(void);\nvoid omp_set_max_active_levels(int);\n}\n")
    add_library(OpenMP::OpenMP_CXX UNKNOWN IMPORTED)
    set_target_properties(OpenMP::OpenMP_CXX PROPERTIES IMPORTED_LOCATION ${libgomp}
                          INTERFACE_INCLUDE_DIRECTORIES ${CMAKE_CURRENT_BINARY_DIR}/gomp)
    set(OpenMP_CXX_FOUND TRUE)
  endif()
endif()
if(NOT OpenMP_CXX_FOUND)
  find_package(OpenMP REQUIRED COMPONENTS CXX)
endif()
