#!/bin/sh
# Runs the tests of CVODE, CVODES and KINSOL under valgrind: no invalid access, nothing lost. Needs valgrind; about a minute.
#
# Options go to cargo, such as --release. Left out: what starts a child process (errors::nothing_is_printed) and what only repeats long runs.
set -eu
cd "$(dirname "$0")/.."

binary=$(cargo test --no-run --test tests --message-format=json "$@" 2>/dev/null |
    sed -n 's/.*"name":"tests".*"executable":"\([^"]*\)".*/\1/p')
[ -n "$binary" ] || { echo "valgrind.sh: the test binary was not built" >&2; exit 1; }

exec valgrind --quiet --error-exitcode=1 --leak-check=full --errors-for-leak-kinds=definite,indirect \
    --show-leak-kinds=definite,indirect \
    "$binary" sundials:: --test-threads=1 \
    --skip nothing_is_printed \
    --skip stick_slip --skip error_control --skip own_tolerances \
    --skip hires --skip our_operations_give
