// sunfleck info: device, driver, features, limits, settings.
#include "editor/command_line/commands.h"

#include <nlohmann/json.hpp>

namespace sunfleck::command_line {
namespace {

Json device_json(gpu::Device& device, const std::vector<std::string>& devices) {
    const gpu::DeviceTraits& traits = device.traits();
    return {{"version", "0.1.0"},
            {"device", traits.name},
            {"driver", traits.driver},
            {"devices", devices},
            {"software", traits.software},
            {"features_used", gpu::required_feature_names()},
            {"features_missing", gpu::missing_features(device.instance_vk(), device.physical_device())},
            {"limits",
             {{"image_size", traits.max_image_size},
              {"image_layers", traits.max_image_layers},
              {"texel_elements", traits.max_texel_elements},
              {"storage_range", traits.max_storage_range},
              {"uniform_range", traits.max_uniform_range},
              {"subgroup_size", traits.subgroup_size},
              {"timestamp_ns", traits.timestamp_period_ns}}},
            {"memory_bytes", device.memory().total()},
            {"scenes", built_in_scene_names()}};
}

std::string describe_settings() {
    std::string text;
    const gi::Settings defaults;
    for (const gi::Settings::ConstPart& part : defaults.parts())
        text += document(*part.type, part.values);
    return text;
}

} // namespace

Status describe_device(const std::string& wanted, bool as_json) {
    SUNFLECK_ASSIGN(const std::vector<std::string> devices, gpu::list_devices());
    SUNFLECK_ASSIGN(auto device, gpu::Device::create({wanted, false, {}}));
    const Json json = device_json(*device, devices);
    if (as_json) {
        std::printf("%s\n", json.dump(2).c_str());
        return {};
    }
    std::printf("sunfleck %s\ndevice    %s\ndriver    %s\n", "0.1.0", device->traits().name.c_str(),
                device->traits().driver.c_str());
    for (std::size_t i = 0; i < devices.size(); ++i)
        std::printf("  --device %zu  %s\n", i, devices[i].c_str());
    std::printf("features  %s, missing %s\n", json["features_used"].dump().c_str(),
                json["features_missing"].dump().c_str());
    std::printf("limits    %s\nscenes    %s\n\nLighting settings for --set name=value:\n%s",
                json["limits"].dump().c_str(), json["scenes"].dump().c_str(), describe_settings().c_str());
    return {};
}

Status describe_scene(const std::string& scene, bool allow_outside, bool as_json) {
    SUNFLECK_ASSIGN(const std::filesystem::path path, find_scene(scene));
    ecs::Registry registry;
    scene::MeshStore meshes;
    scene::TextureStore textures;
    io::ImportOptions import;
    import.allow_outside = allow_outside;
    SUNFLECK_ASSIGN(const io::ImportReport report, io::load_scene(path, registry, meshes, textures, import));
    const Bounds bounds = viewer::scene_bounds(registry, meshes);
    const auto list = [](vec3 v) { return Json{v.x, v.y, v.z}; };
    const Json json = {{"file", path.string()},
                       {"counts", report.counts},
                       {"memory_bytes", report.memory_bytes},
                       {"scenes", report.scenes},
                       {"animations", report.animations},
                       {"variants", report.variants},
                       {"bounds", {{"minimum", list(bounds.minimum)}, {"maximum", list(bounds.maximum)}}},
                       {"notes", report.notes}};
    if (as_json) {
        std::printf("%s\n", json_text(json).c_str());
        return {};
    }
    std::printf("file        %s\n", path.c_str());
    for (const char* key : {"counts", "memory_bytes", "scenes", "animations", "variants", "bounds"})
        std::printf("%-11s %s\n", key, json[key].dump().c_str());
    for (const std::string& note : report.notes)
        std::printf("note        %s\n", note.c_str());
    return {};
}

} // namespace sunfleck::command_line
