#!/usr/bin/env bash
# Checks the completions of bash: completion_test.sh COMPLETION_FILE BIN_FOLDER
set -u
source "$1"
PATH=$2:$PATH
wrong=0
compopt() { :; }

# expect "WORDS" LINE...: what is offered where the line ends.
expect() {
  local expected=$1
  shift
  COMP_WORDS=("$@") COMP_CWORD=$(($# - 1)) COMPREPLY=()
  _breakwater
  [ "${COMPREPLY[*]}" = "$expected" ] && return
  echo "$*: \"${COMPREPLY[*]}\" instead of \"$expected\""
  wrong=1
}

expect 'video' breakwater v
expect 'report replay reproduce' breakwater rep
expect 'arm_wall_contact arm_push' breakwater run arm
expect '--case --config --csv' breakwater run arm_push --c
expect 'drac-link1 drac-link2 drac-link3' breakwater run arm_push --case drac
expect 'drac-link1 drac-link2 drac-link3' arm_push --case drac
expect 'controller.k_position= controller.k_force=' breakwater run arm_push --set controller.k
expect 'push.rise_s=' arm_push --set controller.name = hpfc push.r
expect 'arm_wall_contact arm_push' breakwater sweep arm_
expect 'encoder.bits=' breakwater sweep motor_estimation --vary encoder.b
expect '--set --seeds' breakwater sweep motor_estimation --se
expect '--fps --from' breakwater video --f
exit $wrong
