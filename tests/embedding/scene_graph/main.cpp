// Scenes of VulkanSceneGraph (a renderer that knows nothing of this project) lit by the installed package. Between the
// markers is all that it takes.
#include "renderer.h"

// [sunfleck: begin]
#include <sunfleck/host.h>

namespace host = sunfleck::host;

host::Matrix4 matrix_of(const vsg::dmat4& matrix) {
    host::Matrix4 result;
    std::copy_n(matrix.data(), 16, result.begin());
    return result;
}

std::span<const float> floats(const vsg::vec3Array& array) {
    return {static_cast<const float*>(array.dataPointer()), 3 * array.size()};
}

struct Lighting : vsg::Inherit<vsg::Command, Lighting> {
    explicit Lighting(Renderer& the_renderer) : renderer(the_renderer) {}
    Renderer& renderer;
    std::unique_ptr<host::Context> context;

    sunfleck::Status begin() {
        SUNFLECK_ASSIGN(context, host::Context::create({*renderer.instance, *renderer.physical_device, *renderer.device,
                                                        *renderer.device->getQueue(renderer.queue_family),
                                                        std::uint32_t(renderer.queue_family)}));
        for (const Thing& thing : renderer.things) {
            const std::vector<std::uint32_t> indices(thing.indices->begin(), thing.indices->end());
            SUNFLECK_ASSIGN(const std::uint32_t number,
                            context->add_mesh({floats(*thing.vertices), floats(*thing.normals), indices, {}}));
            SUNFLECK_TRY(context->add_instance({number,
                                                matrix_of(thing.transform->matrix),
                                                thing.moves ? host::Mobility::moving : host::Mobility::fixed,
                                                {thing.diffuse.x, thing.diffuse.y, thing.diffuse.z}}));
        }
        const auto lamp = context->add_light({host::LightKind::point, {9.0f, 8.0f, 6.5f}, {0.4f, 0.0f, 2.2f}});
        return lamp ? sunfleck::Status() : lamp.error();
    }
    sunfleck::Status update() {
        for (std::uint32_t i = 0; i < renderer.things.size(); ++i)
            if (renderer.things[i].moves)
                SUNFLECK_TRY(context->set_transform(i, matrix_of(renderer.things[i].transform->matrix)));
        SUNFLECK_TRY(context->update({renderer.frame, renderer.frame - 1}));
        for (std::uint32_t i = 0; i < renderer.things.size(); ++i)
            renderer.things[i].set_surface(context->surface_id(i));
        return {};
    }
    void record(vsg::CommandBuffer& commands) const override {
        const host::ImageState written{VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                                       VK_ACCESS_2_MEMORY_WRITE_BIT};
        const host::ImageState copied{VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, VK_PIPELINE_STAGE_2_COPY_BIT,
                                      VK_ACCESS_2_TRANSFER_READ_BIT};
        const auto image = [&](const Target& target, const host::ImageState& entry, const host::ImageState& exit) {
            const std::uint32_t device = renderer.device->deviceID;
            return host::HostImage{target.image->vk(device), target.view->vk(device), entry, exit,
                                   target.image->format};
        };
        host::FrameImages images{Renderer::width, Renderer::height};
        images.depth = image(renderer.depth, written, written);
        images.normals = image(renderer.normals, written, written);
        images.surface = image(renderer.surfaces, written, written);
        images.irradiance = image(renderer.light, {}, copied);
        const host::View view{matrix_of(renderer.camera->viewMatrix->transform()),
                              matrix_of(renderer.camera->projectionMatrix->transform())};
        failed = context->record(commands, view, images);
    }
    mutable sunfleck::Status failed;
};
// [sunfleck: end]

#include <cstdio>

int main(int argc, char** argv) {
    Renderer renderer(host::enable_features);
    auto lighting = Lighting::create(renderer);
    sunfleck::Status status = lighting->begin();
    if (status)
        renderer.run(
            60,
            [&] {
                if (status)
                    status = lighting->failed ? lighting->update() : lighting->failed;
            },
            lighting);
    if (!status) {
        std::fprintf(stderr, "%s\n", status.error().message.c_str());
        return 1;
    }
    lighting->context.reset();
    const double mean = renderer.write(argc > 1 ? argv[1] : "scene_graph.ppm");
    std::printf("mean radiance %.4f W/(sr m2)\n", mean);
    return mean > 0.05 && mean < 5.0 ? 0 : 1;
}
