#!/bin/sh
# Opens the report in chromium, which it installs if need be, at the widths of phones and desktops. A report may be named.
set -eu
report=${1:+$(realpath "$1")}
cd "$(dirname "$0")/.."

./setup chromium
[ -z "$report" ] || export TWINSLIP_REPORT="$report"
exec cargo test --release --quiet --test tests -- browser:: --ignored
