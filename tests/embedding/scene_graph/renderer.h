// What a program that draws with VulkanSceneGraph has anyway: an instance, a device, a scene of meshes with materials,
// some of which move, a camera, and the images of a deferred frame.
#pragma once

#include <vsg/all.h>

struct Thing {
    vsg::ref_ptr<vsg::MatrixTransform> transform;
    vsg::ref_ptr<vsg::vec3Array> vertices, normals;
    vsg::ref_ptr<vsg::ushortArray> indices;
    vsg::vec3 diffuse;
    bool moves = false;
    vsg::ref_ptr<vsg::vec4Array> uniforms; // diffuse, surface, rotation from the camera's space to the world's

    // What the G-buffer holds where it shows.
    void set_surface(std::uint32_t number) const;
};

struct Target {
    vsg::ref_ptr<vsg::Image> image;
    vsg::ref_ptr<vsg::ImageView> view;
};

struct Renderer {
    static constexpr std::uint32_t width = 320, height = 180;
    // `features`: sets what else the device shall have.
    using Features = void (*)(VkPhysicalDeviceFeatures*, VkPhysicalDeviceVulkan12Features*,
                              VkPhysicalDeviceVulkan13Features*);
    explicit Renderer(Features features);

    vsg::ref_ptr<vsg::Instance> instance;
    vsg::ref_ptr<vsg::PhysicalDevice> physical_device;
    vsg::ref_ptr<vsg::Device> device;
    int queue_family = 0;
    std::vector<Thing> things; // walls first
    vsg::ref_ptr<vsg::Camera> camera;
    Target depth, normals, surfaces, albedo, light;
    std::uint64_t frame = 0; // from 1

    // `update` before a frame is recorded, `lighting` between the G-buffer and the copies of what it made.
    void run(int frames, const std::function<void()>& update, vsg::ref_ptr<vsg::Command> lighting);
    // The last frame: albedo times light, tone-mapped, as a PPM. The mean of what is shown, linear.
    double write(const char* path) const;

private:
    void make_device(Features features);
    Target make_target(VkFormat format, VkImageUsageFlags usage, VkImageAspectFlags aspect) const;
    void make_scene();
    void add(vsg::ref_ptr<vsg::Node> (vsg::Builder::*shape)(const vsg::GeometryInfo&, const vsg::StateInfo&),
             const vsg::GeometryInfo& geometry, vsg::vec3 diffuse, bool moves);
    vsg::ref_ptr<vsg::RenderGraph> make_pass() const;
    vsg::ref_ptr<vsg::Command> copy_back(const Target& target, VkImageLayout layout, vsg::ref_ptr<vsg::Buffer>& to,
                                         VkDeviceSize bytes) const;
    void move_things() const;

    vsg::ref_ptr<vsg::StateGroup> scene_;
    vsg::ref_ptr<vsg::Buffer> albedo_bytes_, light_bytes_;
};
