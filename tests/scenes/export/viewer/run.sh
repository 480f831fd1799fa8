#!/usr/bin/env bash
# Runs a script of this folder with node:  run.sh PROGRAM SAMPLE SCRIPT ARGUMENTS…
# Needs node 18 or later, a Chromium and the packages of package.json (npm install --prefix tests/scenes/export/viewer).  Without them it
# says so and exits with 77, which ctest shows as skipped; with TAUT_REQUIRE_BROWSER=1 it fails.  Without Debian's
# python3-vtk9 the tests of VTK files alone are skipped.
set -euo pipefail
folder=$(dirname "$(readlink -f "$0")")
export TAUT_PROGRAM=$1 TAUT_SAMPLE=$2
script=$3
shift 3

missing() {
  echo "SKIPPED, nothing of the viewer was tested: $1" >&2
  [ -n "${TAUT_REQUIRE_BROWSER:-}" ] && exit 1
  exit 77
}

for name in ${CHROMIUM:-} chromium chromium-browser google-chrome; do
  CHROMIUM=$(command -v "$name") && break
done
[ -n "${CHROMIUM:-}" ] || missing "there is no Chromium (Debian: apt-get install chromium)"
export CHROMIUM
command -v node >/dev/null || missing "there is no node (Debian: apt-get install nodejs)"
[ -d "$folder/node_modules/playwright-core" ] ||
  missing "npm packages are missing (npm install --prefix tests/scenes/export/viewer)"
[ -n "${TAUT_THREE:-}" ] || [ -d "$folder/../../../../scenes/export/viewer/node_modules/three" ] ||
  missing "three.js is missing (npm install --prefix scenes/export/viewer)"
for python in python3 /usr/bin/python3; do
  "$python" -c 'import vtkmodules.vtkIOXML' 2>/dev/null && export TAUT_VTK_PYTHON=$python && break
done
[ -n "${TAUT_VTK_PYTHON:-}" ] || [ -z "${TAUT_REQUIRE_BROWSER:-}" ] ||
  missing "VTK is missing (Debian: apt-get install python3-vtk9)"
case $script in
  *.test.mjs) exec node --test "$@" "$folder/$script" ;;
  *) exec node "$folder/$script" "$@" ;;
esac
