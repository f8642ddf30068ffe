#!/usr/bin/env bash
# Installs the project from its build folder into a folder of its own, builds the foreign program against it as a user
# would, and runs it. Usage: run.sh BUILD_FOLDER
set -euo pipefail
build=$(cd "$1" && pwd)
source=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
work=$build/embedding
rm -rf "$work/prefix"
cmake --install "$build" --prefix "$work/prefix" >/dev/null
cmake -S "$source" -B "$work/build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_PREFIX_PATH="$work/prefix" \
    >"$work/configure.log" 2>&1 || { cat "$work/configure.log"; exit 1; }
cmake --build "$work/build" >"$work/build.log" 2>&1 || { cat "$work/build.log"; exit 1; }

# The package has its public headers and no others, and what goes with them.
headers=$(cd "$work/prefix/include" && find . -type f | sort | tr '\n' ' ')
[[ $headers == "./sunfleck/engine/core/maths.h ./sunfleck/engine/core/octahedral.h ./sunfleck/engine/core/result.h \
./sunfleck/engine/core/shader_language.h ./sunfleck/host.h " ]] || { echo "other headers are installed: $headers"; exit 1; }
for file in README.md LICENCE.md CHANGELOG.md scene.schema.json; do
    [[ -s $work/prefix/share/doc/sunfleck/$file ]] || { echo "$file is not installed"; exit 1; }
done
# Of the static library, too, a host's linker sees what sunfleck/host.h declares and nothing else: no inline function of a
# library's header, which it would take for the host's own.
archive=$(find "$work/prefix" -name '*.a')
[[ $archive == */libsunfleck_gi.a ]] || { echo "other archives are installed: $archive"; exit 1; }
strays=$(nm -g --defined-only "$archive" 2>/dev/null | awk 'NF == 3 && $3 !~ /^_ZNK?8sunfleck4host/ {print $3}')
[[ -z $strays ]] || { echo "symbols that could clash with a host's:"; head -20 <<<"$strays"; exit 1; }
# Of the shared library, nothing can be seen but what sunfleck/host.h declares.
if library=$(find "$work/prefix" -name 'libsunfleck.so' | grep .); then
    strays=$(nm -DC --defined-only "$library" | cut -d' ' -f3- |
        grep -vE '^sunfleck::host::(Context::(~Context|[a-z_]+)\(|(missing_features|enable_features|view_projection|set_memory_limit)(\[abi:[a-z0-9]+\])?\()' || true)
    [[ -z $strays ]] || { echo "the shared library shows more than it should:"; head -20 <<<"$strays"; exit 1; }
    echo "shared library: $(nm -D --defined-only "$library" | wc -l) symbols"
    if readelf -d "$work/build/embedding_shared" | grep -E 'NEEDED.*(embree|tbb|meshopt)'; then
        echo "the host links what only the library should"
        exit 1
    fi
fi

glue=$(sed -n '/\[sunfleck: begin\]/,/\[sunfleck: end\]/p' "$source/main.cpp" | sed '1d;$d')
lines=$(grep -c . <<<"$glue")
echo "$lines lines of glue"
((lines <= 60)) || { echo "more than 60 lines of glue"; exit 1; }
readme=$(sed -n '/<!-- embedding: begin -->/,/<!-- embedding: end -->/p' "$source/../../README.md" | sed '1,2d' | head -n -2)
[[ "$readme" == "$glue" ]] || { echo "README.md does not show the glue of tests/embedding/main.cpp"; exit 1; }

# The frame-time gate drives this program, too, with ten lines of it.
served=$(sed -n '/\[gate: begin\]/,/\[gate: end\]/p' "$source/main.cpp" | sed '1d;$d')
lines=$(grep -vc '^ *}$' <<<"$served")
((lines <= 10)) || { echo "$lines lines to be driven by the gate, more than ten"; exit 1; }
described=$(sed -n '/<!-- gate: begin -->/,/<!-- gate: end -->/p' "$source/../../docs/gate.md" | sed '1,2d' | head -n -2)
[[ "$described" == "$served" ]] || { echo "docs/gate.md does not show serve_gate of tests/embedding/main.cpp"; exit 1; }

# The module needs Vulkan's loader, Embree, TBB and meshoptimizer, and nothing that draws windows or reads pictures.
if ldd "$work/build/embedding" | grep -iE 'OpenImageIO|glfw|imgui|tinygltf|draco|libX11|libpng|libjpeg'; then
    echo "the module links what an embedded library must not"
    exit 1
fi
echo "links: $(readelf -d "$work/build/embedding" | sed -n 's/.*NEEDED.*\[\(.*\)\]/\1/p' | tr '\n' ' ')"
"$work/build/embedding"
[[ ! -e $work/build/embedding_volk ]] || "$work/build/embedding_volk"
[[ ! -e $work/build/embedding_shared ]] || "$work/build/embedding_shared" --own-loader
# Two pairs tell nothing yet, but every row is there, the program's own one too, and no counter differs.
status=0
"$work/prefix/bin/sunfleck" bench compare "$work/build/embedding --gate" "$work/build/embedding --gate" --looks 2 --turns 4 \
    >"$work/gate.log" 2>&1 || status=$?
((status == 3)) && grep -q 'own geometry (CPU)' "$work/gate.log" && grep -q 'low-resolution light' "$work/gate.log" ||
    { echo "bench compare ended with $status:"; cat "$work/gate.log"; exit 1; }
# Installed programs find their libraries, the one that is loaded with the first picture, too, and their scenes.
"$work/prefix/bin/sunfleck" render cornell -o "$work/picture.png" --size 32x24 --lights 8 >/dev/null
