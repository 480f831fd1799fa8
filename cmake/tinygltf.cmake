# TinyGLTF::TinyGLTF as a compiled library, as Debian has it.  Where tinygltf is a header alone, as from Conan, vcpkg and
# conda-forge, taut_io compiles it: TAUT_TINYGLTF_SOURCE.
option(TAUT_TINYGLTF_HEADER "tinygltf is a header alone" OFF)
if(TAUT_TINYGLTF_HEADER)
  find_path(TINYGLTF_INCLUDE_DIR tiny_gltf.h REQUIRED)
  set(TAUT_TINYGLTF_SOURCE ${CMAKE_CURRENT_BINARY_DIR}/tinygltf.cpp)
  file(CONFIGURE OUTPUT ${TAUT_TINYGLTF_SOURCE} CONTENT
       "#define TINYGLTF_IMPLEMENTATION\n#include <nlohmann/json.hpp>\n#include <tiny_gltf.h>\n")
  set_source_files_properties(${TAUT_TINYGLTF_SOURCE} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON COMPILE_OPTIONS -w)
  add_library(taut_tinygltf INTERFACE)
  target_include_directories(taut_tinygltf SYSTEM INTERFACE ${TINYGLTF_INCLUDE_DIR})
  # No images are read or written.
  target_compile_definitions(taut_tinygltf INTERFACE TINYGLTF_NO_INCLUDE_JSON TINYGLTF_NO_STB_IMAGE TINYGLTF_NO_STB_IMAGE_WRITE)
  set(TAUT_TINYGLTF $<BUILD_INTERFACE:taut_tinygltf>)
else()
  find_package(TinyGLTF REQUIRED)
  set(TAUT_TINYGLTF TinyGLTF::TinyGLTF)
endif()
