#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Installs what is missing, builds, and renders the demo, of the given spline file if there is one.
# The pictures go to build/demo, or to DIR.
#
# usage: ./demo.sh [file] [--output DIR]
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)

"$root/Utilities/install-dependencies.sh"
# In a subshell: a relative file name is relative to where the caller stands.
(
  cd "$root"
  cmake --preset default
  cmake --build --preset default
)
# pvpython connects more than once, and a server that resets in between may refuse it.
xvfb-run -a -s "-screen 0 1280x1024x24 -noreset" \
  pvpython "$root/Examples/demo.py" --output "$root/build/demo" "$@" </dev/null
