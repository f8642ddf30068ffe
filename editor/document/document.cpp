#include "editor/document/document.h"

#include "editor/document/content_hash.h"
#include "engine/scene/entity_templates.h"
#include "engine/scene/procedural.h"
#include "viewer/scene_renderer.h"

#include <algorithm>
#include <atomic>
#include <cstring>

namespace sunfleck::editor {
namespace {

constexpr std::size_t longest_name = 120; // bytes

bool same_mesh(const scene::Mesh& a, const scene::Mesh& b) {
    return a.name == b.name && a.positions == b.positions && a.normals == b.normals && a.indices == b.indices &&
           a.texture_coordinates == b.texture_coordinates && a.tangents == b.tangents && a.colours == b.colours;
}

// Without control characters, at most `longest_name` bytes, not cut within a letter.
std::string clean_name(std::string name) {
    for (char& letter : name)
        if (std::uint8_t(letter) < 32 || letter == 127)
            letter = ' ';
    if (name.size() > longest_name) {
        std::size_t end = longest_name;
        while (end > 0 && (std::uint8_t(name[end]) & 0xc0u) == 0x80u)
            --end;
        name.resize(end);
    }
    while (!name.empty() && name.back() == ' ')
        name.pop_back();
    name.erase(0, name.find_first_not_of(' '));
    return name.empty() ? "entity" : name;
}

// Also in a picture of the sky, which no field describes.
bool is_unchanged(const ComponentChange& change) {
    if (!same_value(*change.pool, change.before, change.after))
        return false;
    if (change.before == nullptr || change.after == nullptr ||
        change.pool->description() != &scene::EnvironmentMap::description())
        return true;
    return static_cast<const scene::EnvironmentMap*>(change.before.get())->image ==
           static_cast<const scene::EnvironmentMap*>(change.after.get())->image;
}

} // namespace

bool same_field(const Field& field, const void* a, const void* b) {
    const char* from = static_cast<const char*>(a) + field.offset;
    const char* to = static_cast<const char*>(b) + field.offset;
    switch (field.kind) {
    case FieldKind::text:
        return *reinterpret_cast<const std::string*>(from) == *reinterpret_cast<const std::string*>(to);
    case FieldKind::boolean:
        return *reinterpret_cast<const bool*>(from) == *reinterpret_cast<const bool*>(to);
    case FieldKind::vector3:
        return std::memcmp(from, to, sizeof(vec3)) == 0;
    case FieldKind::quaternion:
        return std::memcmp(from, to, sizeof(quat)) == 0;
    case FieldKind::entity:
        return std::memcmp(from, to, sizeof(EntityBits)) == 0;
    default:
        return std::memcmp(from, to, 4) == 0;
    }
}

bool same_value(const ecs::PoolBase& pool, const ecs::Value& a, const ecs::Value& b) {
    if (a == nullptr || b == nullptr || a == b)
        return a == b;
    const TypeDescription* type = pool.description();
    return type != nullptr && std::all_of(type->fields.begin(), type->fields.end(),
                                          [&](const Field& field) { return same_field(field, a.get(), b.get()); });
}

ecs::PoolBase* find_component(Document& document, std::string_view name) {
    for (ecs::PoolBase* pool : document.registry().described_pools())
        if (pool->description()->name == name)
            return pool;
    return nullptr;
}

std::uint64_t Document::next_number() {
    static std::atomic<std::uint64_t> last{0}; // files load on threads of their own
    return ++last;
}

Document::Document() {
    scene::register_components(registry_);
    name_pool_ = find_component(*this, scene::Name::description().name);
    parent_pool_ = find_component(*this, scene::Parent::description().name);
    lamp_pool_ = find_component(*this, scene::AreaLight::description().name);
    sky_pool_ = find_component(*this, scene::EnvironmentMap::description().name);
}

Result<std::unique_ptr<Document>> Document::open(const std::filesystem::path& path,
                                                 const std::function<bool(float)>& progress, bool allow_outside) {
    auto document = std::make_unique<Document>();
    document->stamp_ = FileStamp::of(path);
    if (path.extension() != ".json")
        document->file_checksum_ = checksum_of_file(path);
    io::ImportOptions options;
    options.progress = progress;
    options.allow_outside = allow_outside;
    options.for_saving = true;
    SUNFLECK_ASSIGN(const io::ImportReport report,
                    io::load_scene(path, document->registry_, document->meshes_, document->textures_, options));
    document->notes_ = report.notes;
    document->set_source(report.source);
    for (const auto& [name, value] : report.settings)
        if (const Status status = document->settings_.set(name, value); !status)
            document->notes_.push_back(status.error().message);
    if (report.default_light && viewer::add_default_light(document->registry_))
        document->notes_.push_back("The scene has no lights: a sky and a sun were added");
    document->name_everything();
    document->path_ = path;
    document->folder_ = path.parent_path();
    return document;
}

// Everything that has a component that can be seen or saved gets a name, and names are distinct.
void Document::name_everything() {
    for (const Entity entity : registry_.entities()) {
        const scene::Name* stored = registry_.try_get<scene::Name>(entity);
        const TypeDescription* first = nullptr;
        for (const ecs::PoolBase* pool : registry_.described_pools())
            if (pool->contains(entity) && pool != name_pool_ && (first == nullptr || first->name == "Transform"))
                first = pool->description();
        if (stored == nullptr && first == nullptr)
            continue;
        std::string name = free_name(stored != nullptr ? stored->name : std::string(first->name));
        by_name_[name] = entity;
        handles_ = std::max(handles_, entity.index + 1);
        if (stored == nullptr || stored->name != name)
            registry_.emplace_or_replace<scene::Name>(entity, {std::move(name)});
    }
    ++structure_revision_;
    find_all_children();
}

void Document::begin(std::string name) {
    if (gesture_)
        commit();
    gesture_.emplace();
    gesture_->name = std::move(name);
    gesture_->selected_before = shared_selection();
}

const std::shared_ptr<const std::vector<Entity>>& Document::shared_selection() {
    if (shared_selection_ == nullptr || *shared_selection_ != selection_)
        shared_selection_ = std::make_shared<const std::vector<Entity>>(selection_);
    return shared_selection_;
}

HistoryEntry Document::end_gesture() {
    HistoryEntry entry = std::move(*gesture_);
    gesture_.reset();
    for (const ComponentChange& change : entry.components)
        newest_change_[change.entity.index] = 0;
    change_before_.clear();
    return entry;
}

void Document::set(Entity entity, ecs::PoolBase& pool, const ecs::Value& value) {
    assert(gesture_ && "edits belong to a gesture");
    if (entity.index >= newest_change_.size())
        newest_change_.resize(entity.index + 1);
    for (std::uint32_t number = newest_change_[entity.index]; number > 0; number = change_before_[number - 1])
        if (ComponentChange& known = gesture_->components[number - 1]; known.pool == &pool) {
            known.after = value;
            return apply(entity, pool, value);
        }
    change_before_.push_back(newest_change_[entity.index]);
    gesture_->components.push_back({entity, &pool, registry_.value(pool, entity), value});
    newest_change_[entity.index] = std::uint32_t(gesture_->components.size());
    apply(entity, pool, value);
}

Status Document::set_setting(std::string_view name, std::string_view value) {
    assert(gesture_ && "edits belong to a gesture");
    const std::string before = settings_.get(name);
    SUNFLECK_TRY(settings_.set(name, value));
    if (Status valid = settings_.validate(); !valid) {
        SUNFLECK_TRY(settings_.set(name, before));
        return valid;
    }
    note_setting(name, before);
    return {};
}

Status Document::set_settings(const gi::Settings& settings) {
    assert(gesture_ && "edits belong to a gesture");
    SUNFLECK_TRY(settings.validate());
    const gi::Settings before = settings_;
    settings_ = settings;
    for (const std::string_view name : gi::Settings::names())
        if (before.get(name) != settings.get(name))
            note_setting(name, before.get(name));
    return {};
}

// In the gesture; the setting has its new value.
void Document::note_setting(std::string_view name, const std::string& before) {
    ++revision_;
    ++settings_revision_;
    for (SettingChange& known : gesture_->settings)
        if (known.name == name) {
            known.after = settings_.get(name);
            return;
        }
    gesture_->settings.push_back({std::string(name), before, settings_.get(name)});
}

bool Document::gesture_changed() const {
    if (!gesture_)
        return false;
    return std::any_of(gesture_->components.begin(), gesture_->components.end(),
                       [](const ComponentChange& change) { return !is_unchanged(change); }) ||
           std::any_of(gesture_->settings.begin(), gesture_->settings.end(),
                       [](const SettingChange& change) { return change.before != change.after; });
}

std::uint32_t Document::add_shape(scene::Mesh mesh) {
    const auto known = std::find_if(shapes_.begin(), shapes_.end(),
                                    [&](std::uint32_t index) { return same_mesh(meshes_[index], mesh); });
    if (known != shapes_.end())
        return *known;
    shapes_.push_back(add_mesh(std::move(mesh)));
    return shapes_.back();
}

// What one sees of an area light follows its light.
void Document::settle_lamps() {
    struct Lamp {
        Entity entity;
        scene::AreaLight before, now;
    };
    std::vector<Lamp> lamps;
    for (const ComponentChange& change : gesture_->components)
        if (change.pool == lamp_pool_ && change.before != nullptr && change.after != nullptr)
            lamps.push_back({change.entity, *static_cast<const scene::AreaLight*>(change.before.get()),
                             *static_cast<const scene::AreaLight*>(change.after.get())});
    for (const Lamp& lamp : lamps) {
        const auto* material = registry_.try_get<scene::Material>(lamp.entity);
        if (material != nullptr && material->emission == lamp.before.radiance) {
            auto value = std::make_shared<scene::Material>(*material);
            value->emission = lamp.now.radiance;
            set(lamp.entity, *find_component(*this, scene::Material::description().name), std::move(value));
        }
        if (registry_.has<scene::MeshInstance>(lamp.entity) && scene::needs_other_mesh(lamp.before, lamp.now)) {
            auto value = std::make_shared<scene::MeshInstance>();
            value->mesh = add_shape(scene::make_area_light_mesh(lamp.now));
            set(lamp.entity, *find_component(*this, scene::MeshInstance::description().name), std::move(value));
        }
    }
}

bool Document::commit() {
    if (!gesture_)
        return false;
    settle_lamps();
    settle_skies();
    HistoryEntry entry = end_gesture();
    std::erase_if(entry.components, is_unchanged);
    std::erase_if(entry.settings, [](const SettingChange& change) { return change.before == change.after; });
    if (entry.empty())
        return false;
    entry.selected_after = shared_selection();
    history_.add(std::move(entry));
    return true;
}

void Document::cancel() {
    if (!gesture_)
        return;
    const HistoryEntry entry = end_gesture();
    apply(entry, false);
    select(*entry.selected_before);
}

void Document::apply(const HistoryEntry& entry, bool forward) {
    const auto change = [&](const ComponentChange& one) {
        apply(one.entity, *one.pool, forward ? one.after : one.before);
    };
    if (forward)
        std::for_each(entry.components.begin(), entry.components.end(), change);
    else
        std::for_each(entry.components.rbegin(), entry.components.rend(), change);
    for (const SettingChange& setting : entry.settings)
        settings_.with(setting.name, forward ? setting.after : setting.before);
    settings_revision_ += entry.settings.empty() ? 0 : 1;
    ++revision_;
}

bool Document::undo() {
    cancel();
    if (!history_.can_undo())
        return false;
    const HistoryEntry& entry = history_.step_back();
    apply(entry, false);
    select(*entry.selected_before);
    return true;
}

bool Document::redo() {
    cancel();
    if (!history_.can_redo())
        return false;
    const HistoryEntry& entry = history_.step_forward();
    apply(entry, true);
    select(*entry.selected_after);
    return true;
}

void Document::apply(Entity entity, ecs::PoolBase& pool, const ecs::Value& value) {
    if (&pool == name_pool_ || &pool == parent_pool_) {
        ++structure_revision_;
        if (moved_.size() <= by_name_.size()) // with more, find_children looks at all entities in any case
            moved_.push_back(entity);
        if (&pool == name_pool_)
            name_changed(entity, registry_.try_get<scene::Name>(entity), value.get());
    }
    registry_.set_value(pool, entity, value.get());
    if (updates_.size() >= tidied_at_) {
        tidy_updates();
        tidied_at_ = std::max(2 * updates_.size(), most_untidied);
    }
    updates_.push_back({entity, &pool, value});
    handles_ = std::max(handles_, entity.index + 1);
    ++revision_;
}

void Document::name_changed(Entity entity, const void* before, const void* after) {
    if (before != nullptr) {
        const auto known = by_name_.find(static_cast<const scene::Name*>(before)->name);
        if (known != by_name_.end() && known->second == entity)
            by_name_.erase(known);
    }
    if (after != nullptr)
        by_name_[static_cast<const scene::Name*>(after)->name] = entity;
}

std::string Document::free_name(const std::string& wanted) const {
    std::string clean = clean_name(wanted);
    if (by_name_.count(clean) == 0)
        return clean;
    // "lamp 7" counts on from 7.
    std::string stem = clean;
    while (!stem.empty() && stem.back() >= '0' && stem.back() <= '9')
        stem.pop_back();
    stem =
        stem.size() > 1 && stem.size() < clean.size() && stem.back() == ' ' ? stem.substr(0, stem.size() - 1) : clean;
    // Doubling, then halving: numbers are mostly taken from below, so that thousands of copies cost little. Any free
    // one would do.
    const auto taken = [&](std::uint64_t number) { return by_name_.count(stem + " " + std::to_string(number)) > 0; };
    std::uint64_t high = 2;
    while (taken(high))
        high *= 2;
    std::uint64_t low = high / 2;
    while (high - low > 1) {
        const std::uint64_t middle = (low + high) / 2;
        (taken(middle) ? low : high) = middle;
    }
    return stem + " " + std::to_string(high);
}

} // namespace sunfleck::editor
