#include "engine/scene/scene_changes.h"

#include <algorithm>
#include <atomic>

namespace sunfleck::scene {
namespace {

template <typename T>
std::optional<T> optional_of(const ecs::Registry& registry, ecs::Entity entity) {
    const T* stored = registry.try_get<T>(entity);
    return stored != nullptr ? std::optional<T>(*stored) : std::nullopt;
}

std::optional<Drawable> describe(const ecs::Registry& registry, const MeshStore& meshes, const SceneSpace& space,
                                 ecs::Entity entity) {
    const MeshInstance* instance = registry.try_get<MeshInstance>(entity);
    const WorldTransform* world = registry.try_get<WorldTransform>(entity);
    if (instance == nullptr || world == nullptr || instance->mesh >= meshes.size())
        return std::nullopt;
    Drawable drawable;
    drawable.entity = entity;
    drawable.mesh = instance->mesh;
    drawable.revision = meshes.revision(instance->mesh);
    drawable.matrix = space.place(world->matrix);
    drawable.bounds = transform_bounds(drawable.matrix, meshes.bounds(instance->mesh));
    if (const Material* material = registry.try_get<Material>(entity))
        drawable.material = *material;
    if (const MaterialTextures* textures = registry.try_get<MaterialTextures>(entity)) {
        drawable.textures = *textures;
        drawable.has_textures = true;
    }
    if (const SurfacePattern* pattern = registry.try_get<SurfacePattern>(entity)) {
        drawable.pattern = *pattern;
        drawable.has_pattern = true;
    }
    drawable.is_lamp = registry.has<AreaLight>(entity);
    drawable.is_static = is_static(registry, entity);
    const ShadowCasting* casting = registry.try_get<ShadowCasting>(entity);
    drawable.casts_shadow = drawable.is_static || casting == nullptr || casting->casts;
    return drawable;
}

bool same_shape(const Drawable& a, const Drawable& b) {
    return a.mesh == b.mesh && a.revision == b.revision && a.matrix == b.matrix;
}

bool same_surface(const Drawable& a, const Drawable& b) {
    return a.material == b.material && a.has_textures == b.has_textures && a.textures == b.textures &&
           a.has_pattern == b.has_pattern && a.pattern == b.pattern && a.is_lamp == b.is_lamp;
}

bool same_drawable(const Drawable& a, const Drawable& b) {
    return same_shape(a, b) && same_surface(a, b) && a.is_static == b.is_static && a.casts_shadow == b.casts_shadow;
}

bool same_holes(const Drawable& a, const Drawable& b) {
    const Material &x = a.material, &y = b.material;
    if (x.alpha_mode != y.alpha_mode || x.alpha_mode == AlphaMode::opaque)
        return x.alpha_mode == y.alpha_mode;
    return x.alpha == y.alpha && x.alpha_cutoff == y.alpha_cutoff && a.textures.base_colour == b.textures.base_colour;
}

bool changes_static_geometry(const DrawableChange& change) {
    if (!change.is_static())
        return false;
    return change.moved() || change.before->is_static != change.now->is_static ||
           !same_holes(*change.before, *change.now);
}

} // namespace

bool DrawableChange::moved() const {
    return before == nullptr || now == nullptr || !same_shape(*before, *now);
}

bool DrawableChange::surface_changed() const {
    return before == nullptr || now == nullptr || !same_surface(*before, *now);
}

ChangeTracker::ChangeTracker(Space space) : wanted_space_(space) {
    static std::atomic<std::uint64_t> made{0};
    changes_.tracker = ++made;
}

const SceneChanges& ChangeTracker::collect(ecs::Registry& registry, const MeshStore& meshes) {
    const ecs::Tick until = registry.advance_tick();
    const std::uint64_t tracker = changes_.tracker, serial = changes_.serial + 1;
    changes_ = {};
    changes_.tracker = tracker;
    changes_.serial = serial;
    changes_.everything = forced_ || registry_ != registry.id() || meshes_ != &meshes;
    if (changes_.everything)
        forget(registry);
    forced_ = false;
    registry_ = registry.id();
    meshes_ = &meshes;
    compare_all(registry, meshes);
    if (wanted_space_ == Space::of_scene && (changes_.everything || changes_.static_geometry)) {
        const SceneSpace space = find_space(registry, meshes);
        if (space != space_) {
            space_ = space;
            changes_.everything = true;
            forget(registry);
            compare_all(registry, meshes);
        }
    }
    seen_ = until;
    changes_.space = space_;
    return changes_;
}

void ChangeTracker::compare_all(ecs::Registry& registry, const MeshStore& meshes) {
    candidates_.clear();
    before_.clear();
    changed_drawables_.clear();
    changed_emitters_.clear();
    changed_meshes_.clear();
    find_candidates(registry, meshes);
    for (const ecs::Entity entity : candidates_) {
        compare_drawable(registry, meshes, entity);
        compare_emitter(registry, meshes, entity);
    }
    changes_.examined += candidates_.size();
    list_all(registry);
    changes_.drawables = changed_drawables_;
    changes_.meshes = changed_meshes_;
    changes_.emitters = changed_emitters_;
    changes_.all = all_;
    changes_.static_geometry =
        std::any_of(changed_drawables_.begin(), changed_drawables_.end(), changes_static_geometry);
}

SceneSpace ChangeTracker::find_space(ecs::Registry& registry, const MeshStore& meshes) const {
    std::vector<PlacedMesh> geometry;
    registry.view<MeshInstance, WorldTransform>().each(
        [&](ecs::Entity entity, const MeshInstance& instance, const WorldTransform& world) {
            if (instance.mesh < meshes.size() && is_static(registry, entity))
                geometry.push_back({instance.mesh, world.matrix});
        });
    return space_of(geometry, meshes);
}

void ChangeTracker::forget(const ecs::Registry& registry) {
    seen_ = 0;
    mesh_edits_ = 0;
    revisions_.clear();
    order_ = {-1, 0};
    drawables_.clear();
    // Lights that are out now stay known.
    if (registry_ != registry.id())
        emitters_.clear();
    std::erase_if(emitters_, [&](const auto& entry) { return !registry.alive(entry.first); });
    for (auto& [entity, state] : emitters_)
        state = {};
    mesh_of_.clear();
    users_.clear();
    parent_of_.clear();
    children_.clear();
    all_.clear();
}

// Adds the entities whose T was added, changed or removed; all known ones if the registry cannot say any more.
template <typename T>
void ChangeTracker::add_stamped(ecs::Registry& registry, std::vector<ecs::Entity>& to) {
    if (!registry.any_change_since<T>(seen_))
        return;
    registry.each_changed_since<T>(seen_, [&](ecs::Entity entity, const T&) { to.push_back(entity); });
    registry.each_removed_since<T>(seen_, [&](ecs::Entity entity) { to.push_back(entity); });
    if (!registry.knows_removals_since<T>(seen_))
        add_known();
}

void ChangeTracker::add_known() {
    for (const auto& [entity, mesh] : mesh_of_)
        candidates_.push_back(entity);
    for (const auto& [entity, state] : emitters_)
        candidates_.push_back(entity);
}

void ChangeTracker::find_candidates(ecs::Registry& registry, const MeshStore& meshes) {
    add_stamped<MeshInstance>(registry, candidates_);
    for (const ecs::Entity entity : candidates_)
        follow_mesh_of(registry, entity);
    add_stamped<WorldTransform>(registry, candidates_);
    add_stamped<Material>(registry, candidates_);
    add_stamped<MaterialTextures>(registry, candidates_);
    add_stamped<SurfacePattern>(registry, candidates_);
    add_stamped<ShadowCasting>(registry, candidates_);
    add_stamped<AreaLight>(registry, candidates_);
    add_stamped<PointLight>(registry, candidates_);
    add_stamped<SpotLight>(registry, candidates_);
    add_stamped<DirectionalLight>(registry, candidates_);
    add_stamped<Environment>(registry, candidates_);
    add_stamped<EnvironmentMap>(registry, candidates_);
    add_affected_by_hierarchy(registry);
    add_users_of_changed_meshes(registry, meshes);
    std::sort(candidates_.begin(), candidates_.end());
    candidates_.erase(std::unique(candidates_.begin(), candidates_.end()), candidates_.end());
}

void ChangeTracker::follow_mesh_of(const ecs::Registry& registry, ecs::Entity entity) {
    if (const auto known = mesh_of_.find(entity); known != mesh_of_.end()) {
        users_.erase({known->second, entity});
        mesh_of_.erase(known);
    }
    if (const MeshInstance* instance = registry.try_get<MeshInstance>(entity)) {
        mesh_of_[entity] = instance->mesh;
        users_.insert({instance->mesh, entity});
    }
}

void ChangeTracker::follow_parent_of(const ecs::Registry& registry, ecs::Entity entity) {
    if (const auto known = parent_of_.find(entity); known != parent_of_.end()) {
        children_.erase({known->second, entity});
        parent_of_.erase(known);
    }
    if (const Parent* parent = registry.try_get<Parent>(entity)) {
        parent_of_[entity] = parent->parent;
        children_.insert({parent->parent, entity});
    }
}

// Whoever has a Mover, or another parent, takes all below it along: they move or are static as it is.
void ChangeTracker::add_affected_by_hierarchy(ecs::Registry& registry) {
    std::vector<ecs::Entity> open;
    add_stamped<Parent>(registry, open);
    if (!registry.knows_removals_since<Parent>(seen_))
        for (const auto& [child, parent] : parent_of_)
            open.push_back(child);
    for (const ecs::Entity entity : open)
        follow_parent_of(registry, entity);
    registry.each_added_since<Mover>(seen_, [&](ecs::Entity entity, const Mover&) { open.push_back(entity); });
    registry.each_removed_since<Mover>(seen_, [&](ecs::Entity entity) { open.push_back(entity); });
    if (!registry.knows_removals_since<Mover>(seen_))
        add_known();
    std::set<ecs::Entity> reached; // parents may form a ring
    while (!open.empty()) {
        const ecs::Entity entity = open.back();
        open.pop_back();
        if (!reached.insert(entity).second)
            continue;
        candidates_.push_back(entity);
        for (auto child = children_.lower_bound({entity, ecs::Entity{0, 0}});
             child != children_.end() && child->first == entity; ++child)
            open.push_back(child->second);
    }
}

void ChangeTracker::add_users_of_changed_meshes(const ecs::Registry& registry, const MeshStore& meshes) {
    if (mesh_edits_ == meshes.edits() && revisions_.size() == meshes.size())
        return;
    mesh_edits_ = meshes.edits();
    const std::size_t known = revisions_.size();
    revisions_.resize(std::max<std::size_t>(known, meshes.size()));
    for (std::uint32_t mesh = 0; mesh < revisions_.size(); ++mesh) {
        const bool replaced = mesh < known && mesh < meshes.size() && revisions_[mesh] != meshes.revision(mesh);
        if (replaced)
            changed_meshes_.push_back(mesh);
        if (mesh < meshes.size())
            revisions_[mesh] = meshes.revision(mesh);
        if (!replaced && mesh < known && mesh < meshes.size())
            continue;
        for (auto user = users_.lower_bound({mesh, ecs::Entity{0, 0}}); user != users_.end() && user->first == mesh;
             ++user)
            if (registry.alive(user->second))
                candidates_.push_back(user->second);
    }
    revisions_.resize(meshes.size());
}

void ChangeTracker::compare_drawable(const ecs::Registry& registry, const MeshStore& meshes, ecs::Entity entity) {
    std::optional<Drawable> now = describe(registry, meshes, space_, entity);
    const auto known = drawables_.find(entity);
    if (known == drawables_.end()) {
        if (now)
            changed_drawables_.push_back({entity, nullptr, &drawables_.emplace(entity, *now).first->second});
        return;
    }
    if (now && same_drawable(known->second, *now))
        return;
    before_.push_back(known->second);
    if (!now) {
        drawables_.erase(known);
        changed_drawables_.push_back({entity, &before_.back(), nullptr});
        return;
    }
    known->second = *now;
    changed_drawables_.push_back({entity, &before_.back(), &known->second});
}

void ChangeTracker::compare_emitter(const ecs::Registry& registry, const MeshStore& meshes, ecs::Entity entity) {
    EmitterState now;
    now.area = optional_of<AreaLight>(registry, entity);
    now.point = optional_of<PointLight>(registry, entity);
    now.spot = optional_of<SpotLight>(registry, entity);
    now.directional = optional_of<DirectionalLight>(registry, entity);
    now.environment = optional_of<Environment>(registry, entity);
    const Material* material = registry.try_get<Material>(entity);
    if (material != nullptr)
        now.emission = material->emission;
    const auto known = emitters_.find(entity);
    const bool emits = now.has_light() || now.emission != vec3(0.0f);
    if (known == emitters_.end() && !emits)
        return;
    if (!emits && material == nullptr) {
        emitters_.erase(known);
        changed_emitters_.push_back(entity);
        return;
    }
    now.map = optional_of<EnvironmentMap>(registry, entity);
    if (const WorldTransform* world = registry.try_get<WorldTransform>(entity))
        now.matrix = world->matrix;
    if (const MeshInstance* instance = registry.try_get<MeshInstance>(entity);
        instance != nullptr && instance->mesh < meshes.size()) {
        now.mesh = instance->mesh;
        now.revision = meshes.revision(instance->mesh);
    }
    if (const MaterialTextures* textures = registry.try_get<MaterialTextures>(entity)) {
        now.textured = bool(textures->emission);
        now.texture_average = textures->emission_average;
    }
    now.moves = !is_static(registry, entity);
    if (known != emitters_.end() && known->second == now)
        return;
    emitters_[entity] = std::move(now);
    changed_emitters_.push_back(entity);
}

std::pair<int, std::uint64_t> ChangeTracker::order_of(const ecs::Registry& registry) {
    if (registry.count<WorldTransform>() < registry.count<MeshInstance>())
        return {1, registry.order_version<WorldTransform>()};
    return {0, registry.order_version<MeshInstance>()};
}

void ChangeTracker::list_all(ecs::Registry& registry) {
    const bool other_entities = changes_.everything || std::any_of(changed_drawables_.begin(), changed_drawables_.end(),
                                                                   [](const DrawableChange& change) {
                                                                       return change.added() || change.removed();
                                                                   });
    const auto order = order_of(registry);
    if (!other_entities && order == order_)
        return;
    order_ = order;
    std::vector<const Drawable*> listed;
    listed.reserve(drawables_.size());
    registry.view<MeshInstance, WorldTransform>().each(
        [&](ecs::Entity entity, const MeshInstance&, const WorldTransform&) {
            ++changes_.examined;
            if (const auto found = drawables_.find(entity); found != drawables_.end())
                listed.push_back(&found->second);
        });
    changes_.order_changed = other_entities || listed != all_;
    all_ = std::move(listed);
}

} // namespace sunfleck::scene
