// sunfleck info: device, driver, features, limits, settings.
#include "editor/command_line/common.h"

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
            {"features_missing", gpu::missing_features(device.physical_device())},
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

Status run(const std::string& wanted, bool as_json) {
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
                json["limits"].dump().c_str(), json["scenes"].dump().c_str(),
                document(gi::Settings::description(), std::make_unique<gi::Settings>().get()).c_str());
    return {};
}

} // namespace

Command make_info_command(CLI::App& program) {
    auto device = std::make_shared<std::string>();
    auto as_json = std::make_shared<bool>(false);
    CLI::App* app = program.add_subcommand("info", "Shows device, driver, limits, scenes and settings");
    app->footer("Example: sunfleck info --json");
    app->add_option("--device", *device, "Vulkan device by number or part of its name");
    app->add_flag("--json", *as_json, "Print one JSON object");
    return {app, [device, as_json] {
                const Status status = run(*device, *as_json);
                return status ? 0 : fail(status.error());
            }};
}

} // namespace sunfleck::command_line
