#!/bin/sh
# taut as a part of another project: by FetchContent and by add_subdirectory, each built, linked and run, without optimisation
# and with all assertions.  The objects of the second are those of the first.
#   sources.sh FOLDER [CXX [GENERATOR [LAUNCHER]]]   works in FOLDER/outside-sources; LAUNCHER: ccache
set -eu
here=$(cd "$(dirname "$0")" && pwd -P)
folder=$1/outside-sources
cxx=${2:-c++}
generator=${3:-Ninja}
launcher=${4:-${CMAKE_CXX_COMPILER_LAUNCHER:-}}
three=${TAUT_THREE:-$here/../../scenes/export/viewer/node_modules/three}
# What work on taut itself asks for is not asked of its users.
export TAUT_WERROR=ON

# configure BUILD FORM OPTION…
configure() {
  at=$1 form=$2
  shift 2
  cmake -S "$here" -B "$at" -G "$generator" -DTAUT_FROM="$form" -DCMAKE_CXX_COMPILER="$cxx" \
    -DCMAKE_CXX_COMPILER_LAUNCHER="$launcher" -DCMAKE_EXPORT_COMPILE_COMMANDS=ON "$@" >/dev/null
}
# The commands that compile taut, or the project's own programs.
commands_of_taut() { grep '"command"' "$1/compile_commands.json" | grep -e ' -o _deps/taut-build/'; }
commands_of_project() { grep '"command"' "$1/compile_commands.json" | grep -v -e ' -o _deps/taut-build/'; }

echo "== functions"
# Functions of CMake are everybody's.
if grep -nE '^ *(function|macro)\(' "$here"/../../CMakeLists.txt "$here"/../../cmake/*.cmake | grep -v '(taut_'; then exit 1; fi

echo "== no type of build"
# taut is optimised all the same, and the project is compiled as it says: not at all.
rm -rf "$folder"
configure "$folder/plain" add_subdirectory
commands_of_taut "$folder/plain" | grep -q -- ' -O3 -DNDEBUG '
if commands_of_project "$folder/plain" | grep -e ' -O' -e DNDEBUG -e '-ffp-contract' -e Wshadow; then exit 1; fi
if commands_of_taut "$folder/plain" | grep -e '-Werror'; then exit 1; fi
grep -q '^CMAKE_BUILD_TYPE:STRING=$' "$folder/plain/CMakeCache.txt"

echo "== C++17"
# A project of an older standard links taut all the same; its programs that include taut are C++20.
configure "$folder/plain" FetchContent -DCMAKE_CXX_STANDARD=17 -DBUILD_SHARED_LIBS=ON -DBUILD_TESTING=OFF
if grep '"command"' "$folder/plain/compile_commands.json" | grep -v -e '-std=[a-z+]*20'; then exit 1; fi

for form in FetchContent add_subdirectory; do
  echo "== $form"
  # Without optimisation and debugging information, many sources as one, it is compiled soonest.
  configure "$folder/build" $form -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS_DEBUG= -DCMAKE_UNITY_BUILD=ON -DCMAKE_UNITY_BUILD_BATCH_SIZE=24
  cmake --build "$folder/build" --parallel "${CMAKE_BUILD_PARALLEL_LEVEL:-2}"
  "$folder/build/rod"
  # A page needs three.js.
  "$folder/build/from_file" "$here/../../scenes/examples/four_bar.json" "$folder" 0.2 || test ! -d "$three"
  for file in from_file.glb from_file.xml; do test -s "$folder/$file"; done
  if [ -d "$three" ]; then test -s "$folder/from_file.html"; fi
  rm -f "$folder"/from_file.*
  rm "$folder/build/rod" "$folder/build/from_file" # linked anew by the other form
done

echo "== tests and installation"
ctest --test-dir "$folder/build" -N | grep -q 'Total Tests: 0'
cmake --install "$folder/build" --prefix "$folder/stage" >/dev/null
if [ -d "$folder/stage" ] && [ -n "$(find "$folder/stage" -type f)" ]; then
  echo "taut has installed itself"
  exit 1
fi
