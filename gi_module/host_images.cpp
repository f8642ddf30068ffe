// The host's images: which formats they may have, and how they enter a frame graph.
#include "gi_module/host_context.h"

#include <algorithm>
#include <array>

namespace sunfleck::host {
namespace {

// The first one is the usual one.
constexpr std::array depth_formats = {VK_FORMAT_D32_SFLOAT,          VK_FORMAT_D16_UNORM,
                                      VK_FORMAT_X8_D24_UNORM_PACK32, VK_FORMAT_D24_UNORM_S8_UINT,
                                      VK_FORMAT_D32_SFLOAT_S8_UINT,  VK_FORMAT_R32_SFLOAT};
constexpr std::array packed_normal_formats = {VK_FORMAT_R32G32_UINT};
constexpr std::array signed_normal_formats = {VK_FORMAT_R16G16B16A16_SFLOAT, VK_FORMAT_R32G32B32A32_SFLOAT,
                                              VK_FORMAT_R16G16B16A16_SNORM, VK_FORMAT_R8G8B8A8_SNORM};
constexpr std::array unsigned_normal_formats = {VK_FORMAT_A2B10G10R10_UNORM_PACK32, VK_FORMAT_A2R10G10B10_UNORM_PACK32,
                                                VK_FORMAT_R8G8B8A8_UNORM, VK_FORMAT_R16G16B16A16_UNORM};
constexpr std::array surface_formats = {VK_FORMAT_R32_UINT, VK_FORMAT_R16_UINT};
constexpr std::array light_formats = {VK_FORMAT_R16G16B16A16_SFLOAT, VK_FORMAT_R32G32B32A32_SFLOAT};
constexpr std::array motion_formats = {VK_FORMAT_R16G16_SFLOAT, VK_FORMAT_R32G32_SFLOAT};
constexpr std::array material_formats = {VK_FORMAT_R8G8_UNORM, VK_FORMAT_R8G8B8A8_UNORM, VK_FORMAT_R16G16_SFLOAT};

using Formats = std::span<const VkFormat>;

bool is_one_of(VkFormat format, Formats formats) {
    return std::find(formats.begin(), formats.end(), format) != formats.end();
}

VkFormat format_of(const HostImage& image, VkFormat usual) {
    return image.format == VK_FORMAT_UNDEFINED ? usual : image.format;
}

bool is_there(const HostImage& image) {
    return image.image != VK_NULL_HANDLE || image.view != VK_NULL_HANDLE;
}

Status check_image(const char* name, const HostImage& image, std::initializer_list<Formats> allowed) {
    const std::string what = std::string("FrameImages: the image of ") + name;
    if (image.image == VK_NULL_HANDLE || image.view == VK_NULL_HANDLE)
        return wrong(what + " has no " + (image.image == VK_NULL_HANDLE ? "image handle" : "view"));
    const VkFormat format = format_of(image, *allowed.begin()->begin());
    if (std::none_of(allowed.begin(), allowed.end(), [&](Formats formats) { return is_one_of(format, formats); }))
        return wrong(what + " has the format " + std::to_string(format) +
                     " (VkFormat), which sunfleck/host.h does not list");
    SUNFLECK_TRY(check_image_state(what + " at entry", image.entry, format));
    SUNFLECK_TRY(check_image_state(what + " at exit", image.exit, format));
    if (image.exit.layout == VK_IMAGE_LAYOUT_UNDEFINED || image.exit.layout == VK_IMAGE_LAYOUT_PREINITIALIZED)
        return wrong(what + " needs a layout at exit");
    return {};
}

// An input of undefined layout has no content.
Status check_input(const char* name, const HostImage& image, std::initializer_list<Formats> allowed) {
    SUNFLECK_TRY(check_image(name, image, allowed));
    if (image.entry.layout == VK_IMAGE_LAYOUT_UNDEFINED)
        return wrong(std::string("FrameImages: the image of ") + name + " has an undefined layout at entry");
    return {};
}

gpu::ResourceId import(gpu::FrameGraph& graph, const char* name, const HostImage& image, VkFormat usual,
                       const FrameImages& images) {
    gpu::ImportedImage result;
    result.name = name;
    result.image = image.image;
    result.view = image.view;
    result.description.name = name;
    result.description.format = format_of(image, usual);
    result.description.width = images.width;
    result.description.height = images.height;
    result.entry.layout = image.entry.layout;
    result.entry.write_stages = image.entry.stages;
    result.entry.write_access = image.entry.access;
    result.has_exit = true;
    result.exit = gpu::Usage::host;
    result.exit_stages = image.exit.stages;
    result.exit_access = image.exit.access;
    result.exit_layout = image.exit.layout;
    return graph.import_host_image(result);
}

// Smallest difference of depths. Floating point is as fine as need be near 0; forward Z has distant depths near 1.
float depth_step(VkFormat format, bool forward) {
    switch (format) {
    case VK_FORMAT_D16_UNORM:
        return 1.0f / 65535.0f;
    case VK_FORMAT_X8_D24_UNORM_PACK32:
    case VK_FORMAT_D24_UNORM_S8_UINT:
        return 1.0f / 16777215.0f;
    default:
        return forward ? 1.0f / 16777216.0f : 0.0f;
    }
}

gi::NormalEncoding encoding_of(VkFormat format) {
    if (is_one_of(format, packed_normal_formats))
        return gi::NormalEncoding::packed;
    return is_one_of(format, unsigned_normal_formats) ? gi::NormalEncoding::unsigned_values
                                                      : gi::NormalEncoding::signed_values;
}

// Each would be brought from its state at entry to that at exit by itself.
Status check_different(const FrameImages& images) {
    const std::pair<const char*, const HostImage*> list[] = {{"depth", &images.depth},
                                                             {"normals", &images.normals},
                                                             {"surface ids", &images.surface},
                                                             {"irradiance", &images.irradiance},
                                                             {"geometric normals", &images.geometric_normals},
                                                             {"motion", &images.motion},
                                                             {"metallic and roughness", &images.metallic_roughness},
                                                             {"specular light", &images.specular}};
    for (auto one = std::begin(list); one != std::end(list); ++one)
        for (auto other = one + 1; is_there(*one->second) && other != std::end(list); ++other)
            if (one->second->image == other->second->image)
                return wrong(std::string("FrameImages: ") + one->first + " and " + other->first +
                             " are the same image");
    return {};
}

} // namespace

Status check_images(const FrameImages& images, std::uint32_t largest) {
    if (images.width == 0 || images.height == 0 || images.width > largest || images.height > largest)
        return wrong("FrameImages: width and height are " + std::to_string(images.width) + " and " +
                     std::to_string(images.height) + "; on this device they must lie between 1 and " +
                     std::to_string(largest));
    SUNFLECK_TRY(check_input("depth", images.depth, {depth_formats}));
    SUNFLECK_TRY(check_input("normals", images.normals,
                             {packed_normal_formats, signed_normal_formats, unsigned_normal_formats}));
    SUNFLECK_TRY(check_input("surface ids", images.surface, {surface_formats}));
    SUNFLECK_TRY(check_image("irradiance", images.irradiance, {light_formats}));
    if (is_there(images.geometric_normals))
        SUNFLECK_TRY(check_input("geometric normals", images.geometric_normals,
                                 {signed_normal_formats, unsigned_normal_formats}));
    if (is_there(images.motion))
        SUNFLECK_TRY(check_input("motion", images.motion, {motion_formats}));
    if (is_there(images.metallic_roughness))
        SUNFLECK_TRY(check_input("metallic and roughness", images.metallic_roughness, {material_formats}));
    if (is_there(images.specular))
        SUNFLECK_TRY(check_image("specular light", images.specular, {light_formats}));
    return check_different(images);
}

gi::HostGBuffer import_g_buffer(gpu::FrameGraph& graph, const FrameImages& images, const scene::DepthMapping& mapping) {
    gi::HostGBuffer result;
    result.width = images.width;
    result.height = images.height;
    result.depth = import(graph, "host depth", images.depth, depth_formats[0], images);
    result.normals = import(graph, "host normals", images.normals, packed_normal_formats[0], images);
    result.surface = import(graph, "host surface ids", images.surface, surface_formats[0], images);
    result.normal_encoding = encoding_of(format_of(images.normals, packed_normal_formats[0]));
    result.mapping = mapping;
    result.depth_step = depth_step(format_of(images.depth, depth_formats[0]), mapping.background == 1.0f);
    if (is_there(images.geometric_normals)) {
        result.geometric_normals =
            import(graph, "host geometric normals", images.geometric_normals, signed_normal_formats[0], images);
        result.geometric_encoding = encoding_of(format_of(images.geometric_normals, signed_normal_formats[0]));
    }
    return result;
}

gpu::ResourceId import_output(gpu::FrameGraph& graph, const char* name, const HostImage& image,
                              const FrameImages& images) {
    return import(graph, name, image, light_formats[0], images);
}

gpu::ResourceId import_optional(gpu::FrameGraph& graph, const char* name, const HostImage& image, VkFormat usual,
                                const FrameImages& images) {
    return is_there(image) ? import(graph, name, image, usual, images) : gpu::ResourceId();
}

} // namespace sunfleck::host
