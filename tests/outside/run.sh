#!/bin/sh
# Installs a build of taut into a stage, then builds and runs the outside project against it: through CMake, and the
# same source through pkg-config with nothing but the compiler.
#   run.sh BUILD_DIR [CXX [GENERATOR]]   GENERATOR as in cmake -G: a machine that built with Ninja need not have make
set -eu
here=$(cd "$(dirname "$0")" && pwd -P)
build=$1
cxx=${2:-c++}
generator=${3:-Ninja}
stage=$build/stage

rm -rf "$stage" "$stage-moved" "$build/outside"
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
fi

echo "== CMake"
cmake -S "$here" -B "$build/outside" -G "$generator" -DCMAKE_PREFIX_PATH="$stage" -DCMAKE_CXX_COMPILER="$cxx" \
  -DCMAKE_BUILD_TYPE=Release >/dev/null
cmake --build "$build/outside"
"$build/outside/bridge"

echo "== pkg-config"
PKG_CONFIG_PATH=$(dirname "$(find "$stage" -name taut.pc)")
export PKG_CONFIG_PATH
libdir=$(pkg-config --variable=libdir taut)
# shellcheck disable=SC2046  # the flags are words
"$cxx" -std=c++20 -O2 $(pkg-config --cflags taut) "$here/bridge.cpp" $(pkg-config --libs taut) -o "$build/outside/bridge_pc"
LD_LIBRARY_PATH=$libdir${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH} "$build/outside/bridge_pc"
