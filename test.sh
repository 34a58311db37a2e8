#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Installs what is missing, checks the style, builds and runs all tests.
#
# usage: ./test.sh [--all-presets]
#   --all-presets  also the builds without ParaView's plugin, without VTK, and with sanitizers
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
exec </dev/null

presets=(default)
case "$*" in
  "") ;;
  --all-presets) presets+=(splines-only vtk-only asan tsan) ;;
  *)
    echo "usage: ./test.sh [--all-presets]" >&2
    exit 2
    ;;
esac

Utilities/install-dependencies.sh
Utilities/check-format.sh
for preset in "${presets[@]}"; do
  echo "== $preset"
  cmake --preset "$preset"
  cmake --build --preset "$preset"
  ctest --preset "$preset" --parallel 2 --no-tests=error
done
