#include "renderer.h"

#include "g_buffer_frag.h"
#include "g_buffer_vert.h"

#include <cmath>
#include <cstdio>
#include <cstring>

namespace {

// Shaders that fill the G-buffer, with the uniforms of one thing.
vsg::ref_ptr<vsg::ShaderSet> shaders_with(vsg::ref_ptr<vsg::vec4Array> uniforms) {
    const auto stage = [](VkShaderStageFlagBits kind, const std::uint32_t* words, std::size_t bytes) {
        auto module = vsg::ShaderModule::create(vsg::ShaderModule::SPIRV(words, words + bytes / 4));
        module->hints = vsg::ShaderCompileSettings::create(); // nothing has to be compiled
        return vsg::ShaderStage::create(kind, "main", module);
    };
    auto set = vsg::ShaderSet::create(
        vsg::ShaderStages{stage(VK_SHADER_STAGE_VERTEX_BIT, g_buffer_vert, sizeof g_buffer_vert),
                          stage(VK_SHADER_STAGE_FRAGMENT_BIT, g_buffer_frag, sizeof g_buffer_frag)});
    set->addAttributeBinding("vsg_Vertex", "", 0, VK_FORMAT_R32G32B32_SFLOAT, vsg::vec3Array::create(1));
    set->addAttributeBinding("vsg_Normal", "", 1, VK_FORMAT_R32G32B32_SFLOAT, vsg::vec3Array::create(1));
    set->addAttributeBinding("vsg_TexCoord0", "", 2, VK_FORMAT_R32G32_SFLOAT, vsg::vec2Array::create(1));
    set->addAttributeBinding("vsg_Color", "", 3, VK_FORMAT_R32G32B32A32_SFLOAT, vsg::vec4Array::create(1));
    set->addDescriptorBinding("material", "", 0, 0, VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, 1, VK_SHADER_STAGE_FRAGMENT_BIT,
                              uniforms);
    set->addPushConstantRange("pc", "", VK_SHADER_STAGE_VERTEX_BIT, 0, 128);
    auto blend = vsg::ColorBlendState::create();
    blend->attachments.assign(3, blend->attachments.front());
    set->defaultGraphicsPipelineStates = {blend};
    return set;
}

vsg::AttachmentDescription attachment(VkFormat format) {
    vsg::AttachmentDescription description = vsg::defaultColorAttachment(format);
    description.finalLayout = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL;
    description.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
    description.loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR;
    return description;
}

// What a node draws.
struct FindMesh : vsg::Visitor {
    Thing& thing;
    explicit FindMesh(Thing& the_thing) : thing(the_thing) {}
    void apply(vsg::Node& node) override { node.traverse(*this); }
    void apply(vsg::VertexIndexDraw& draw) override {
        thing.vertices = draw.arrays[0]->data.cast<vsg::vec3Array>();
        thing.normals = draw.arrays[1]->data.cast<vsg::vec3Array>();
        thing.indices = draw.indices->data.cast<vsg::ushortArray>();
    }
};

float from_half(std::uint16_t half) {
    const int exponent = half >> 10 & 31;
    const float mantissa = float(half & 1023);
    const float size = exponent == 0 ? std::ldexp(mantissa, -24) : std::ldexp(mantissa + 1024.0f, exponent - 25);
    return (half & 0x8000) != 0 ? -size : size;
}

} // namespace

void Thing::set_surface(std::uint32_t number) const {
    std::memcpy(&uniforms->at(1).x, &number, sizeof number);
    uniforms->dirty();
}

Renderer::Renderer(Features features) {
    make_device(features);
    constexpr VkImageUsageFlags attached = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_SAMPLED_BIT;
    depth = make_target(VK_FORMAT_D32_SFLOAT, VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT | VK_IMAGE_USAGE_SAMPLED_BIT,
                        VK_IMAGE_ASPECT_DEPTH_BIT);
    normals = make_target(VK_FORMAT_R16G16B16A16_SFLOAT, attached, VK_IMAGE_ASPECT_COLOR_BIT);
    surfaces = make_target(VK_FORMAT_R32_UINT, attached, VK_IMAGE_ASPECT_COLOR_BIT);
    albedo =
        make_target(VK_FORMAT_R8G8B8A8_UNORM, attached | VK_IMAGE_USAGE_TRANSFER_SRC_BIT, VK_IMAGE_ASPECT_COLOR_BIT);
    light = make_target(VK_FORMAT_R16G16B16A16_SFLOAT, VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT,
                        VK_IMAGE_ASPECT_COLOR_BIT);
    camera = vsg::Camera::create(
        vsg::Perspective::create(55.0, double(width) / height, 0.05, 50.0),
        vsg::LookAt::create(vsg::dvec3(0.3, -3.4, 1.5), vsg::dvec3(0.0, 0.0, 1.1), vsg::dvec3(0.0, 0.0, 1.0)),
        vsg::ViewportState::create(VkExtent2D{width, height}));
    make_scene();
}

void Renderer::make_device(Features features) {
    instance = vsg::Instance::create(vsg::Names{}, vsg::Names{}, VK_API_VERSION_1_3);
    auto [chosen, family] = instance->getPhysicalDeviceAndQueueFamily(VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT);
    physical_device = chosen;
    queue_family = family;
    auto wanted = vsg::DeviceFeatures::create();
    features(&wanted->get(),
             &wanted->get<VkPhysicalDeviceVulkan12Features, VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES>(),
             &wanted->get<VkPhysicalDeviceVulkan13Features, VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES>());
    device =
        vsg::Device::create(physical_device, vsg::QueueSettings{{family, {1.0f}}}, vsg::Names{}, vsg::Names{}, wanted);
}

Target Renderer::make_target(VkFormat format, VkImageUsageFlags usage, VkImageAspectFlags aspect) const {
    Target target;
    target.image = vsg::Image::create();
    target.image->imageType = VK_IMAGE_TYPE_2D;
    target.image->format = format;
    target.image->extent = {width, height, 1};
    target.image->mipLevels = target.image->arrayLayers = 1;
    target.image->samples = VK_SAMPLE_COUNT_1_BIT;
    target.image->tiling = VK_IMAGE_TILING_OPTIMAL;
    target.image->usage = usage;
    target.view = vsg::createImageView(device, target.image, aspect);
    return target;
}

void Renderer::add(vsg::ref_ptr<vsg::Node> (vsg::Builder::*shape)(const vsg::GeometryInfo&, const vsg::StateInfo&),
                   const vsg::GeometryInfo& geometry, vsg::vec3 diffuse, bool moves) {
    Thing thing;
    thing.transform = vsg::MatrixTransform::create();
    thing.diffuse = diffuse;
    thing.moves = moves;
    thing.uniforms = vsg::vec4Array::create(5);
    thing.uniforms->properties.dataVariance = vsg::DYNAMIC_DATA;
    thing.uniforms->set(0, vsg::vec4(diffuse.x, diffuse.y, diffuse.z, 1.0f));
    const vsg::dmat4 world = camera->viewMatrix->inverse();
    for (std::size_t column = 0; column < 3; ++column)
        thing.uniforms->set(2 + column, vsg::vec4(world[column]));
    auto builder = vsg::Builder::create();
    builder->shaderSet = shaders_with(thing.uniforms);
    vsg::StateInfo state;
    auto node = (builder.get()->*shape)(geometry, state);
    FindMesh find(thing);
    node->accept(find);
    thing.transform->addChild(node);
    scene_->addChild(thing.transform);
    things.push_back(thing);
}

// A room whose sixth side is open, and a ball, a cone and a cylinder in it.
void Renderer::make_scene() {
    scene_ = vsg::StateGroup::create();
    const auto box = [&](vsg::vec3 low, vsg::vec3 high, vsg::vec3 diffuse) {
        add(&vsg::Builder::createBox, vsg::GeometryInfo(vsg::box(low, high)), diffuse, false);
    };
    box({-2.0f, -2.0f, -0.1f}, {2.0f, 2.0f, 0.0f}, {0.6f, 0.55f, 0.5f});
    box({-2.0f, -2.0f, 2.5f}, {2.0f, 2.0f, 2.6f}, {0.7f, 0.7f, 0.7f});
    box({-2.1f, -2.0f, 0.0f}, {-2.0f, 2.0f, 2.5f}, {0.7f, 0.1f, 0.08f});
    box({2.0f, -2.0f, 0.0f}, {2.1f, 2.0f, 2.5f}, {0.1f, 0.5f, 0.12f});
    box({-2.0f, 2.0f, 0.0f}, {2.0f, 2.1f, 2.5f}, {0.7f, 0.7f, 0.68f});
    vsg::GeometryInfo size;
    size.dx *= 0.9f, size.dy *= 0.9f, size.dz *= 0.9f;
    add(&vsg::Builder::createSphere, size, {0.75f, 0.7f, 0.2f}, true);
    add(&vsg::Builder::createCone, size, {0.2f, 0.35f, 0.75f}, true);
    add(&vsg::Builder::createCylinder, size, {0.8f, 0.8f, 0.8f}, true);
}

void Renderer::move_things() const {
    const double t = 0.05 * double(frame);
    int moving = 0;
    for (const Thing& thing : things)
        if (thing.moves) {
            const double angle = t + 2.1 * moving++;
            thing.transform->matrix = vsg::translate(std::cos(angle), 0.4 + std::sin(angle), 0.6) *
                                      vsg::rotate(0.7 * t, vsg::dvec3(0.3, 0.0, 1.0));
        }
}

vsg::ref_ptr<vsg::RenderGraph> Renderer::make_pass() const {
    vsg::AttachmentDescription depths = vsg::defaultDepthAttachment(VK_FORMAT_D32_SFLOAT);
    depths.finalLayout = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL;
    depths.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
    const vsg::RenderPass::Attachments attachments = {attachment(VK_FORMAT_R16G16B16A16_SFLOAT),
                                                      attachment(VK_FORMAT_R32_UINT),
                                                      attachment(VK_FORMAT_R8G8B8A8_UNORM), depths};
    vsg::SubpassDescription subpass;
    for (std::uint32_t i = 0; i < 3; ++i)
        subpass.colorAttachments.push_back({i, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, 0});
    subpass.depthStencilAttachments.push_back({3, VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL, 0});
    vsg::SubpassDependency before{};
    before.srcSubpass = VK_SUBPASS_EXTERNAL;
    before.srcStageMask = VK_PIPELINE_STAGE_ALL_COMMANDS_BIT;
    before.dstStageMask = VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT | VK_PIPELINE_STAGE_EARLY_FRAGMENT_TESTS_BIT;
    before.dstAccessMask = VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT | VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT;
    auto pass = vsg::RenderPass::create(device, attachments, vsg::RenderPass::Subpasses{subpass},
                                        vsg::RenderPass::Dependencies{before});
    auto graph = vsg::RenderGraph::create();
    graph->framebuffer = vsg::Framebuffer::create(
        pass, vsg::ImageViews{normals.view, surfaces.view, albedo.view, depth.view}, width, height, 1);
    graph->renderArea.extent = {width, height};
    graph->setClearValues({{0.0f, 0.0f, 0.0f, 0.0f}}, {0.0f, 0});
    return graph;
}

vsg::ref_ptr<vsg::Command> Renderer::copy_back(const Target& target, VkImageLayout layout,
                                               vsg::ref_ptr<vsg::Buffer>& to, VkDeviceSize bytes) const {
    to = vsg::createBufferAndMemory(device, bytes, VK_BUFFER_USAGE_TRANSFER_DST_BIT, VK_SHARING_MODE_EXCLUSIVE,
                                    VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT);
    auto copy = vsg::CopyImageToBuffer::create();
    copy->srcImage = target.image;
    copy->srcImageLayout = layout;
    copy->dstBuffer = to;
    VkBufferImageCopy region{};
    region.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
    region.imageExtent = {width, height, 1};
    copy->regions.push_back(region);
    return copy;
}

void Renderer::run(int frames, const std::function<void()>& update, vsg::ref_ptr<vsg::Command> lighting) {
    auto graph = make_pass();
    auto view = vsg::View::create(camera, scene_);
    view->viewDependentState = nullptr; // VulkanSceneGraph's own lights
    graph->addChild(view);
    auto commands = vsg::CommandGraph::create(device, queue_family);
    commands->addChild(graph);
    commands->addChild(lighting);
    // The pass leaves albedo to be sampled.
    auto barrier = vsg::ImageMemoryBarrier::create(
        VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT, VK_ACCESS_TRANSFER_READ_BIT, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL,
        VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, VK_QUEUE_FAMILY_IGNORED, VK_QUEUE_FAMILY_IGNORED, albedo.image,
        VkImageSubresourceRange{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1});
    commands->addChild(vsg::PipelineBarrier::create(VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT,
                                                    VK_PIPELINE_STAGE_TRANSFER_BIT, 0, barrier));
    constexpr VkImageLayout source = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
    commands->addChild(copy_back(albedo, source, albedo_bytes_, 4 * width * height));
    commands->addChild(copy_back(light, source, light_bytes_, 8 * width * height));
    auto viewer = vsg::Viewer::create();
    viewer->assignRecordAndSubmitTaskAndPresentation({commands});
    if (const vsg::CompileResult compiled = viewer->compile(); !compiled) {
        std::fprintf(stderr, "%s\n", compiled.message.c_str());
        return;
    }
    for (int i = 0; i < frames && viewer->advanceToNextFrame(); ++i) {
        ++frame;
        move_things();
        update();
        viewer->update();
        viewer->recordAndSubmit();
        viewer->waitForFences(0, ~std::uint64_t(0));
    }
    viewer->deviceWaitIdle();
}

double Renderer::write(const char* path) const {
    const auto bytes_of = [&](const vsg::ref_ptr<vsg::Buffer>& buffer, std::size_t size) {
        std::vector<std::uint8_t> bytes(size);
        void* mapped = nullptr;
        auto* memory = buffer->getDeviceMemory(device->deviceID);
        memory->map(buffer->getMemoryOffset(device->deviceID), size, 0, &mapped);
        std::memcpy(bytes.data(), mapped, size);
        memory->unmap();
        return bytes;
    };
    const std::vector<std::uint8_t> colours = bytes_of(albedo_bytes_, 4 * width * height),
                                    lights = bytes_of(light_bytes_, 8 * width * height);
    std::FILE* file = std::fopen(path, "wb");
    if (file == nullptr)
        return -1.0;
    std::fprintf(file, "P6\n%u %u\n255\n", width, height);
    double sum = 0.0;
    for (std::size_t pixel = 0; pixel < std::size_t(width) * height; ++pixel)
        for (std::size_t channel = 0; channel < 3; ++channel) {
            std::uint16_t half = 0;
            std::memcpy(&half, &lights[8 * pixel + 2 * channel], 2);
            const float shown = float(colours[4 * pixel + channel]) / 255.0f * from_half(half) / 3.14159265f;
            sum += double(shown);
            std::fputc(int(255.0f * std::pow(shown / (1.0f + shown), 1.0f / 2.2f) + 0.5f), file);
        }
    std::fclose(file);
    return sum / (3.0 * width * height);
}
