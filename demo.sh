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
xvfb-run -a pvpython "$root/Examples/demo.py" --output "$root/build/demo" "$@" </dev/null
