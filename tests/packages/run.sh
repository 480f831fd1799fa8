#!/usr/bin/env bash
# Installs the Debian packages of taut on a bare Debian 12, in a folder of its own, and uses them there: the program without a
# compiler, the Python module, and the library from an outside project.
#   run.sh [FOLDER]   FOLDER with taut*.deb and python3-taut*.deb, as `./taut package` makes them; default: build/package
# It needs root, mmdebstrap and Debian's archive, and is skipped (exit status 77) where one of them is missing.
set -euo pipefail
TIMEFORMAT='%R s, of which %U + %S s of processor time'
tree=$(cd "$(dirname "$0")/../.." && pwd -P)
skip() {
  echo "skipped: $*"
  exit 77
}
[ -d "${1:-$tree/build/package}" ] || skip "needs the packages that ./taut package makes"
debs=$(cd "${1:-$tree/build/package}" && pwd -P)
[ "$(id -u)" = 0 ] || skip "needs root"
command -v mmdebstrap >/dev/null || skip "needs mmdebstrap (apt-get install mmdebstrap)"
for deb in taut taut-dev python3-taut; do
  [ "$(find "$debs" -maxdepth 1 -name "${deb}_*.deb" | wc -l)" = 1 ] || skip "needs one ${deb}_*.deb in $debs"
done

# What is mounted here goes with this process.
if [ "${TAUT_UNSHARED:-}" = "" ]; then
  TAUT_UNSHARED=1 exec unshare --mount --propagation private "$0" "$debs"
fi
work=$(mktemp -d)
bare=$work/bare
clean() {
  umount "$bare/proc" 2>/dev/null || true
  rm -rf --one-file-system "$work"
}
trap clean EXIT

echo "== a bare Debian 12"
# As this machine reaches the archive: its list of it where it is a Debian 12 itself, and its settings of apt.
sources=/etc/apt/sources.list.d/debian.sources
[ -f "$sources" ] || sources=/etc/apt/sources.list
grep -qs bookworm "$sources" || sources=
apt-config dump | grep -i '^Acquire::.*\(proxy\|verify\|cainfo\|retries\)' >"$work/apt.conf" || true
# shellcheck disable=SC2086  # no word if there is no list
mmdebstrap --quiet --variant=minbase --aptopt="$work/apt.conf" --skip=cleanup/apt bookworm "$bare" $sources ||
  skip "cannot reach Debian's archive"
mount -t proc proc "$bare/proc"
mkdir "$bare/debs"
cp "$debs"/*.deb "$bare/debs"
inside() {
  chroot "$bare" /usr/bin/env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LANG=C.UTF-8 DEBIAN_FRONTEND=noninteractive "$@"
}
installed() { inside dpkg-query -W -f '${Package}\n' | wc -l; }
# Of all children so far, in whole seconds.
processor_seconds() { awk '{ print int(($16 + $17) / 100) }' "/proc/$$/stat"; }
# install PACKAGE…  as users do; what apt says only if it fails.
install() {
  inside sh -c "apt-get install -y -q $*" >"$work/apt.log" 2>&1 || {
    cat "$work/apt.log"
    exit 1
  }
}
no_compiler() {
  for tool in cc c++ gcc g++ clang make cmake ninja; do
    if inside sh -c "command -v $tool"; then exit 1; fi
  done
}

echo "== apt install ./taut*.deb && taut run bridge"
before=$(installed)
install_and_run() {
  install './debs/taut_*.deb'
  inside taut run bridge | tee "$work/bridge.log"
}
# A minute of a machine that does nothing else; on a busy one the clock says nothing.
start=$(processor_seconds)
time install_and_run
[ $(($(processor_seconds) - start)) -le 60 ] || {
  echo "more than a minute"
  exit 1
}
grep -q '^status  *success' "$work/bridge.log"
echo "$(($(installed) - before)) packages, $(du -sm "$bare/var/cache/apt/archives" | cut -f1) MB"

no_compiler

echo "== pages and example scenes"
inside taut run /usr/share/taut/examples/four_bar.json --time 1 --html /root/four_bar.html >"$work/page.log"
grep -q OrbitControls "$bare/root/four_bar.html"
inside taut new /root/own.json >/dev/null
grep -qF '"/usr/share/taut/taut-scene.schema.json"' "$bare/root/own.json"
inside taut check /root/own.json >/dev/null

echo "== Python"
before=$(installed)
install --no-install-recommends './debs/python3-taut_*.deb' # SciPy itself depends on Pythran, and so on a C compiler
echo "$(($(installed) - before)) packages"
inside python3 - <<'PYTHON'
import importlib.metadata
import taut

world = taut.World()
rod = world.add_body("rod", taut.MassProperties.rod(1.0, 0.01, mass=1.0), taut.Pose(p=[0.5, 0, 0]))
world.add("pivot", taut.Hinge.at(world, taut.GROUND, rod, [0, 0, 0], [0, 1, 0]))
simulator = taut.Simulator(world)
report = simulator.step(1 / 240)
assert report.ok() and report.gap.metres < 1e-9, report
assert -1e-3 < world.positions[rod][2] < 0, world.positions[rod]
assert taut.jacobian(world).shape == (5, 12)
with open("/root/python.html", "w") as page:
    page.write(taut.simulate(taut.build_scene("bridge", n=10), duration=0.1).page())
print("taut", importlib.metadata.version("taut"), report)
PYTHON
grep -q OrbitControls "$bare/root/python.html"

echo "== a project of one's own"
before=$(installed)
install --no-install-recommends g++ cmake make pkg-config './debs/taut-dev_*.deb'
echo "$(($(installed) - before)) packages"
mkdir -p "$bare/src/tests"
cp -r "$tree/tests/outside" "$bare/src/tests"
inside cmake -S /src/tests/outside -B /src/build -DCMAKE_BUILD_TYPE=Release >"$work/cmake.log"
inside cmake --build /src/build
inside /src/build/bridge
inside cmake -S /usr/share/doc/taut/examples -B /src/examples >"$work/cmake.log"
time inside cmake --build /src/examples --target pendulum from_file
inside /src/examples/pendulum /root
inside /src/examples/from_file /usr/share/taut/examples/four_bar.json /root 1
inside sh -c 'g++ -std=c++20 /src/tests/outside/bridge.cpp $(pkg-config --cflags --libs taut) -o /src/bridge_pc && /src/bridge_pc'

# No file of the packages says where to look for libraries: they are where every program finds them.
if inside sh -c 'dpkg -L taut python3-taut | grep -E "/bin/taut$|\.so" | xargs readelf -d' | grep -E 'RPATH|RUNPATH'; then exit 1; fi

echo "== and away again"
inside apt-get purge -y -q taut taut-dev python3-taut >/dev/null
left=$(find "$bare/usr" -path '*taut*')
[ -z "$left" ] || {
  echo "left behind: $left"
  exit 1
}
echo "all holds"
