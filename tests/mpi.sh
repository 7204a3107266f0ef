#!/usr/bin/env bash
# Builds with the feature mpi and compares the bytes of a sweep by one process, by 1, 2 and 4 ranks, and after a rank has died.
# Not among the tests of ./test: it needs an MPI, which ./setup libopenmpi-dev openmpi-bin installs.
set -euo pipefail
cd "$(dirname "$0")/.."

for program in mpirun mpicc; do
    command -v "$program" >/dev/null || {
        echo "$program is not here: run ./setup libopenmpi-dev openmpi-bin first" >&2
        exit 1
    }
done
# A program that is built already may be given.
if [ $# -gt 0 ]; then
    program=$1
else
    cargo build --quiet --release -p twinslip-cli --features mpi
    program=${CARGO_TARGET_DIR:-target}/release/twinslip
fi
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
# Ranks may be more than cores, and of root in a container.
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
# 3: all is done, but points are undecided, as two of these grids are.
done_with() {
    local code=0
    "$@" || code=$?
    [ "$code" = 0 ] || [ "$code" = 3 ]
}
ranks() {
    local n=$1
    shift
    done_with mpirun --oversubscribe -n "$n" "$program" sweep -q "$@"
}
same() {
    cmp "$1" "$2" || {
        echo "FAILED: $3" >&2
        exit 1
    }
    echo "ok: $3"
}

for grid in "--driving 0.14:0.5:20 --stiffness 0.34:0.5:20" "--driving 0.14:0.5:20 --stiffness 0.34:0.5:20 --follow --starts 2"; do
    read -ra words <<<"$grid"
    done_with "$program" sweep -q "${words[@]}" -o "$folder/alone.csv"
    for n in 1 2 4; do
        ranks "$n" "${words[@]}" -o "$folder/ranks.csv"
        same "$folder/alone.csv" "$folder/ranks.csv" "$n ranks, $grid"
    done
done

# Many interfaces, each rank its share of them, by all methods of this build, and gone on with by another number of ranks.
many=(integrate -q --interfaces 5000 --driving 5000 --stiffness 0.0003 --start spread:1 --draw residual_strength=8e-4:1.2e-3
    --columns time,stress,slip,slip_rate,slip_rate_max,sliding,state_min,state_max,state_1,slip_rate_4999,slip_2500 --until 0.1 --force)
methods=(taylor rodas5p)
! "$program" integrate --help | grep -q cvode-bdf || methods+=(cvode-bdf)
for method in "${methods[@]}"; do
    "$program" "${many[@]}" --method "$method" -o "$folder/many.csv"
    cp "$folder/many.csv" "$folder/alone.csv"
    for n in 2 4; do
        rm "$folder/many.csv"
        mpirun --oversubscribe -n "$n" "$program" "${many[@]}" --method "$method" -o "$folder/many.csv"
        same <(grep -v '^# command' "$folder/alone.csv") <(grep -v '^# command' "$folder/many.csv") "$n ranks, many interfaces by $method"
    done
    rm "$folder/many.csv"
    saving=("${many[@]}" --method "$method" -o "$folder/many.csv" --checkpoint "$folder/saved" --checkpoint-steps 2)
    "$program" "${saving[@]}"
    cp "$folder/many.csv" "$folder/alone.csv"
    rm "$folder/many.csv"
    mpirun --oversubscribe -n 3 "$program" "${saving[@]}" &
    for ((i = 0; i < 2000; i++)); do
        [ -s "$folder/saved" ] && [ "$(stat -c %s "$folder/saved")" -gt 40000 ] && break
        kill -0 $! 2>/dev/null || break
        sleep 0.002
    done
    pkill -KILL -f "$folder/saved" || true
    wait || true
    mpirun --oversubscribe -n 2 "$program" "${saving[@]}"
    same <(grep -v '^# command' "$folder/alone.csv") <(grep -v '^# command' "$folder/many.csv") "2 ranks go on where 3 were killed, by $method"
    [ ! -e "$folder/saved" ]
done

words=(--driving 0.14:0.5:20 --stiffness 0.34:0.5:20)
done_with "$program" sweep -q "${words[@]}" -o "$folder/alone.csv"

# The object too, which takes rows and not lines.
done_with "$program" sweep -q "${words[@]}" --format json | sed 's/"command":\[[^]]*\]//' >"$folder/alone.json"
ranks 3 "${words[@]}" --format json | sed 's/"command":\[[^]]*\]//' >"$folder/ranks.json"
same "$folder/alone.json" "$folder/ranks.json" "3 ranks, JSON"

# One part of three by ranks, the others without.
for part in 1 2 3; do
    if [ "$part" = 2 ]; then
        ranks 2 "${words[@]}" --shard 2/3 -o "$folder/2.csv"
    else
        done_with "$program" sweep -q "${words[@]}" --shard "$part/3" -o "$folder/$part.csv"
    fi
done
done_with "$program" merge -q "$folder"/[123].csv -o "$folder/merged.csv"
same "$folder/alone.csv" "$folder/merged.csv" "a part by ranks, merged"

# What one rank refuses is said once, and nobody waits.
if told=$(ranks 3 --driving 1:2:0 --stiffness 1 2>&1); then
    echo "FAILED: a wrong grid was taken" >&2
    exit 1
fi
[ "$(grep -c '^error: ' <<<"$told")" = 1 ] || {
    echo "FAILED: a wrong grid gave $told" >&2
    exit 1
}
echo "ok: a wrong grid is refused once"

# A rank that computes is killed as soon as there are rows.
words=(--driving 1:10:20 --stiffness 0.3:0.5:10)
done_with "$program" sweep -q "${words[@]}" -o "$folder/alone.csv"
ranks 3 "${words[@]}" -o "$folder/killed.csv" >"$folder/told" 2>&1 &
run=$!
lines() {
    [ -f "$folder/killed.csv" ] && wc -l <"$folder/killed.csv" || echo 0
}
until [ "$(lines)" -gt 10 ] || ! kill -0 "$run" 2>/dev/null; do
    sleep 0.01
done
# The newest process with this file in its arguments is the last rank.
victim=$(pgrep -n -f "sweep -q .*$folder/killed.csv" || true)
[ -z "$victim" ] || kill -9 "$victim" 2>/dev/null || true
if wait "$run"; then
    echo "FAILED: the run ended well without a rank" >&2
    exit 1
fi
rows=$(($(lines) - 6))
echo "ok: a dead rank ends the run, $rows rows of 200 stay"
ranks 2 "${words[@]}" --resume "$folder/killed.csv"
same "$folder/alone.csv" "$folder/killed.csv" "gone on with after a rank died"
