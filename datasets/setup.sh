#!/usr/bin/env bash
# Installs the Debian 12 packages that Hybrid needs and that are missing. Called by demo.sh and tests/run.sh.
set -euo pipefail
packages=(
  build-essential cmake ninja-build ccache pkg-config git
  pocl-opencl-icd ocl-icd-opencl-dev
  libeigen3-dev libceres-dev libnanoflann-dev libtbb-dev libfmt-dev libspdlog-dev libxxhash-dev libzstd-dev libdeflate-dev libsqlite3-dev
  libcli11-dev libtomlplusplus-dev nlohmann-json3-dev libpugixml-dev
  libopenexr-dev libopenimageio-dev openimageio-tools libopencv-core-dev # OIIO's CMake files ask for the last two
  libembree-dev                                                          # hybrid-synth's independent ray tracer
  libgtest-dev oclgrind libtinygltf-dev libtinyobjloader-dev              # tests
)
missing=()
for package in "${packages[@]}"; do
  [ "$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null)" = installed ] || missing+=("$package")
done
[ ${#missing[@]} -eq 0 ] && exit 0
echo "Installing: ${missing[*]}" >&2
as_root=()
[ "$(id -u)" -eq 0 ] || as_root=(sudo)
"${as_root[@]}" apt-get update -q
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends "${missing[@]}"
