// What moves entities that come from nodes.
#include "engine/io/gltf_nodes.h"
#include "engine/io/gltf_writer.h"

#include <algorithm>

namespace sunfleck::io {
namespace {

// Of a clip, to the same one of another entity.
void move_weights(scene::Animation& from, scene::Animation& to) {
    if (from.weights.times.empty())
        return;
    to.weights = std::move(from.weights);
    from.weights = {};
    to.name = from.name;
    to.number = from.number;
    to.duration = from.duration;
}

void move_kept_weights(std::vector<scene::Animation>& from, std::vector<scene::Animation>& to) {
    for (scene::Animation& clip : from) {
        if (clip.weights.times.empty())
            continue;
        auto place = std::find_if(to.begin(), to.end(), [&](const auto& one) { return one.number == clip.number; });
        if (place == to.end())
            place = to.insert(std::upper_bound(to.begin(), to.end(), clip,
                                               [](const auto& a, const auto& b) { return a.number < b.number; }),
                              scene::Animation());
        move_weights(clip, *place);
    }
    std::erase_if(from, [](const scene::Animation& clip) { return clip.curves.empty(); });
}

bool has_weights(const scene::Animation& animation) {
    return !animation.weights.times.empty();
}

bool has_weights(const scene::OtherAnimations& kept) {
    return !kept.clips.empty();
}

} // namespace

// A node that no entity becomes of stands for the one above it; null: for the origin.
ecs::Entity NodeImport::joint_entity(int joint) const {
    if (!is_marked(model_->nodes[std::size_t(joint)].extras, mark_no_entity))
        return entities_[std::size_t(joint)];
    for (std::size_t i = 0; i < model_->nodes.size(); ++i) {
        const std::vector<int>& below = model_->nodes[i].children;
        if (std::find(below.begin(), below.end(), joint) != below.end())
            return entities_[i];
    }
    return ecs::null_entity;
}

void NodeImport::bind_skins() {
    for (const auto& [entity, number] : skinned_) {
        const ImportedSkin& skin = content_.skins[std::size_t(number)];
        const auto outside = std::count_if(skin.joints.begin(), skin.joints.end(), [&](int joint) {
            return entities_[std::size_t(joint)].is_null() &&
                   !is_marked(model_->nodes[std::size_t(joint)].extras, mark_no_entity);
        });
        if (outside > 0)
            notes.push_back("skin " + std::to_string(number) + ": " + std::to_string(outside) +
                            " of its joints are not in the scene: their transforms are left out");
        registry_->patch<scene::Deformation>(entity, [&](scene::Deformation& deformation) {
            for (const int joint : skin.joints)
                deformation.joints.push_back(joint_entity(joint));
            deformation.inverse_bind_matrices = skin.inverse_bind_matrices;
        });
    }
}

void NodeImport::add_animations() {
    for (auto& [node, animation] : content_.animations) {
        const ecs::Entity entity = entities_[std::size_t(node)];
        if (entity.is_null())
            continue;
        if (!animation.curves.empty())
            registry_->emplace_or_replace<scene::Mover>(entity, {});
        registry_->emplace<scene::Animation>(entity, std::move(animation));
    }
    for (auto& clip : content_.other_animations)
        for (auto& [node, animation] : clip) {
            const ecs::Entity entity = entities_[std::size_t(node)];
            if (entity.is_null())
                continue;
            if (!registry_->has<scene::OtherAnimations>(entity))
                registry_->emplace<scene::OtherAnimations>(entity, {});
            registry_->patch<scene::OtherAnimations>(
                entity, [&](scene::OtherAnimations& kept) { kept.clips.push_back(std::move(animation)); });
        }
}

template <typename T, typename Move, typename IsEmpty>
void NodeImport::move_animated_weights(ecs::Entity from, ecs::Entity to, const Move& move, const IsEmpty& is_empty) {
    if (!registry_->has<T>(from))
        return;
    T left = registry_->get<T>(from);
    T given = registry_->has<T>(to) ? registry_->get<T>(to) : T();
    move(left, given);
    if (!is_empty(given) || has_weights(given))
        registry_->emplace_or_replace<T>(to, std::move(given));
    if (is_empty(left))
        registry_->remove<T>(from);
    else
        registry_->emplace_or_replace<T>(from, std::move(left));
}

// Files of this program say where the weights of several meshes are one entity's. In glTF each node has its own.
void NodeImport::give_weights_back() {
    for (std::size_t i = 0; i < entities_.size(); ++i) {
        const tinygltf::Value& extras = model_->nodes[i].extras;
        if (!extras.IsObject() || !extras.Has(weights_key) || !extras.Get(weights_key).IsInt())
            continue;
        const int number = extras.Get(weights_key).Get<int>();
        const ecs::Entity from = entities_[i], to = in_range(number, entities_) ? entities_[std::size_t(number)] : from;
        if (from == to || from.is_null() || to.is_null() || !registry_->has<scene::Deformation>(from))
            continue;
        registry_->patch<scene::Deformation>(from, [&](scene::Deformation& one) { one.weights_of = to; });
        if (registry_->has<scene::MorphWeights>(from)) {
            registry_->emplace_or_replace<scene::MorphWeights>(
                to, scene::MorphWeights(registry_->get<scene::MorphWeights>(from)));
            registry_->remove<scene::MorphWeights>(from);
        }
        move_animated_weights<scene::Animation>(from, to, move_weights,
                                                [](const auto& one) { return one.curves.empty(); });
        move_animated_weights<scene::OtherAnimations>(
            from, to, [](auto& a, auto& b) { move_kept_weights(a.clips, b.clips); },
            [](const auto& one) { return one.clips.empty(); });
    }
}

} // namespace sunfleck::io
