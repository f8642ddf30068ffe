// libFuzzer: scene files, beside a small glTF file that they may name ("a.gltf").
#include "engine/core/file.h"
#include "engine/io/scene_file.h"

#include <cstdlib>
#include <unistd.h>

namespace {

const std::filesystem::path& folder() {
    static const std::filesystem::path path = [] {
        const std::filesystem::path made =
            std::filesystem::temp_directory_path() / ("sunfleck_fuzz_" + std::to_string(getpid()));
        std::filesystem::create_directories(made);
        if (!sunfleck::write_file(made / "a.gltf",
                                  R"({"asset":{"version":"2.0"},"nodes":[{"name":"lamp"}],"scenes":[{"nodes":[0]}]})"))
            std::abort();
        return made;
    }();
    return path;
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
    using namespace sunfleck;
    const std::filesystem::path path = folder() / "a.scene.json";
    if (!write_file(path, {reinterpret_cast<const char*>(data), size}))
        return 0;
    ecs::Registry registry;
    scene::MeshStore meshes;
    scene::TextureStore textures;
    const auto report = io::load_scene(path, registry, meshes, textures);
    if (!report && registry.entity_count() != 0)
        __builtin_trap();
    return 0;
}
