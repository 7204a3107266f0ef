#!/usr/bin/env bash
# Runs AUTO-07p on the branches and curves of orbits that `cargo bench --bench continuation` times, on one core, and prints for
# each the user CPU time, the number of steps and the special points with their errors. Then runs AUTO and twinslip in turns on the
# curves in `starts/` and on the oscillators in `oscillators/`. First argument: how often (default 3, medians are printed); second: the program twinslip (default
# target/release/twinslip); others: names of oscillators, and then nothing but these is run. Installs AUTO if it is missing. Its
# files go to target/auto-07p in the room above.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
if ! command -v auto-07p >/dev/null || ! command -v gfortran >/dev/null || ! command -v make >/dev/null; then
    apt-get install -y --no-install-recommends auto-07p gfortran make
fi
twinslip=$(realpath -m "${2:-${CARGO_TARGET_DIR:-$here/../../../target}/release/twinslip}")
work=${CARGO_TARGET_DIR:-$here/../target}/auto-07p
mkdir -p "$work"
cp "$here"/*.f90 "$here"/*.py "$here"/oscillators/* "$here"/starts/* "$work"
cd "$work"
for equations in *.f90; do
    equations=${equations%.f90}
    gfortran -O3 -march=native -c "$equations.f90"
    gfortran -fopenmp -o "$equations.exe" "$equations.o" "${AUTO_DIR:=/usr/lib/auto-07p}"/lib/*.o
done
# Debian's autox looks for AUTO beside itself unless told
export AUTO_DIR OMP_NUM_THREADS=1
one=()
command -v taskset >/dev/null && one=(taskset --cpu-list "${PEERS_CORE:-0}")
[ $# -gt 2 ] || "${one[@]}" autox curves.py "${1:-3}"
[ $# -gt 2 ] || "${one[@]}" autox starts.py "${1:-3}" "$twinslip" 2> >(grep -v '^Note: The following floating-point' >&2) | grep -v '^Parsed output data'
# what gfortran's programs say of underflow at their ends is left out
"${one[@]}" autox oscillators.py "${1:-3}" "$twinslip" "${@:3}" 2> >(grep -v '^Note: The following floating-point' >&2)
