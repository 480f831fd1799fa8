#!/bin/sh
# Installs a build of taut into a stage, then builds and runs the outside project and the installed example programs with it:
# through CMake, and one source through pkg-config with nothing but the compiler.
#   run.sh BUILD_DIR [CXX [GENERATOR]]   GENERATOR as in cmake -G: a machine that built with Ninja need not have make
set -eu
here=$(cd "$(dirname "$0")" && pwd -P)
build=$1
cxx=${2:-c++}
generator=${3:-Ninja}
stage=$build/stage

rm -rf "$stage" "$stage-moved" "$build/outside" "$build/outside-examples"
cmake --install "$build" --prefix "$stage" >/dev/null
# An installed tree may be moved: nothing in it knows where it was.
mv "$stage" "$stage-moved"
stage=$(cd "$stage-moved" && pwd -P)

echo "== program"
# Where there is a program, a scene that it begins names the installed schema.
taut=$(find "$stage" -type f -name taut -path '*/bin/*')
if [ -n "$taut" ]; then
  "$taut" new "$stage/own.json" >/dev/null
  grep -qF "\"$stage/share/taut/taut-scene.schema.json\"" "$stage/own.json"
  "$taut" schema | cmp - "$stage/share/taut/taut-scene.schema.json"
  "$taut" check "$stage/own.json" >/dev/null
  # The installed examples name one beside them.
  for scene in "$stage"/share/taut/examples/*.json; do
    case $scene in *.schema.json) continue ;; esac
    named=$(sed -n 's/.*"\$schema": "\([^"]*\)".*/\1/p' "$scene")
    test -z "$named" || cmp "$stage/share/taut/examples/$named" "$stage/share/taut/taut-scene.schema.json"
  done
fi

echo "== CMake"
cmake -S "$here" -B "$build/outside" -G "$generator" -DCMAKE_PREFIX_PATH="$stage" -DCMAKE_CXX_COMPILER="$cxx" \
  -DCMAKE_BUILD_TYPE=Release >/dev/null
cmake --build "$build/outside"
"$build/outside/bridge"

echo "== examples"
# Those that make pages need three.js, installed or not.
programs=$stage/share/doc/taut/examples
cmp "$here/../../scenes/examples/CMakeLists.txt" "$programs/CMakeLists.txt"
cmake -S "$programs" -B "$build/outside-examples" -G "$generator" -DCMAKE_PREFIX_PATH="$stage" -DCMAKE_CXX_COMPILER="$cxx" >/dev/null
cmake --build "$build/outside-examples"
for source in "$here"/../../scenes/examples/*.cpp; do test -x "$build/outside-examples/$(basename "$source" .cpp)"; done
made=$build/outside-examples/made
mkdir -p "$made"
three=$(find "$stage" -type d -path '*/share/taut/three')
if [ -n "$three" ]; then
  export TAUT_THREE="$three"
  for example in pendulum ramp truss cart_pole go_on; do "$build/outside-examples/$example" "$made"; done
  "$build/outside-examples/from_file" "$stage/share/taut/examples/four_bar.json" "$made" 1
  for file in pendulum.html pendulum.svg from_file.glb from_file.xml; do test -s "$made/$file"; done
else
  echo "without three.js no pages"
fi

echo "== pkg-config"
PKG_CONFIG_PATH=$(dirname "$(find "$stage" -name taut.pc)")
export PKG_CONFIG_PATH
libdir=$(pkg-config --variable=libdir taut)
# shellcheck disable=SC2046  # the flags are words
"$cxx" -std=c++20 -O2 $(pkg-config --cflags taut) "$here/bridge.cpp" $(pkg-config --libs taut) -o "$build/outside/bridge_pc"
LD_LIBRARY_PATH=$libdir${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH} "$build/outside/bridge_pc"
"$cxx" -std=c++20 -O1 $(pkg-config --cflags taut-io) "$programs/go_on.cpp" $(pkg-config --libs taut-io) \
  -o "$build/outside/go_on_pc"
if [ -n "$three" ]; then LD_LIBRARY_PATH=$libdir${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH} "$build/outside/go_on_pc" "$made"; fi
