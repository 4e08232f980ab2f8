# shellcheck shell=bash
# shellcheck disable=SC2154  # out and log are the caller's
# Acts with their times, and all layers live on a bag: sourced by the demos after env.sh.

begin_acts() {
  mkdir -p "$log"
  : > "$log/times.tsv"
}

# act NAME COMMAND…: one step, its time noted (wall, and of the processors); its output is in log/.
act() {
  local name=$1 TIMEFORMAT="%R %U %S"
  shift
  { time "$@" > "$log/$name.txt" 2>&1; } 2> "$log/$name.time" ||
    { tail -n 20 "$log/$name.txt" >&2; fail "act $name failed (log: $log/$name.txt)"; }
  awk -v n="$name" '{printf "%s\t%.1f\t%.1f\n", n, $1, $2 + $3}' "$log/$name.time" >> "$log/times.tsv"
  rm "$log/$name.time"
}
# check ACT: what the act must have come to; says it in a line, ends the demo if it has not.
check() { scripts/demo_report check "$1" "$out"; }

# start_live ARGUMENT…: demo.launch under a master of its own.
start_live() {
  export ROS_HOME=$out/ros_home ROS_LOG_DIR=$out/ros_home/log
  local port
  port=$(free_port)
  export ROS_MASTER_URI=http://localhost:$port
  roslaunch -p "$port" hyselam_bringup demo.launch rviz:=false "$@" > "$log/roslaunch.txt" 2>&1 &
  launch=$!
  trap stop_live EXIT
  for _ in $(seq 100); do
    if timeout 5 rosparam get /use_sim_time > /dev/null 2>&1; then return; fi
    kill -0 "$launch" 2> /dev/null || { cat "$log/roslaunch.txt" >&2; fail "roslaunch ended early"; }
    sleep 0.2
  done
  fail "no master within 20 s (log: $log/roslaunch.txt)"
}
stop_live() {
  kill -INT "$launch" 2> /dev/null || return 0
  for _ in $(seq 100); do
    kill -0 "$launch" 2> /dev/null || return 0
    sleep 0.1
  done
  kill -TERM "$launch" 2> /dev/null || true
}
# end_live: stops it, and fails if a node died meanwhile, which roslaunch does not.
end_live() {
  # Their processors' time does not belong to any act.
  ps -o cputimes= --ppid "$launch" | awk '{s += $1} END {printf "nodes of the live acts\t\t%.1f\n", s}' >> "$log/times.tsv"
  stop_live
  wait "$launch" || true
  trap - EXIT
  if grep -E 'has died|exit code' "$log/roslaunch.txt"; then fail "a node died (log: $log/roslaunch.txt)"; fi
}
