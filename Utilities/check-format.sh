#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Checks that every tracked C++ file is formatted as .clang-format says; --fix formats them.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cd "$root"

if [[ $# -gt 1 || ${1:---fix} != --fix ]]; then
  echo "usage: Utilities/check-format.sh [--fix]" >&2
  exit 2
fi

# Other versions format some constructs differently.
for clang_format in clang-format-14 clang-format ""; do
  if [[ -z $clang_format ]]; then
    echo "error: clang-format 14 not found (Debian package clang-format-14)" >&2
    exit 1
  fi
  [[ $("$clang_format" --version 2>/dev/null) == *"version 14."* ]] && break
done

# A checkout that belongs to another user, as in many containers, is fine here.
mapfile -d '' files < <(git -c safe.directory="$root" ls-files -z -- '*.h' '*.cxx' '*.inl')
if ((${#files[@]} == 0)); then
  echo "error: no tracked C++ files: the style check needs a git checkout" >&2
  exit 1
fi

if [[ ${1-} == --fix ]]; then
  "$clang_format" -i "${files[@]}"
elif "$clang_format" --dry-run -Werror "${files[@]}"; then
  echo "style: ${#files[@]} files are fine"
else
  echo "error: the style check failed; Utilities/check-format.sh --fix formats the files" >&2
  exit 1
fi
