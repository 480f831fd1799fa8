#!/usr/bin/env bash
# Every chain, bridge, net and joint grid at full length and both steps, as a Markdown table:
#   benchmarks/joint_promise.sh [largest number of bodies, 15000 [steps in seconds]]     (about half an hour)
# Exit status 0 only if every run succeeded with its joints closed to 1e-9 m and rad.
set -uo pipefail
root=$(dirname "$(dirname "$(readlink -f "$0")")")
limit=${1:-15000}
steps=${2:-0.004166666666666667 0.001}
report=$(mktemp)
trap 'rm -f "$report"' EXIT
failed=0

value() { grep -o "\"$1\": *[^,}]*" "$report" | head -1 | sed 's/.*: *//; s/"//g'; }

run() { # scene bodies seconds step arguments
  local scene=$1 bodies=$2 seconds=$3 step=$4
  shift 4
  [ "$bodies" -le "$limit" ] || return 0
  : >"$report" # a run that writes none has nothing of the run before
  "$root/taut" run "$scene" --quiet --time "$seconds" --dt "$step" --report "$report" "$@" >/dev/null 2>&1
  local status=$? gap angle
  gap=$(value max_joint_error_m) angle=$(value max_joint_angle_error_rad)
  if [ $status != 0 ] || ! awk -v g="$gap" -v a="$angle" 'BEGIN {exit !(g <= 1e-9 && a <= 1e-9)}'; then failed=1; fi
  printf '| %s %s | %.4g | %s | %s | %s | %s | %s | %.3g |\n' "$scene" "$(printf '%s ' "$@" | sed 's/--set //g')" \
    "$step" "$(value status)" "$gap" "$angle" "$(value max_drift_rel)" \
    "$(awk -v s="$(value substeps)" -v n="$(value steps)" 'BEGIN {printf "%.2f", s / n}')" "$(value wall_time_s)"
}

echo "| scene | step [s] | status | gap [m] | gap [rad] | energy drift | sub-steps a step | wall [s] |"
echo "|---|---|---|---|---|---|---|---|"
for step in $steps; do
  for n in 1 2; do
    run pendulum-ball $n 10 $step --set n=$n
    run pendulum-hinge $n 10 $step --set n=$n
  done
  for size in "10 5" "100 5" "1000 2" "10000 1"; do
    read -r n seconds <<<"$size"
    run chain "$n" "$seconds" $step --set "n=$n"
    run chain-heavy "$n" "$seconds" $step --set "n=$n"
  done
  for size in "10 5" "50 5" "200 2" "1000 1"; do
    read -r n seconds <<<"$size"
    for truck in false true; do
      run bridge-hinge "$n" "$seconds" $step --set "n=$n" --set truck=$truck
      run bridge-balls "$n" "$seconds" $step --set "n=$n" --set truck=$truck
    done
  done
  for size in "5 40 5" "10 180 5" "20 760 2" "40 3120 1" "80 12640 0.5"; do
    read -r n bodies seconds <<<"$size"
    run net-flag "$bodies" "$seconds" $step --set "n=$n"
    run net-corners "$bodies" "$seconds" $step --set "n=$n"
  done
  for n in 10 20; do run joint-grid $((n * n)) 2 $step --set n=$n --set swing=true; done
done
exit $failed
