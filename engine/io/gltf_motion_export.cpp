#include "engine/io/gltf_motion_export.h"

#include "engine/scene/components.h"

namespace sunfleck::io {
namespace {

constexpr int float_component = TINYGLTF_COMPONENT_TYPE_FLOAT;

const char* channel_path(scene::AnimationTarget target) {
    return target == scene::AnimationTarget::position   ? "translation"
           : target == scene::AnimationTarget::rotation ? "rotation"
                                                        : "scale";
}

// As many weights for each key as there are morph targets: those beyond have no effect, and those that lack are zero.
std::vector<float> with_width(const scene::WeightCurve& curve, std::size_t width) {
    if (curve.width == width)
        return curve.values;
    std::vector<float> result;
    for (std::size_t i = 0; i + curve.width <= curve.values.size() && curve.width > 0; i += curve.width)
        for (std::size_t k = 0; k < width; ++k)
            result.push_back(k < curve.width ? curve.values[i + k] : 0.0f);
    return result;
}

// Of several curves of one property the last one counts.
std::vector<const scene::AnimationCurve*> curves_that_count(const scene::Animation& animation) {
    std::map<scene::AnimationTarget, const scene::AnimationCurve*> last;
    for (const scene::AnimationCurve& curve : animation.curves)
        if (!curve.times.empty())
            last[curve.target] = &curve;
    std::vector<const scene::AnimationCurve*> result;
    for (const scene::AnimationCurve& curve : animation.curves)
        if (!curve.times.empty() && last[curve.target] == &curve)
            result.push_back(&curve);
    return result;
}

} // namespace

const scene::Deformation* deformation_of(const ecs::Registry& registry, ecs::Entity entity) {
    const auto* deformation = registry.try_get<scene::Deformation>(entity);
    return deformation != nullptr && deformation->source != nullptr ? deformation : nullptr;
}

void MotionExport::add_deformation(const scene::DeformableMesh& mesh, tinygltf::Primitive& primitive) {
    for (const scene::MorphTarget& source : mesh.targets) {
        std::map<std::string, int> target;
        const auto add = [&](const char* name, const std::vector<vec3>& values) {
            target[name] =
                file_.share_accessor(values, TINYGLTF_TYPE_VEC3, float_component, TINYGLTF_TARGET_ARRAY_BUFFER);
        };
        add("POSITION", source.positions);
        file_.add_bounds(target["POSITION"], source.positions, 3);
        if (!source.normals.empty())
            add("NORMAL", source.normals);
        primitive.targets.push_back(std::move(target));
    }
    for (std::uint32_t set = 0; set < mesh.influences / 4; ++set) {
        struct Joints {
            std::uint16_t of[4];
        };
        std::vector<Joints> joints(mesh.rest.positions.size());
        std::vector<vec4> weights(joints.size());
        for (std::size_t v = 0; v < joints.size(); ++v)
            for (int i = 0; i < 4; ++i) {
                const std::size_t place = v * mesh.influences + set * 4 + std::size_t(i);
                if (mesh.joints[place] > 0xffffu)
                    problem_ = Error{"a vertex of '" + mesh.rest.name + "' follows joint " +
                                     std::to_string(mesh.joints[place]) + ", and glTF ends at 65535"};
                joints[v].of[i] = mesh.weights[place] > 0.0f ? std::uint16_t(mesh.joints[place]) : std::uint16_t(0);
                weights[v][i] = mesh.weights[place];
            }
        const std::string number = std::to_string(set);
        primitive.attributes["JOINTS_" + number] = file_.share_accessor(
            joints, TINYGLTF_TYPE_VEC4, TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT, TINYGLTF_TARGET_ARRAY_BUFFER);
        primitive.attributes["WEIGHTS_" + number] =
            file_.share_accessor(weights, TINYGLTF_TYPE_VEC4, float_component, TINYGLTF_TARGET_ARRAY_BUFFER);
    }
}

void MotionExport::add_node(const scene::Deformation& deformation, int number, tinygltf::Node& node) {
    deforming_.push_back({number, &deformation});
    moved_by_[deformation.weights_of.bits()].push_back(deforming_.back());
    if (deformation.source->influences > 0) {
        tinygltf::Value::Object marks;
        marks[mark_own_mesh] = tinygltf::Value(true);
        node.extras = tinygltf::Value(marks);
    }
    const std::size_t targets = deformation.source->targets.size();
    const auto* weights = registry_.try_get<scene::MorphWeights>(deformation.weights_of);
    if (weights == nullptr || weights->weights.empty() || targets == 0)
        return;
    node.weights.assign(weights->weights.begin(), weights->weights.end());
    node.weights.resize(targets);
}

Status MotionExport::finish(const NodeNumbers& nodes) {
    SUNFLECK_TRY(problem_);
    for (const Deforming& one : deforming_)
        mark_weights(one, nodes);
    for (const Deforming& one : deforming_)
        if (one.deformation->source->influences > 0)
            file_.model.nodes[std::size_t(one.node)].skin = skin_of(*one.deformation, nodes);
    std::map<std::uint32_t, Clip> played, others;
    const auto add = [](std::map<std::uint32_t, Clip>& clips, ecs::Entity entity, const scene::Animation& animation) {
        Clip& clip = clips[animation.number];
        clip.name = clip.parts.empty() ? animation.name : clip.name;
        clip.parts.emplace_back(entity, &animation);
    };
    for (const auto& [entity, node] : nodes) {
        if (const auto* animation = registry_.try_get<scene::Animation>(entity))
            add(played, entity, *animation);
        if (const auto* kept = registry_.try_get<scene::OtherAnimations>(entity))
            for (const scene::Animation& animation : kept->clips)
                add(others, entity, animation);
    }
    for (const auto& [number, clip] : played)
        add_clip(clip, true, nodes);
    for (const auto& [number, clip] : others)
        add_clip(clip, !file_.model.animations.empty(), nodes);
    return {};
}

// Where they are another entity's.
void MotionExport::mark_weights(const Deforming& one, const NodeNumbers& nodes) {
    const ecs::Entity owner = one.deformation->weights_of;
    const auto found = registry_.alive(owner) ? nodes.find(owner) : nodes.end();
    if (found == nodes.end() || found->second == one.node || one.deformation->source->targets.empty())
        return;
    tinygltf::Node& node = file_.model.nodes[std::size_t(one.node)];
    tinygltf::Value::Object marks =
        node.extras.IsObject() ? node.extras.Get<tinygltf::Value::Object>() : tinygltf::Value::Object();
    marks[weights_key] = tinygltf::Value(found->second);
    node.extras = tinygltf::Value(marks);
}

// Joints that are not there any more, or have no name, are as if they stood in the origin: scene::deform_meshes. A
// joint that is in a skin twice stands for itself below itself (`above`): in glTF each joint is there once.
int MotionExport::stand_in(ecs::Entity joint, std::size_t place, int above) {
    const auto [known, is_new] = stand_ins_.try_emplace({joint.bits(), place}, int(file_.model.nodes.size()));
    if (is_new) {
        tinygltf::Node node;
        node.name = above < 0 ? "joint that is not there" : "the same joint";
        tinygltf::Value::Object marks;
        marks[mark_no_entity] = tinygltf::Value(true);
        node.extras = tinygltf::Value(marks);
        file_.model.nodes.push_back(node);
        (above < 0 ? file_.model.scenes[0].nodes : file_.model.nodes[std::size_t(above)].children)
            .push_back(known->second);
    }
    return known->second;
}

// Entities of one skin share it.
int MotionExport::skin_of(const scene::Deformation& deformation, const NodeNumbers& nodes) {
    tinygltf::Skin skin;
    for (std::size_t i = 0; i < deformation.joints.size(); ++i) {
        const ecs::Entity joint = deformation.joints[i];
        const auto found = registry_.alive(joint) ? nodes.find(joint) : nodes.end();
        const int number = found != nodes.end() ? found->second : -1;
        const bool again = std::find(skin.joints.begin(), skin.joints.end(), number) != skin.joints.end();
        skin.joints.push_back(number >= 0 && !again ? number : stand_in(joint, i, number));
    }
    skin.inverseBindMatrices =
        file_.share_accessor(deformation.inverse_bind_matrices, TINYGLTF_TYPE_MAT4, float_component, 0);
    std::vector<tinygltf::Skin>& skins = file_.model.skins;
    const auto known = std::find_if(skins.begin(), skins.end(), [&](const tinygltf::Skin& one) {
        return one.joints == skin.joints && one.inverseBindMatrices == skin.inverseBindMatrices;
    });
    if (known != skins.end())
        return int(known - skins.begin());
    skins.push_back(std::move(skin));
    return int(skins.size() - 1);
}

int MotionExport::add_sampler(tinygltf::Animation& target, const std::vector<float>& times, int output,
                              scene::AnimationInterpolation interpolation) {
    tinygltf::AnimationSampler sampler;
    sampler.input = file_.share_accessor(times, TINYGLTF_TYPE_SCALAR, float_component, 0, GltfWriter::Use::times);
    file_.add_bounds(sampler.input, times, 1);
    sampler.output = output;
    sampler.interpolation = interpolation == scene::AnimationInterpolation::step           ? "STEP"
                            : interpolation == scene::AnimationInterpolation::cubic_spline ? "CUBICSPLINE"
                                                                                           : "LINEAR";
    target.samplers.push_back(sampler);
    return int(target.samplers.size() - 1);
}

void MotionExport::add_curves(const scene::Animation& animation, int node, tinygltf::Animation& target) {
    for (const scene::AnimationCurve* curve : curves_that_count(animation)) {
        int output = 0;
        if (curve->target == scene::AnimationTarget::rotation)
            output = file_.share_accessor(curve->values, TINYGLTF_TYPE_VEC4, float_component, 0);
        else
            output = file_.share_accessor(std::vector<vec3>(curve->values.begin(), curve->values.end()),
                                          TINYGLTF_TYPE_VEC3, float_component, 0);
        tinygltf::AnimationChannel channel;
        channel.sampler = add_sampler(target, curve->times, output, curve->interpolation);
        channel.target_node = node;
        channel.target_path = channel_path(curve->target);
        target.channels.push_back(channel);
    }
}

void MotionExport::add_weights(const scene::WeightCurve& curve, const Deforming& deforming,
                               tinygltf::Animation& target) {
    const std::size_t width = deforming.deformation->source->targets.size();
    if (curve.times.empty() || curve.width == 0 || width == 0)
        return;
    tinygltf::AnimationChannel channel;
    channel.sampler = add_sampler(
        target, curve.times, file_.share_accessor(with_width(curve, width), TINYGLTF_TYPE_SCALAR, float_component, 0),
        curve.interpolation);
    channel.target_node = deforming.node;
    channel.target_path = "weights";
    target.channels.push_back(channel);
}

// Weights of one entity may move several meshes. Where something that took longer is no longer in the scene, or came
// from another file, channels say themselves when they repeat.
void MotionExport::add_clip(const Clip& clip, bool played, const NodeNumbers& nodes) {
    tinygltf::Animation target;
    target.name = clip.name;
    std::vector<float> durations; // of channels
    for (const auto& [entity, animation] : clip.parts) {
        add_curves(*animation, nodes.at(entity), target);
        if (const auto moved = moved_by_.find(entity.bits()); moved != moved_by_.end())
            for (const Deforming& one : moved->second)
                add_weights(animation->weights, one, target);
        durations.resize(target.channels.size(), animation->duration);
    }
    if (target.channels.empty())
        return;
    double last = 0.0;
    for (const tinygltf::AnimationSampler& sampler : target.samplers)
        last = std::max(last, file_.model.accessors[std::size_t(sampler.input)].maxValues.at(0));
    for (std::size_t i = 0; i < durations.size(); ++i)
        if (double(durations[i]) != last) {
            tinygltf::Value::Object stated;
            stated[duration_key] = tinygltf::Value(double(durations[i]));
            target.channels[i].extras = tinygltf::Value(stated);
        }
    if (!played) {
        tinygltf::Value::Object marks;
        marks[mark_not_played] = tinygltf::Value(true);
        target.extras = tinygltf::Value(marks);
    }
    file_.model.animations.push_back(std::move(target));
}

} // namespace sunfleck::io
