#include "editor/window/scene_copy.h"

#include "editor/document/edits.h"
#include "engine/core/user_folders.h"
#include "engine/scene/simulation_components.h"

#include <algorithm>

namespace sunfleck::editor {

void SceneChange::add(SceneChange later) {
    if (later.everything || source == nullptr) {
        *this = std::move(later);
        return;
    }
    handles = later.handles;
    updates.insert(updates.end(), std::make_move_iterator(later.updates.begin()),
                   std::make_move_iterator(later.updates.end()));
    meshes.insert(meshes.end(), std::make_move_iterator(later.meshes.begin()),
                  std::make_move_iterator(later.meshes.end()));
    textures.insert(textures.end(), std::make_move_iterator(later.textures.begin()),
                    std::make_move_iterator(later.textures.end()));
    if (later.settings)
        settings = std::move(later.settings);
    link = std::move(later.link);
    if (later.encoded != nullptr)
        encoded = std::move(later.encoded);
    revision = later.revision;
    hiding = later.hiding;
    dragged = later.dragged;
}

namespace {

// Handles reserved for a document that has `handles`: it may grow for a while.
std::uint32_t room_for(std::uint32_t handles) {
    return 2 * handles + 4096;
}

// What is told of a hidden entity: what is below it needs its place.
bool is_told_of_hidden(const ecs::PoolBase& pool) {
    const TypeDescription* type = pool.description();
    return type == &scene::Name::description() || type == &scene::Parent::description() ||
           type == &scene::Transform::description();
}

bool gives_light(const ecs::PoolBase& pool) {
    return pool.description() != nullptr && pool.description() != &scene::LightSensor::description() &&
           std::any_of(pool.description()->fields.begin(), pool.description()->fields.end(), is_power);
}

// Lamps are told of as if they were not there; of surfaces that glow, the surface stays.
ecs::Value without_light(const Update& update) {
    if (update.pool->description() != &scene::Material::description())
        return nullptr;
    auto dark = std::make_shared<scene::Material>(*static_cast<const scene::Material*>(update.value.get()));
    dark->emission = vec3(0.0f);
    return dark;
}

void tell_all(Document& document, Entity entity, SceneChange& change) {
    if (!document.exists(entity))
        return;
    for (const ecs::PoolBase* pool : document.registry().all_pools())
        if (!pool->is_derived() && pool->is_copyable() && pool->contains(entity))
            change.updates.push_back({entity, pool, document.registry().value(*pool, entity)});
}

// A mover stands where its path has brought it. The document knows where it starts.
void put_back_in_place(ecs::Registry& registry, ecs::Entity entity, bool place_is_new) {
    const scene::MoverOrigin* origin = registry.try_get<scene::MoverOrigin>(entity);
    if (origin == nullptr)
        return;
    if (!place_is_new)
        registry.emplace_or_replace<scene::Transform>(entity, scene::Transform(origin->transform));
    registry.remove<scene::MoverOrigin>(entity);
}

} // namespace

void apply_updates(const std::vector<Update>& updates, ecs::Registry& registry) {
    for (const Update& update : updates) {
        if (!registry.alive(update.entity)) {
            if (update.value == nullptr)
                continue;
            registry.create_as(update.entity);
        }
        ecs::PoolBase& pool = registry.counterpart(*update.pool);
        put_back_in_place(registry, update.entity, pool.description() == &scene::Transform::description());
        registry.set_value(pool, update.entity, update.value.get());
        // Nothing else is derived from a place that is gone.
        if (!registry.has<scene::Transform>(update.entity) && registry.has<scene::WorldTransform>(update.entity))
            registry.remove<scene::WorldTransform>(update.entity);
    }
    scene::update_world_transforms(registry);
}

void HiddenFilter::hide(const Set& hidden, const Set& muted, SceneChange& change) {
    for (Update& update : change.updates)
        if (hidden.count(update.entity) > 0 && !is_told_of_hidden(*update.pool))
            update.value = nullptr;
        else if (muted.count(update.entity) > 0 && update.value != nullptr && gives_light(*update.pool))
            update.value = without_light(update);
}

void HiddenFilter::apply(const std::shared_ptr<Document>& document, const Set& hidden, const Set& muted,
                         std::optional<SceneChange>& change) {
    const bool other = hidden != hidden_ || muted != muted_;
    if (other && !change)
        change = ChangeCollector::nothing(document);
    count_ += other ? 1 : 0;
    if (!change)
        return;
    change->hiding = count_;
    const auto tell_those_of_one = [&](const Set& one, const Set& two) {
        for (const Entity entity : one)
            if (two.count(entity) == 0)
                tell_all(*document, entity, *change);
    };
    if (other && !change->everything) {
        tell_those_of_one(hidden_, hidden);
        tell_those_of_one(hidden, hidden_);
        tell_those_of_one(muted_, muted);
        tell_those_of_one(muted, muted_);
    }
    hide(hidden, muted, *change);
    hidden_ = hidden;
    muted_ = muted;
}

SceneChange ChangeCollector::nothing(const std::shared_ptr<Document>& document) {
    SceneChange change;
    change.source = document;
    change.handles = document->handle_count();
    change.encoded = document->encoded_textures();
    change.link = document->source();
    change.revision = document->revision();
    return change;
}

SceneChange ChangeCollector::everything(const std::shared_ptr<Document>& document) {
    SceneChange change = nothing(document);
    change.everything = true;
    for (const Entity entity : document->registry().entities())
        tell_all(*document, entity, change);
    for (std::uint32_t i = 0; i < document->meshes().size(); ++i)
        change.meshes.push_back(document->meshes()[i]);
    for (std::uint32_t i = 0; i < document->textures().size(); ++i)
        change.textures.push_back(document->textures()[i]);
    change.settings = document->settings();
    return change;
}

std::optional<SceneChange> ChangeCollector::collect(const std::shared_ptr<Document>& document) {
    const bool let_go = dragged_ && !document->in_gesture();
    if (known_ == document.get() && revision_ == document->revision() && !let_go)
        return std::nullopt;
    SceneChange change = nothing(document);
    change.dragged = document->in_gesture();
    change.everything = known_ != document.get();
    if (change.everything)
        *this = {};
    change.updates = change.everything ? document->all_updates() : document->take_updates();
    for (; meshes_ < document->meshes().size(); ++meshes_)
        change.meshes.push_back(document->meshes()[meshes_]);
    for (; textures_ < document->textures().size(); ++textures_)
        change.textures.push_back(document->textures()[textures_]);
    if (settings_revision_ != document->settings_revision())
        change.settings = document->settings();
    settings_revision_ = document->settings_revision();
    revision_ = document->revision();
    dragged_ = change.dragged;
    known_ = document.get();
    return change;
}

void PlainCopy::apply(const SceneChange& change) {
    if (change.handles > reserved_) {
        reserved_ = room_for(change.handles);
        registry.reserve_handles(reserved_);
    }
    for (const scene::Mesh& mesh : change.meshes)
        meshes.add(mesh);
    for (const scene::Texture& texture : change.textures)
        textures.add(texture);
    if (change.encoded != nullptr)
        encoded = change.encoded;
    link = change.link;
    apply_updates(change.updates, registry);
    if (change.settings)
        settings = *change.settings;
}

Result<std::unique_ptr<SceneCopy>> SceneCopy::create(gpu::Device& device) {
    std::unique_ptr<SceneCopy> copy(new SceneCopy());
    SUNFLECK_ASSIGN(copy->renderer_, viewer::SceneRenderer::create(device));
    copy->renderer_->lighting().set_cache_folder(user_cache_folder());
    return copy;
}

bool SceneCopy::takes(const SceneChange& change) const {
    return change.everything ? reserved_ == 0 : change.handles <= reserved_;
}

Status SceneCopy::apply(const SceneChange& change) {
    if (change.everything) {
        reserved_ = room_for(change.handles);
        renderer_->registry().reserve_handles(reserved_);
    }
    for (const scene::Mesh& mesh : change.meshes)
        renderer_->meshes().add(mesh);
    for (const scene::Texture& texture : change.textures)
        renderer_->textures().add(texture);
    apply_updates(change.updates, renderer_->registry());
    if (!change.meshes.empty() || !change.textures.empty() || change.everything)
        SUNFLECK_TRY(renderer_->upload_meshes());
    if (change.settings)
        SUNFLECK_TRY(renderer_->lighting().set_settings(*change.settings));
    return {};
}

} // namespace sunfleck::editor
