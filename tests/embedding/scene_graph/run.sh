#!/usr/bin/env bash
# The third host: VulkanSceneGraph (MIT licence; it is not shipped with this project), lit by the installed package. Takes an
# installed copy of it, or fetches and builds the version that this was written for (some minutes).
# Usage: run.sh BUILD_FOLDER [VSG_PREFIX]      writes BUILD_FOLDER/scene_graph/picture.ppm
set -euo pipefail
build=$(cd "$1" && pwd)
source=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
work=$build/scene_graph
mkdir -p "$work"
vsg=${2:-$work/vsg-prefix}
if [[ ! -d $vsg/include/vsg ]]; then
    rm -rf "$work/vsg"
    git clone --depth 1 --branch v1.1.14 https://github.com/vsg-dev/VulkanSceneGraph.git "$work/vsg"
    # It asks for the budget of VK_EXT_memory_budget without looking whether the device has that (Mesa 22.3's lavapipe has
    # not), and finds no memory: the heap's size is asked instead.
    sed -i 's/memoryBudget.heapBudget\[heapIndex\]/memoryProperties.memoryHeaps[heapIndex].size/
            s/= memoryBudget.heapUsage\[heapIndex\]/= 0/' "$work/vsg/src/vsg/vk/Device.cpp"
    cmake -S "$work/vsg" -B "$work/vsg-build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_INSTALL_PREFIX="$vsg" \
        -DVSG_SUPPORTS_ShaderCompiler=OFF -DVSG_SUPPORTS_Windowing=OFF
    cmake --build "$work/vsg-build" --target install
fi
rm -rf "$work/prefix"
cmake --install "$build" --prefix "$work/prefix" >/dev/null
cmake -S "$source" -B "$work/build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_PREFIX_PATH="$work/prefix;$vsg" >/dev/null
cmake --build "$work/build"
lines=$(sed -n '/\[sunfleck: begin\]/,/\[sunfleck: end\]/p' "$source/main.cpp" | sed '1d;$d' | grep -c .)
echo "$lines lines of glue"
((lines <= 60)) || { echo "more than 60 lines of glue"; exit 1; }
grep -qs VK_LAYER_KHRONOS_validation /usr/share/vulkan/explicit_layer.d/*.json /etc/vulkan/explicit_layer.d/*.json ||
    { echo "the validation layer is not installed (vulkan-validationlayers)"; exit 1; }
VK_INSTANCE_LAYERS=VK_LAYER_KHRONOS_validation "$work/build/scene_graph" "$work/picture.ppm" 2>&1 | tee "$work/log"
! grep -qi 'validation' "$work/log" || { echo "the validation layer has something to say"; exit 1; }
