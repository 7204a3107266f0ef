#!/usr/bin/env bash
# Runs AUTO-07p on the branches and curves of orbits that `cargo bench --bench continuation` times, on one core, and prints for
# each the user CPU time, the number of steps and the special points with their errors. First argument: how often (default 3,
# medians are printed). Installs AUTO if it is missing. Its files go to target/auto-07p in the room above.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
if ! command -v auto-07p >/dev/null || ! command -v gfortran >/dev/null || ! command -v make >/dev/null; then
    apt-get install -y --no-install-recommends auto-07p gfortran make
fi
work=${CARGO_TARGET_DIR:-$here/../target}/auto-07p
mkdir -p "$work"
cp "$here"/*.f90 "$here/curves.py" "$work"
cd "$work"
for equations in spinodal symmetric; do
    gfortran -O3 -march=native -c $equations.f90
    gfortran -fopenmp -o $equations.exe $equations.o "${AUTO_DIR:=/usr/lib/auto-07p}"/lib/*.o
done
# Debian's autox looks for AUTO beside itself unless told
export AUTO_DIR OMP_NUM_THREADS=1
one=()
command -v taskset >/dev/null && one=(taskset --cpu-list "${PEERS_CORE:-0}")
exec "${one[@]}" autox curves.py "${1:-3}"
