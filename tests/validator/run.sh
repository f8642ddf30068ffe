#!/usr/bin/env bash
# Khronos's glTF validator over everything that the project exports: the scenes' geometry, and files that were read and
# saved again (textures, skins, extensions). Skipped (77) where Node.js or the validator's package can't be had.
# Usage: run.sh BUILD_FOLDER
set -euo pipefail
build=$(cd "$1" && pwd)
source=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
work=$build/validator
mkdir -p "$work"
cd "$work"
command -v node >/dev/null && command -v npm >/dev/null || { echo "skipped: needs Node.js and npm"; exit 77; }
[[ -d node_modules/gltf-validator ]] || npm install --silent --no-audit --no-fund --prefix "$work" gltf-validator@2.0.0-dev.3.10 >npm.log 2>&1 ||
    { echo "skipped: npm could not get gltf-validator"; exit 77; }
rm -rf exports && mkdir exports
SUNFLECK_EXPORTS=$work/exports "$build/bin/file_tests" --gtest_filter='GltfExport.*' >export.log || { cat export.log; exit 1; }
node "$source/validate.mjs" "$build"/scenes/*.glb exports/*.glb
