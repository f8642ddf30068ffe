#include "editor/document/reload.h"

#include "engine/scene/animation.h"
#include "engine/scene/deformation.h"

#include <algorithm>
#include <cstring>

namespace sunfleck::editor {
namespace {

bool same_mesh(const scene::Mesh& a, const scene::Mesh& b) {
    return a.positions == b.positions && a.normals == b.normals && a.indices == b.indices &&
           a.texture_coordinates == b.texture_coordinates && a.tangents == b.tangents && a.colours == b.colours;
}

bool same_texture(const scene::Texture& a, const scene::Texture& b) {
    return a.width == b.width && a.height == b.height && a.srgb == b.srgb && a.wrap_u == b.wrap_u &&
           a.wrap_v == b.wrap_v && a.nearest == b.nearest && a.pixels == b.pixels;
}

bool same_animation(const scene::Animation& a, const scene::Animation& b) {
    const auto same_curve = [](const scene::AnimationCurve& one, const scene::AnimationCurve& other) {
        return one.target == other.target && one.interpolation == other.interpolation && one.times == other.times &&
               one.values == other.values;
    };
    const scene::WeightCurve &weights = a.weights, &others = b.weights;
    return a.duration == b.duration && weights.interpolation == others.interpolation && weights.times == others.times &&
           weights.values == others.values && weights.width == others.width &&
           std::equal(a.curves.begin(), a.curves.end(), b.curves.begin(), b.curves.end(), same_curve);
}

// The index of a value in a store of the document, which it is added to if it is not there yet.
template <typename Store, typename Same, typename Add>
std::uint32_t place_in(const Store& store, const Same& same, const Add& add) {
    for (std::uint32_t i = 0; i < store.size(); ++i)
        if (same(store[i]))
            return i;
    return add();
}

// For components without a description.
template <typename T>
bool is_of(const ecs::PoolBase& pool) {
    return dynamic_cast<const ecs::Pool<T>*>(&pool) != nullptr;
}

class Merge {
public:
    Merge(Document& document, FileContent& content, Document& now)
        : document_(document), content_(content), now_(now), name_pool_(pool_of<scene::Name>(document)),
          parent_pool_(pool_of<scene::Parent>(document)) {}

    ReloadReport run() {
        document_.begin("Reload the file");
        find_entities();
        FileContent fresh = FileContent::of(now_);
        // Handles and numbers of the file become the document's.
        for (auto& [name, node] : fresh.nodes()) {
            node.entity = entities_.at(node.entity);
            for (auto& [pool, value] : node.components)
                std::tie(pool, value) = translated(*pool, value);
        }
        for (const auto& [name, node] : fresh.nodes())
            merge(name, node);
        const auto is_gone = [&](const auto& one) {
            return fresh.nodes().count(one.first) == 0 && document_.exists(one.second.entity);
        };
        for (const auto& one : content_.nodes())
            if (is_gone(one) && edited(one.second))
                note_lost(one.first, one.second.entity);
        for (const auto& one : content_.nodes())
            if (is_gone(one))
                remove_node(one.second.entity);
        for (const Entity entity : added_)
            if (const Entity above = document_.parent(entity); !above.is_null() && !document_.exists(above))
                document_.set(entity, parent_pool_, nullptr); // it was deleted here
        merge_settings(fresh.settings());
        content_ = std::move(fresh);
        document_.commit();
        return std::move(report_);
    }

private:
    // Each entity of the file, and which of the document it is; new ones are made.
    void find_entities() {
        for (const Entity root : now_.roots())
            for (const Entity entity : now_.family(root)) {
                const auto known = content_.nodes().find(now_.name(entity));
                const bool there = known != content_.nodes().end() && document_.exists(known->second.entity);
                const bool deleted = known != content_.nodes().end() && !there;
                entities_[entity] = there || deleted ? known->second.entity : document_.create();
            }
    }

    std::pair<ecs::PoolBase*, ecs::Value> translated(const ecs::PoolBase& pool, const ecs::Value& value) {
        ecs::PoolBase& own = document_.registry().counterpart(pool);
        std::shared_ptr<void> copy = pool.copy_value(value.get());
        if (const TypeDescription* type = pool.description())
            for (const Field& field : type->fields)
                if (field.kind == FieldKind::entity) {
                    auto* target = reinterpret_cast<Entity*>(static_cast<char*>(copy.get()) + field.offset);
                    const auto found = entities_.find(*target);
                    *target = found != entities_.end() ? found->second : ecs::null_entity;
                }
        if (&own == &pool_of<scene::MeshInstance>(document_))
            place_mesh(*static_cast<scene::MeshInstance*>(copy.get()));
        if (own.description() == nullptr)
            place_textures(pool, copy.get());
        return {&own, std::move(copy)};
    }

    void place_mesh(scene::MeshInstance& instance) {
        if (instance.mesh >= now_.meshes().size())
            return;
        const auto [known, is_new] = meshes_.try_emplace(instance.mesh, 0);
        if (is_new) {
            const scene::Mesh& mesh = now_.meshes()[instance.mesh];
            known->second = place_in(
                document_.meshes(), [&](const scene::Mesh& one) { return same_mesh(one, mesh); },
                [&] { return document_.add_mesh(mesh); });
        }
        instance.mesh = known->second;
    }

    void place_textures(const ecs::PoolBase& pool, void* value) {
        if (!is_of<scene::MaterialTextures>(pool))
            return;
        auto& all = *static_cast<scene::MaterialTextures*>(value);
        for (scene::TextureUse* use :
             {&all.base_colour, &all.metallic_roughness, &all.normal, &all.emission, &all.transmission}) {
            if (use->texture < 0 || std::uint32_t(use->texture) >= now_.textures().size())
                continue;
            const scene::Texture& texture = now_.textures()[std::uint32_t(use->texture)];
            use->texture = std::int32_t(place_in(
                document_.textures(), [&](const scene::Texture& one) { return same_texture(one, texture); },
                [&] { return document_.texture_store().add(texture); }));
        }
    }

    // Equal geometry may be there twice, under two numbers. Without a description, only textures and animations can be
    // compared.
    bool same(const ecs::PoolBase& pool, const ecs::Value& a, const ecs::Value& b) const {
        if (a != nullptr && b != nullptr && is_of<scene::MeshInstance>(pool)) {
            const std::uint32_t one = static_cast<const scene::MeshInstance*>(a.get())->mesh;
            const std::uint32_t other = static_cast<const scene::MeshInstance*>(b.get())->mesh;
            return one == other || same_mesh(document_.meshes()[one], document_.meshes()[other]);
        }
        if (a == nullptr || b == nullptr || pool.description() != nullptr)
            return same_value(pool, a, b);
        if (is_of<scene::MaterialTextures>(pool))
            return *static_cast<const scene::MaterialTextures*>(a.get()) ==
                   *static_cast<const scene::MaterialTextures*>(b.get());
        if (is_of<scene::OtherAnimations>(pool)) {
            const auto& clips = static_cast<const scene::OtherAnimations*>(a.get())->clips;
            const auto& others = static_cast<const scene::OtherAnimations*>(b.get())->clips;
            return std::equal(clips.begin(), clips.end(), others.begin(), others.end(), same_animation);
        }
        return !is_of<scene::Animation>(pool) || same_animation(*static_cast<const scene::Animation*>(a.get()),
                                                                *static_cast<const scene::Animation*>(b.get()));
    }

    void merge(const std::string& name, const FileContent::Node& node) {
        const auto known = content_.nodes().find(name);
        if (known == content_.nodes().end())
            return add(name, node);
        if (!document_.exists(node.entity)) // deleted here: an edit that stays
            return;
        bool changed = false;
        std::vector<ecs::PoolBase*> pools;
        for (const FileContent::Node* one : std::initializer_list<const FileContent::Node*>{&node, &known->second})
            for (const auto& [pool, value] : one->components)
                if (std::find(pools.begin(), pools.end(), pool) == pools.end())
                    pools.push_back(pool);
        for (ecs::PoolBase* pool : pools) {
            const ecs::Value *before = known->second.find(*pool), *now = node.find(*pool);
            changed =
                merge(node.entity, *pool, before != nullptr ? *before : nullptr, now != nullptr ? *now : nullptr) ||
                changed;
        }
        report_.changed += changed ? 1 : 0;
    }

    void merge_settings(const gi::Settings& now) {
        gi::Settings mixed = document_.settings();
        for (const std::string_view name : gi::Settings::names()) {
            const std::string before = content_.settings().get(name), text = now.get(name);
            if (text != before && mixed.get(name) == before && mixed.set(name, text))
                ++report_.settings;
        }
        if (report_.settings > 0 && !document_.set_settings(mixed)) // right only beside values that were edited here
            report_.settings = 0;
    }

    // True if the document's component has changed.
    bool merge(Entity entity, ecs::PoolBase& pool, const ecs::Value& before, const ecs::Value& now) {
        const ecs::Value own = document_.registry().value(pool, entity);
        if (same(pool, before, now) || same(pool, own, now))
            return false;
        if (same(pool, own, before)) {
            document_.set(entity, pool, now);
            return true;
        }
        if (own == nullptr || before == nullptr || now == nullptr || pool.description() == nullptr)
            return false;
        const std::shared_ptr<void> mixed = pool.copy_value(own.get());
        bool any = false;
        for (const Field& field : pool.description()->fields) {
            const std::string old_text = field_to_text(field, before.get()), text = field_to_text(field, now.get());
            if (text != old_text && field_to_text(field, own.get()) == old_text)
                any = static_cast<bool>(field_from_text(field, mixed.get(), text)) || any;
        }
        if (any)
            document_.set(entity, pool, mixed);
        return any;
    }

    void add(const std::string& name, const FileContent::Node& node) {
        ++report_.added;
        auto named = std::make_shared<scene::Name>();
        named->name = document_.free_name(name);
        document_.set(node.entity, name_pool_, std::move(named));
        for (const auto& [pool, value] : node.components)
            if (pool != &name_pool_ && !is_of<scene::Deformation>(*pool))
                document_.set(node.entity, *pool, value);
        added_.push_back(node.entity);
    }

    bool edited(const FileContent::Node& node) const {
        return std::any_of(node.components.begin(), node.components.end(), [&](const auto& one) {
            return !same(*one.first, document_.registry().value(*one.first, node.entity), one.second);
        });
    }

    void note_lost(const std::string& name, Entity entity) {
        const std::string& own = document_.name(entity);
        report_.lost.push_back(own == name ? name : own + " (in the file: " + name + ")");
    }

    // What was put below it stays where it is, at the top.
    void remove_node(Entity entity) {
        const Entities below = document_.children(entity);
        for (const Entity child : below) {
            const mat4 world = world_of(document_, child);
            document_.set(child, parent_pool_, nullptr);
            set_world(document_, child, world);
        }
        for (ecs::PoolBase* pool : document_.registry().all_pools())
            if (pool->contains(entity) && pool->is_copyable() && !pool->is_derived())
                document_.set(entity, *pool, nullptr);
        ++report_.removed;
    }

    Document& document_;
    FileContent& content_;
    Document& now_;
    ecs::PoolBase &name_pool_, &parent_pool_;
    std::unordered_map<Entity, Entity> entities_;             // of the file read again, to the document's
    std::unordered_map<std::uint32_t, std::uint32_t> meshes_; // likewise
    Entities added_;
    ReloadReport report_;
};

} // namespace

const ecs::Value* FileContent::Node::find(const ecs::PoolBase& pool) const {
    for (const auto& [known, value] : components)
        if (known == &pool)
            return &value;
    return nullptr;
}

FileContent FileContent::of(Document& document) {
    FileContent content;
    content.settings_ = document.settings();
    content.checksum_ = document.file_checksum();
    std::vector<ecs::PoolBase*> pools;
    for (ecs::PoolBase* pool : document.registry().all_pools())
        if (!pool->is_derived() && pool->is_copyable())
            pools.push_back(pool);
    for (const Entity root : document.roots())
        for (const Entity entity : document.family(root)) {
            Node& node = content.nodes_[document.name(entity)];
            node.entity = entity;
            for (ecs::PoolBase* pool : pools)
                if (pool->contains(entity))
                    node.components.emplace_back(pool, document.registry().value(*pool, entity));
        }
    return content;
}

std::string ReloadReport::text(const std::string& file) const {
    return "Reloaded " + file + ": " + std::to_string(changed) + " changed, " + std::to_string(added) + " new, " +
           std::to_string(removed) + " gone" +
           (settings == 0 ? "" : ", " + std::to_string(settings) + (settings == 1 ? " setting" : " settings"));
}

ReloadReport reload(Document& document, FileContent& content, Document& now) {
    return Merge(document, content, now).run();
}

} // namespace sunfleck::editor
