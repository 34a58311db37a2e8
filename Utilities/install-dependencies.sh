#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Installs what Hyperpatch needs to build, run and be tested on Debian 12 (bookworm): only what is
# missing, and without a call of apt when nothing is, so that it then needs no rights.
set -euo pipefail

# dpkg-dev and file are for cpack.
build=(g++ cmake ninja-build git clang-format-14 dpkg-dev file)
libraries=(libeigen3-dev libpugixml-dev libgtest-dev libbenchmark-dev)
paraview=(paraview paraview-dev python3-paraview python3-mpi4py python3-numpy openmpi-bin)
# What find_package(ParaView) asks for and paraview-dev does not depend on.
paraview_development=(
  qtbase5-dev libqt5svg5-dev qttools5-dev qtxmlpatterns5-dev-tools libhdf5-dev
  libutfcpp-dev libxml2-dev libboost-dev libtheora-dev libogg-dev libgl2ps-dev libpng-dev
  libnetcdf-dev libx11-dev libxt-dev libglew-dev libopengl-dev libgl-dev python3-dev libexpat1-dev
  liblzma-dev liblz4-dev libdouble-conversion-dev libjpeg-dev libtiff-dev libfreetype-dev zlib1g-dev
  libopenmpi-dev libavformat-dev libavcodec-dev libavutil-dev libswscale-dev libgdal-dev)
# Rendering in software, without a display.
rendering=(xvfb xauth libgl1-mesa-dri)
packages=("${build[@]}" "${libraries[@]}" "${paraview[@]}" "${paraview_development[@]}"
  "${rendering[@]}")

if ! command -v apt-get >/dev/null || ! command -v dpkg-query >/dev/null; then
  absent=()
  for program in c++ cmake ninja git pvpython xvfb-run; do
    command -v "$program" >/dev/null || absent+=("$program")
  done
  if ((${#absent[@]} > 0)); then
    echo "error: not found: ${absent[*]}." >&2
    echo "This system has no apt-get. Install what these packages of Debian 12 hold and run this" \
      "again:" >&2
    echo "  ${packages[*]}" >&2
    exit 1
  fi
  exit 0
fi

# dpkg-query fails when it does not know one of the packages, and still lists the others.
states=" $(dpkg-query --show --showformat='${Package}=${db:Status-Status} ' "${packages[@]}" \
  2>/dev/null || true)"
missing=()
for package in "${packages[@]}"; do
  [[ $states == *" $package=installed "* ]] || missing+=("$package")
done
((${#missing[@]} > 0)) || exit 0

as_root=()
if ((EUID != 0)); then
  # sudo may ask for a password where somebody can see the question.
  if command -v sudo >/dev/null && { sudo -n true 2>/dev/null || [[ -t 2 ]]; }; then
    as_root=(sudo)
  else
    echo "error: packages are missing, and neither root nor sudo is at hand. As root, run:" >&2
    echo "  apt-get update && apt-get install --no-install-recommends ${missing[*]}" >&2
    exit 1
  fi
fi

apt() { "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q "$@" </dev/null; }
install() { apt install --yes --no-install-recommends -o Dpkg::Use-Pty=0 "$@" "${missing[@]}"; }

echo "Installing: ${missing[*]}"
# Lists are absent in a fresh container (the simulation fails) or out of date (downloads fail).
if ! install --simulate >/dev/null 2>&1; then
  apt update
  install
else
  install || { apt update && install; }
fi
