#!/bin/sh
# Whether the launcher runs what its own folder has, also where that was moved or copied with its build, or fails and says so:
#   launcher.sh LAUNCHER
# The sources are a program of three lines, which prints a word, its last argument, and how it was called.
set -eu
launcher=$(cd "$(dirname "$1")" && pwd -P)/$(basename "$1")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
unset TAUT_BUILD_DIR CMAKE_GENERATOR
cd "$work"

# All packages are there.
mkdir bin
printf '#!/bin/sh\necho installed\n' >bin/dpkg-query
chmod +x bin/dpkg-query
PATH=$work/bin:$PATH

mkdir first
cp "$launcher" first/taut
cat >first/CMakeLists.txt <<'END'
cmake_minimum_required(VERSION 3.25)
project(stand_in LANGUAGES C)
add_executable(taut_program main.c)
set_target_properties(taut_program PROPERTIES OUTPUT_NAME taut RUNTIME_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}")
END
cat >first/CMakePresets.json <<'END'
{"version": 6, "configurePresets": [{"name": "release", "binaryDir": "${sourceDir}/build/release"}]}
END
# A clock may be coarse: what is written later is made to look so.
seconds=0
say() { # FOLDER WORD  The program of this folder prints the word from now on.
  printf '#include <stdio.h>\nint main(int n, char** words) { return printf("%s %%s %%s\\n", words[n - 1], words[0]) < 0; }\n' "$2" >"$1/main.c"
  seconds=$((seconds + 1))
  touch -d "+$seconds seconds" "$1/main.c"
}
expect() { # FOLDER TEXT
  said=$("$1/taut" list 2>"$work/errors") || { cat "$work/errors" && exit 1; }
  [ "$said" = "$2 list $1/taut" ] || { echo "$1: '$said' in place of '$2 list $1/taut'" && exit 1; }
}

say first one
expect first one
say first two
expect first two

mv first second # the old place is gone
say second three
expect second three

cp -a second third # the old place still builds
say third four
expect third four
expect second three
TAUT_BUILD_DIR=$work/elsewhere expect third four
mv elsewhere elsewhere_else
say third five
TAUT_BUILD_DIR=$work/elsewhere_else expect third five

# A link to the launcher, as in ~/bin, is the launcher.
ln -s "$work/third/taut" linked
said=$(./linked list 2>/dev/null)
[ "$said" = "five list ./linked" ]

# What cannot be built is not run as it was.
echo 'int main(' >third/main.c
touch -d '+1 minute' third/main.c
if third/taut list >said 2>errors; then echo "a failed build ends with 0" && exit 1; fi
[ ! -s said ] && grep -q 'the build failed' errors
rm third/CMakeLists.txt
mv third fourth
if fourth/taut list >said 2>errors; then echo "a failed configuration ends with 0" && exit 1; fi
[ ! -s said ] && grep -q 'could not configure' errors
