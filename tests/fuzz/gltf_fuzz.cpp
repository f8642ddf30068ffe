// libFuzzer: glTF and GLB files from memory.
#include "engine/io/gltf.h"

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
    using namespace sunfleck;
    ecs::Registry registry;
    scene::MeshStore meshes;
    scene::TextureStore textures;
    scene::register_components(registry);
    const auto report =
        io::import_gltf_bytes(std::string(reinterpret_cast<const char*>(data), size), registry, meshes, textures);
    if (!report && (registry.entity_count() != 0 || report.error().message.empty()))
        __builtin_trap();
    return 0;
}
