// Nodes of glTF as entities: transforms, instances, cameras, lights, skins (glTF 2.0, sec. 3.5, 3.7.3, 3.10).
#pragma once

#include "engine/io/gltf_materials.h"
#include "engine/io/gltf_meshes.h"
#include "engine/scene/animation.h"

#include <map>
#include <set>

namespace sunfleck::io {

struct ImportedSkin {
    std::vector<int> joints; // nodes
    std::vector<mat4> inverse_bind_matrices;
};

// The content of a file that has been read, by index.
struct GltfContent {
    MaterialImport materials;
    std::vector<std::vector<ImportedPrimitive>> meshes;
    std::vector<ImportedSkin> skins;
    std::map<int, scene::Animation> animations;                    // by node
    std::vector<std::map<int, scene::Animation>> other_animations; // that are not played, and kept all the same
    bool for_saving = false;                                       // ImportOptions::for_saving
    int variant = -1;
};

class NodeImport {
public:
    // Checks all nodes; later steps cannot fail.
    static Result<NodeImport> read(const tinygltf::Model& model, GltfContent content);
    // Adds the trees under `roots`.
    void add_to(ecs::Registry& registry, scene::MeshStore& meshes, scene::TextureStore& textures,
                const std::vector<int>& roots);

    const GltfContent& content() const { return content_; }
    std::vector<std::string> notes;

private:
    NodeImport(const tinygltf::Model& model, GltfContent content) : model_(&model), content_(std::move(content)) {}
    Status read_node(std::size_t index);
    Status read_instances(std::size_t index);
    void reach(int index, int parent, bool visible);
    void add_node(int index);
    void add_mesh(int index, ecs::Entity entity);
    void add_primitive(int node, const ImportedPrimitive& primitive, ecs::Entity entity);
    void deform(int node, const ImportedPrimitive& primitive, ecs::Entity entity);
    void add_camera(const tinygltf::Camera& camera, ecs::Entity entity, const std::string& name);
    const tinygltf::Light* light_of(const tinygltf::Node& node) const; // null where it has none
    void note_left_out(int index);
    void add_light(const tinygltf::Light& light, ecs::Entity entity);
    void bind_skins();
    ecs::Entity joint_entity(int joint) const;
    void add_animations();
    void give_weights_back();
    template <typename T, typename Move, typename IsEmpty>
    void move_animated_weights(ecs::Entity from, ecs::Entity to, const Move& move, const IsEmpty& is_empty);
    std::string unique_name(const std::string& wanted);
    ecs::Entity child_of(ecs::Entity parent, const std::string& name, const scene::Transform& transform);

    const tinygltf::Model* model_;
    GltfContent content_;
    std::vector<scene::Transform> transforms_;
    std::map<int, std::vector<scene::Transform>> instances_; // EXT_mesh_gpu_instancing, by node
    // State while adding.
    struct Place {
        bool reached = false, visible = false; // in the scene; and nothing hides it
        int parent = -1;                       // node
        std::string name;
    };
    std::vector<Place> places_; // by node
    ecs::Registry* registry_ = nullptr;
    scene::MeshStore* meshes_ = nullptr;
    std::vector<ecs::Entity> entities_; // by node
    std::map<const ImportedPrimitive*, std::uint32_t> mesh_ids_;
    std::vector<std::pair<ecs::Entity, int>> skinned_; // entity and skin
    std::set<std::string> names_;
};

} // namespace sunfleck::io
