#include "engine/io/gltf_nodes.h"

#include "engine/io/gltf.h"
#include "engine/io/gltf_writer.h"

#include <algorithm>
#include <cmath>

namespace sunfleck::io {
namespace {

bool is_finite_transform(const scene::Transform& t) {
    return is_finite(t.position) && is_finite(t.scale) && std::isfinite(t.rotation.w) &&
           is_finite(vec3(t.rotation.x, t.rotation.y, t.rotation.z));
}

vec3 vector_of(const std::vector<double>& values, vec3 fallback) {
    return values.size() == 3 ? vec3(float(values[0]), float(values[1]), float(values[2])) : fallback;
}

// Decomposes a matrix into translation, rotation and scale; `exact` is false if it also shears.
scene::Transform decompose(const std::vector<double>& values, bool& exact) {
    mat4 m;
    for (int i = 0; i < 16; ++i)
        m[i / 4][i % 4] = float(values[std::size_t(i)]);
    scene::Transform transform;
    transform.position = vec3(m[3]);
    transform.scale = vec3(glm::length(vec3(m[0])), glm::length(vec3(m[1])), glm::length(vec3(m[2])));
    if (glm::determinant(mat3(m)) < 0.0f)
        transform.scale.x = -transform.scale.x;
    mat3 r(1.0f);
    for (int i = 0; i < 3; ++i)
        if (transform.scale[i] != 0.0f)
            r[i] = vec3(m[i]) / transform.scale[i];
    // Zero columns are replaced by a direction orthogonal to the others.
    for (int i = 0; i < 3; ++i)
        if (transform.scale[i] == 0.0f)
            r[i] = glm::cross(r[(i + 1) % 3], r[(i + 2) % 3]);
    transform.rotation = glm::quat_cast(r);
    const float length = glm::length(transform.rotation);
    transform.rotation = length > 1e-6f ? transform.rotation / length : quat(1.0f, 0.0f, 0.0f, 0.0f);
    const mat4 again = transform.matrix();
    const float size = std::max({std::abs(transform.scale.x), transform.scale.y, transform.scale.z, 1e-6f});
    exact = true;
    for (int i = 0; i < 3; ++i)
        exact = exact && glm::length(vec3(again[i]) - vec3(m[i])) < 1e-3f * size;
    return transform;
}

std::string own_name(const tinygltf::Node& node, int index) {
    return node.name.empty() ? "node " + std::to_string(index) : node.name;
}

bool is_visible(const tinygltf::Node& node) {
    const auto found = node.extensions.find("KHR_node_visibility");
    return found == node.extensions.end() || !found->second.Has("visible") || !found->second.Get("visible").IsBool() ||
           found->second.Get("visible").Get<bool>();
}

} // namespace

Result<NodeImport> NodeImport::read(const tinygltf::Model& model, GltfContent content) {
    NodeImport result(model, std::move(content));
    result.transforms_.resize(model.nodes.size());
    for (std::size_t i = 0; i < model.nodes.size(); ++i)
        SUNFLECK_TRY(result.read_node(i));
    return result;
}

Status NodeImport::read_node(std::size_t index) {
    const tinygltf::Node& node = model_->nodes[index];
    const std::string place = "node " + std::to_string(index) + " ('" + node.name + "')";
    scene::Transform& transform = transforms_[index];
    if (node.matrix.size() == 16) {
        bool exact = true;
        transform = decompose(node.matrix, exact);
        if (!exact)
            notes.push_back(place + ": its matrix contains shear, which is removed");
    } else {
        transform.position = vector_of(node.translation, vec3(0.0f));
        transform.scale = vector_of(node.scale, vec3(1.0f));
        if (node.rotation.size() == 4) {
            transform.rotation = quat(float(node.rotation[3]), float(node.rotation[0]), float(node.rotation[1]),
                                      float(node.rotation[2]));
            const float length = glm::length(transform.rotation);
            if (!(length > 1e-6f))
                return Error{place + " has a zero rotation quaternion"};
            if (std::abs(length - 1.0f) > 1e-5f)
                transform.rotation /= length;
        }
    }
    if (!is_finite_transform(transform))
        return Error{place + " has a transform that is not finite"};
    if (node.extensions.count("EXT_mesh_gpu_instancing"))
        if (const Status status = read_instances(index); !status)
            return Error{place + ": " + status.error().message};
    return {};
}

Status NodeImport::read_instances(std::size_t index) {
    const tinygltf::Value& extension = model_->nodes[index].extensions.at("EXT_mesh_gpu_instancing");
    if (!extension.Has("attributes") || !extension.Get("attributes").IsObject())
        return Error{"its EXT_mesh_gpu_instancing has no attributes"};
    const tinygltf::Value& attributes = extension.Get("attributes");
    std::vector<scene::Transform>& list = instances_[int(index)];
    const auto read = [&](const char* name, int type, const auto& set) -> Status {
        if (!attributes.Has(name))
            return {};
        const int accessor = attributes.Get(name).IsNumber() ? attributes.Get(name).GetNumberAsInt() : -1;
        std::vector<int> components = {TINYGLTF_COMPONENT_TYPE_FLOAT};
        if (type == TINYGLTF_TYPE_VEC4)
            components = {TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_COMPONENT_TYPE_BYTE, TINYGLTF_COMPONENT_TYPE_SHORT};
        SUNFLECK_ASSIGN(const FloatElements elements, read_floats(*model_, accessor, {{type}, components}));
        constexpr std::size_t max_instances = 100000;
        if (elements.count() > max_instances)
            return Error{"more than " + std::to_string(max_instances) + " instances"};
        if (!list.empty() && list.size() != elements.count())
            return Error{"its instance attributes differ in length"};
        list.resize(elements.count());
        for (std::size_t i = 0; i < list.size(); ++i)
            set(list[i], elements[i]);
        return {};
    };
    SUNFLECK_TRY(read("TRANSLATION", TINYGLTF_TYPE_VEC3,
                      [](scene::Transform& t, const float* v) { t.position = vec3(v[0], v[1], v[2]); }));
    SUNFLECK_TRY(read("ROTATION", TINYGLTF_TYPE_VEC4, [](scene::Transform& t, const float* v) {
        const quat rotation(v[3], v[0], v[1], v[2]);
        const float length = glm::length(rotation);
        t.rotation = length > 1e-6f ? rotation / length : quat(1.0f, 0.0f, 0.0f, 0.0f);
    }));
    return read("SCALE", TINYGLTF_TYPE_VEC3,
                [](scene::Transform& t, const float* v) { t.scale = vec3(v[0], v[1], v[2]); });
}

std::string NodeImport::unique_name(const std::string& wanted) {
    std::string name = wanted;
    for (int number = 2; !names_.insert(name).second; ++number)
        name = wanted + " #" + std::to_string(number);
    return name;
}

const tinygltf::Light* NodeImport::light_of(const tinygltf::Node& node) const {
    const auto found = node.extensions.find("KHR_lights_punctual");
    if (found == node.extensions.end() || !found->second.Has("light") || !found->second.Get("light").IsNumber())
        return nullptr;
    const int which = found->second.Get("light").GetNumberAsInt();
    return in_range(which, model_->lights) ? &model_->lights[std::size_t(which)] : nullptr;
}

// What a node of a broken file asks for and cannot have.
void NodeImport::note_left_out(int index) {
    const tinygltf::Node& node = model_->nodes[std::size_t(index)];
    const auto left_out = [&](bool is, const std::string& what) {
        if (is)
            notes.push_back("node " + std::to_string(index) + " ('" + node.name + "'): " + what);
    };
    std::size_t targets = 0;
    bool has_joints = false;
    if (in_range(node.mesh, content_.meshes))
        for (const ImportedPrimitive& primitive : content_.meshes[std::size_t(node.mesh)]) {
            targets = std::max(targets, primitive.mesh.targets.size());
            has_joints = has_joints || primitive.mesh.influences > 0;
        }
    left_out(node.extensions.count("KHR_lights_punctual") > 0 && light_of(node) == nullptr,
             "its light is none of the file's " + std::to_string(model_->lights.size()) + ", and is left out");
    left_out(node.skin >= 0 && !has_joints, "it has a skin, but no mesh with joints: the skin is left out");
    left_out(node.weights.size() > targets, "of its " + std::to_string(node.weights.size()) +
                                                " weights, those beyond its mesh's " + std::to_string(targets) +
                                                " morph targets are left out");
    const auto animation = content_.animations.find(index);
    if (animation == content_.animations.end())
        return;
    left_out(animation->second.weights.width > 0 && targets == 0,
             "weights are animated, but it has no morph targets: they are left out");
    std::set<scene::AnimationTarget> moved;
    for (const scene::AnimationCurve& curve : animation->second.curves)
        left_out(!moved.insert(curve.target).second,
                 "several channels animate one property of it: all but the last are left out");
}

ecs::Entity NodeImport::child_of(ecs::Entity parent, const std::string& name, const scene::Transform& transform) {
    const ecs::Entity entity = registry_->create();
    registry_->emplace<scene::Name>(entity, {unique_name(name)});
    registry_->emplace<scene::Transform>(entity, transform);
    if (!parent.is_null())
        registry_->emplace<scene::Parent>(entity, {parent});
    return entity;
}

void NodeImport::add_to(ecs::Registry& registry, scene::MeshStore& meshes, scene::TextureStore& textures,
                        const std::vector<int>& roots) {
    registry_ = &registry;
    meshes_ = &meshes;
    content_.materials.add_textures(textures);
    places_.assign(model_->nodes.size(), {});
    entities_.assign(model_->nodes.size(), ecs::null_entity);
    registry.view<scene::Name>().each([&](ecs::Entity, const scene::Name& name) { names_.insert(name.name); });
    for (const int root : roots)
        if (!places_[std::size_t(root)].reached) // a scene may name a node twice
            reach(root, -1, true);
    // In the file's order, whatever the tree: what is drawn may depend on the order of entities, and a scene that was
    // saved comes back in that of its registry.
    for (std::size_t i = 0; i < places_.size(); ++i)
        if (places_[i].reached)
            add_node(int(i));
    for (std::size_t i = 0; i < places_.size(); ++i)
        if (const int parent = places_[i].parent; parent >= 0)
            registry.emplace<scene::Parent>(entities_[i], {entities_[std::size_t(parent)]});
    bind_skins();
    add_animations();
    give_weights_back();
}

// Names nodes by the tree: of equal names, the node that is reached first has it.
void NodeImport::reach(int index, int parent, bool visible) {
    const tinygltf::Node& node = model_->nodes[std::size_t(index)];
    Place& place = places_[std::size_t(index)];
    if (is_marked(node.extras, mark_no_entity))
        return;
    if (place.name.empty()) // a scene may also name what lies below another of its nodes
        place.name = unique_name(own_name(node, index));
    place.reached = true;
    place.visible = visible && is_visible(node);
    place.parent = parent;
    for (const int child : node.children)
        reach(child, index, place.visible);
}

void NodeImport::add_node(int index) {
    const tinygltf::Node& node = model_->nodes[std::size_t(index)];
    const Place& place = places_[std::size_t(index)];
    const ecs::Entity entity = registry_->create();
    registry_->emplace<scene::Name>(entity, {place.name});
    registry_->emplace<scene::Transform>(entity, transforms_[std::size_t(index)]);
    entities_[std::size_t(index)] = entity;
    const std::string name = own_name(node, index);
    if (place.visible && in_range(node.mesh, content_.meshes)) {
        const auto instances = instances_.find(index);
        if (instances == instances_.end())
            add_mesh(index, entity);
        else
            for (std::size_t i = 0; i < instances->second.size(); ++i)
                add_mesh(index, child_of(entity, name + " instance " + std::to_string(i), instances->second[i]));
    }
    if (in_range(node.camera, model_->cameras))
        add_camera(model_->cameras[std::size_t(node.camera)], entity, name);
    if (const tinygltf::Light* light = light_of(node); place.visible && light != nullptr)
        add_light(*light, entity);
    note_left_out(index);
}

void NodeImport::add_mesh(int index, ecs::Entity entity) {
    const tinygltf::Node& node = model_->nodes[std::size_t(index)];
    const std::vector<ImportedPrimitive>& primitives = content_.meshes[std::size_t(node.mesh)];
    if (node.weights.size() + model_->meshes[std::size_t(node.mesh)].weights.size() > 0 ||
        content_.animations.count(index)) {
        const std::vector<double>& weights =
            node.weights.empty() ? model_->meshes[std::size_t(node.mesh)].weights : node.weights;
        scene::MorphWeights stored;
        stored.weights.assign(weights.begin(), weights.end());
        for (float& weight : stored.weights)
            weight = std::isfinite(weight) ? weight : 0.0f;
        registry_->emplace<scene::MorphWeights>(entity, std::move(stored));
    }
    bool taken = false;
    for (std::size_t p = 0; p < primitives.size(); ++p) {
        if (!primitives[p].drawn || primitives[p].mesh.rest.indices.empty())
            continue;
        const bool skinned = node.skin >= 0 && primitives[p].mesh.influences > 0;
        ecs::Entity owner = entity;
        // Further primitives become children, because an entity has one material. Skinned ones are in world space.
        if (taken || (skinned && !is_marked(node.extras, mark_own_mesh)))
            owner = child_of(skinned ? ecs::null_entity : entity,
                             registry_->get<scene::Name>(entity).name + " part " + std::to_string(p + 1), {});
        else
            taken = true;
        add_primitive(index, primitives[p], owner);
        if (registry_->has<scene::Deformation>(owner)) {
            registry_->patch<scene::Deformation>(owner, [&](scene::Deformation& d) { d.weights_of = entity; });
            if (skinned)
                skinned_.emplace_back(owner, node.skin);
        }
    }
}

void NodeImport::add_primitive(int node, const ImportedPrimitive& primitive, ecs::Entity entity) {
    int number = primitive.material;
    if (content_.variant >= 0 && primitive.material_of_variant[std::size_t(content_.variant)] >= 0)
        number = primitive.material_of_variant[std::size_t(content_.variant)];
    const ImportedMaterial& material = content_.materials.material(number);
    registry_->emplace<scene::Material>(entity, material.material);
    if (material.has_textures && !primitive.mesh.rest.texture_coordinates.empty())
        registry_->emplace<scene::MaterialTextures>(entity, material.textures);
    if (primitive.deforms()) {
        deform(node, primitive, entity);
        return;
    }
    const auto [place, fresh] = mesh_ids_.try_emplace(&primitive, 0);
    if (fresh)
        place->second = meshes_->add(primitive.mesh.rest);
    registry_->emplace<scene::MeshInstance>(entity, {place->second});
}

// A mesh of its own. A mesh whose pose never changes at run time is deformed once and is then static geometry.
void NodeImport::deform(int node, const ImportedPrimitive& primitive, ecs::Entity entity) {
    const tinygltf::Node& source = model_->nodes[std::size_t(node)];
    const bool skinned = source.skin >= 0 && primitive.mesh.influences > 0;
    const auto animation = content_.animations.find(node);
    const bool animated = animation != content_.animations.end() && !animation->second.weights.times.empty();
    scene::DeformableMesh mesh = primitive.mesh;
    if (!skinned)
        mesh.influences = 0;
    if (!skinned && !animated) {
        const std::vector<double>& given =
            source.weights.empty() ? model_->meshes[std::size_t(source.mesh)].weights : source.weights;
        const std::vector<float> weights(given.begin(), given.end());
        if (content_.for_saving && !mesh.targets.empty())
            notes.push_back("node " + std::to_string(node) + " ('" + source.name +
                            "'): no animation that is played moves its morph targets: their shape is kept, not they");
        registry_->emplace<scene::MeshInstance>(entity, {meshes_->add(scene::deformed(mesh, {}, weights))});
        return;
    }
    registry_->emplace<scene::MeshInstance>(entity, {meshes_->add(mesh.rest)});
    scene::Deformation deformation;
    deformation.source = std::make_shared<scene::DeformableMesh>(std::move(mesh));
    registry_->emplace<scene::Deformation>(entity, std::move(deformation));
    registry_->emplace_or_replace<scene::Mover>(entity, {});
}

void NodeImport::add_camera(const tinygltf::Camera& camera, ecs::Entity entity, const std::string& name) {
    if (camera.type == "perspective") {
        const float angle = float(camera.perspective.yfov);
        registry_->emplace<scene::Camera>(entity, {angle >= 0.01f && angle <= 3.1f ? angle : 0.9f});
        return;
    }
    // An orthographic camera is approximated by a distant one with a narrow field of view.
    constexpr float angle = 0.035f;
    scene::Transform back;
    back.position.z = std::max(float(camera.orthographic.ymag), 1e-3f) / std::tan(0.5f * angle);
    if (!is_finite(back.position)) {
        notes.push_back("camera of node '" + name + "' is so high that no distance shows all of it: it is left out");
        return;
    }
    registry_->emplace<scene::Camera>(child_of(entity, name + " orthographic", back), {angle});
    notes.push_back("camera of node '" + name +
                    "' is orthographic; it is approximated by a distant camera with a narrow field of view");
}

void NodeImport::add_light(const tinygltf::Light& light, ecs::Entity entity) {
    vec3 strength = vector_of(light.color, vec3(1.0f)) * (float(light.intensity) / luminous_efficacy);
    if (!is_finite(strength))
        strength = vec3(0.0f);
    if (light.type == "directional")
        registry_->emplace<scene::DirectionalLight>(entity, {strength});
    else if (light.type == "spot")
        registry_->emplace<scene::SpotLight>(entity, {strength, float(light.spot.innerConeAngle),
                                                      std::clamp(float(light.spot.outerConeAngle), 1e-3f, 1.5707f)});
    else
        registry_->emplace<scene::PointLight>(entity, {strength});
}

} // namespace sunfleck::io
