# shellcheck shell=bash
# shellcheck disable=SC2034  # the variables are for the scripts that source this file
# Common ground of the scripts: sourced, never run. Sets ROOT, BUILD, DEVEL, JOBS and an environment
# that knows no other workspace.

# --help of every script: the comment at its top.
case "${1:-}" in
  -h | --help)
    sed -n '2,/^[^#]/{s/^# \{0,1\}//p}' "$0"
    exit 0
    ;;
esac

ROOT=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
BUILD=$ROOT/build
DEVEL=$ROOT/devel

# ROS modules belong to the system's python3; a pyenv, conda or venv python earlier in PATH breaks
# catkin with "No module named 'catkin_pkg'".
export PATH="/usr/bin:/bin:/usr/sbin:/sbin:$PATH"
unset PYTHONHOME VIRTUAL_ENV PYTHONPATH

# A workspace sourced before would be chained in silently.
unset CMAKE_PREFIX_PATH ROS_PACKAGE_PATH ROSLISP_PACKAGE_DIRECTORIES AMENT_PREFIX_PATH

# One compiler job needs up to 1.5 GB.
memory_jobs=$(awk '/MemAvailable/ {n = int($2 / 1500000); print n < 1 ? 1 : n}' /proc/meminfo)
JOBS=${JOBS:-$(nproc)}
if ((JOBS > memory_jobs)); then JOBS=$memory_jobs; fi

say() { printf '\n== %s\n' "$*"; }
fail() {
  printf 'error: %s\n' "$*" >&2
  exit 1
}

# source_setup FILE: the setup files of catkin do not survive `set -u`.
source_setup() {
  set +u
  # shellcheck disable=SC1090
  . "$1"
  set -u
}

# system_ros: the distribution's own ROS, before any workspace. Debian keeps it in /usr, where nothing
# needs to be sourced; Ubuntu's packages live in /opt/ros/noetic.
system_ros() {
  if [ -f /opt/ros/noetic/setup.bash ]; then source_setup /opt/ros/noetic/setup.bash; fi
}

# use_workspace PREFIX: source a devel or install space; the host name need not resolve.
use_workspace() {
  local setup=$1/setup.bash
  [ -f "$setup" ] || fail "$setup is missing: run 'make build' first"
  source_setup "$setup"
  export ROS_HOSTNAME=localhost
  unset ROS_IP
}

# free_port: a TCP port that nobody listens on at this moment, and that the system gives to nobody who does not ask for it.
free_port() {
  python3 "$ROOT/scripts/free_port.py"
}
