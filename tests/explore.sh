#!/bin/sh
# Tries the page of `twinslip explore` in chromium, which it installs if need be, driven by playwright. Words that follow are for pytest.
set -eu
cd "$(dirname "$0")/.."

./setup chromium python3-venv
[ -x target/release/twinslip ] || cargo build --release --locked -p twinslip-cli
venv=target/explore-python
[ -x $venv/bin/pytest ] || python3 -m venv $venv
# Chromium is Debian's: none is downloaded.
PLAYWRIGHT_SKIP_BROWSER_DOWNLOAD=1 $venv/bin/pip install --quiet --requirement tests/explore/requirements.txt
# The widget of notebooks is tried where the wheel of the Python package was built, as by python/test.
for wheel in target/packages/twinslip-*.whl; do
    [ ! -e "$wheel" ] || $venv/bin/pip install --quiet --force-reinstall --no-deps "$wheel"
done
exec $venv/bin/python -m pytest -q -p no:cacheprovider tests/explore "$@"
