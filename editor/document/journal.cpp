#include "editor/document/journal.h"

#include "editor/document/edits.h"
#include "engine/core/output.h"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

namespace sunfleck::editor {
namespace {

using Json = nlohmann::json;

std::string line_of(const Json& json) {
    return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

template <typename Vector>
Json numbers(const std::vector<Vector>& values) {
    Json json = Json::array();
    for (const Vector& value : values)
        for (int i = 0; i < int(Vector::length()); ++i)
            json.push_back(value[i]);
    return json;
}

template <typename Vector>
std::vector<Vector> vectors(const Json& json) {
    const auto flat = json.get<std::vector<float>>();
    std::vector<Vector> values(flat.size() / std::size_t(Vector::length()));
    for (std::size_t i = 0; i < values.size(); ++i)
        for (int k = 0; k < int(Vector::length()); ++k)
            values[i][k] = flat[i * std::size_t(Vector::length()) + std::size_t(k)];
    return values;
}

Json json_of(const scene::Mesh& mesh) {
    return {{"name", mesh.name},
            {"positions", numbers(mesh.positions)},
            {"normals", numbers(mesh.normals)},
            {"indices", mesh.indices},
            {"texture_coordinates", numbers(mesh.texture_coordinates)},
            {"tangents", numbers(mesh.tangents)},
            {"colours", numbers(mesh.colours)}};
}

scene::Mesh mesh_of(const Json& json) {
    scene::Mesh mesh;
    mesh.name = json.at("name").get<std::string>();
    mesh.positions = vectors<vec3>(json.at("positions"));
    mesh.normals = vectors<vec3>(json.at("normals"));
    mesh.indices = json.at("indices").get<std::vector<std::uint32_t>>();
    mesh.texture_coordinates = vectors<vec4>(json.at("texture_coordinates"));
    mesh.tangents = vectors<vec4>(json.at("tangents"));
    mesh.colours = vectors<vec4>(json.at("colours"));
    return mesh;
}

Json json_of(const ecs::PoolBase& pool, const void* value) {
    Json json = Json::object();
    for (const Field& field : pool.description()->fields)
        json[std::string(field.name)] = field_to_text(field, value);
    return json;
}

// The lines beyond the base, until `visit` says no, or one cannot be read: false then. The last one may have been cut
// off where the program ended.
template <typename Visit>
bool for_each_edit(const std::string& text, const JournalBase& base, const Visit& visit) {
    for (std::size_t begin = 0; begin < text.size();) {
        const std::size_t end = text.find('\n', begin);
        if (end == std::string::npos)
            return false;
        const Json json =
            Json::parse(text.begin() + std::ptrdiff_t(begin), text.begin() + std::ptrdiff_t(end), nullptr, false);
        begin = end + 1;
        if (!json.is_object())
            return false;
        if (json.value("epoch", std::uint64_t(0)) != base.epoch ||
            json.value("revision", std::uint64_t(0)) <= base.revision)
            continue;
        if (!visit(json))
            return false;
    }
    return true;
}

// Makes the edits of a journal in a document with other handles and numbers.
class Player {
public:
    Player(Document& document, const JournalBase& base) : document_(document) {
        const ecs::PoolBase& meshes = pool_of<scene::MeshInstance>(document);
        for (const auto& [name, known] : base.entities) {
            const Entity entity = document.find(name);
            if (!document.exists(entity)) {
                missing_.insert(known.handle); // the file is another one now
                continue;
            }
            entities_[known.handle] = entity;
            if (known.mesh >= 0 && meshes.contains(entity))
                meshes_[std::uint32_t(known.mesh)] = document.registry().get<scene::MeshInstance>(entity).mesh;
        }
    }

    // False: it refers to something that is not known.
    bool play(const Json& edit) {
        for (const Json& mesh : edit.at("meshes"))
            meshes_[mesh.at(0).get<std::uint32_t>()] = document_.add_mesh(mesh_of(mesh.at(1)));
        document_.begin(edit.at("name").get<std::string>());
        bool understood = true;
        for (const Json& one : edit.at("set"))
            understood = understood && set(one);
        gi::Settings settings = document_.settings();
        for (const auto& [name, value] : edit.at("settings").items())
            understood = understood && bool(settings.set(name, value.get<std::string>()));
        if (understood && !edit.at("settings").empty())
            understood = bool(document_.set_settings(settings));
        if (understood)
            document_.commit();
        else
            document_.cancel();
        return understood;
    }

private:
    bool set(const Json& one) {
        const auto handle = one.at(0).get<EntityBits>();
        ecs::PoolBase* pool = find_component(document_, one.at(1).get<std::string>());
        if (pool == nullptr || missing_.count(handle) > 0)
            return false;
        const auto [known, is_new] = entities_.try_emplace(handle);
        if (is_new)
            known->second = document_.create();
        if (one.at(2).is_null())
            return take_away(known->second, *pool);
        const std::shared_ptr<void> value = pool->default_value();
        for (const Field& field : pool->description()->fields)
            if (!set_field_of(field, value.get(), one.at(2).at(std::string(field.name)).get<std::string>()))
                return false;
        if (pool == &pool_of<scene::MeshInstance>(document_)) {
            auto& instance = *static_cast<scene::MeshInstance*>(value.get());
            const auto mesh = meshes_.find(instance.mesh);
            if (mesh == meshes_.end())
                return false;
            instance.mesh = mesh->second;
        }
        document_.set(known->second, *pool, value);
        return true;
    }

    // With its name goes everything, described or not.
    bool take_away(Entity entity, ecs::PoolBase& pool) {
        if (&pool != &pool_of<scene::Name>(document_)) {
            if (pool.contains(entity))
                document_.set(entity, pool, nullptr);
            return true;
        }
        for (ecs::PoolBase* each : document_.registry().all_pools())
            if (each->contains(entity) && each->is_copyable() && !each->is_derived())
                document_.set(entity, *each, nullptr);
        return true;
    }

    bool set_field_of(const Field& field, void* value, const std::string& text) {
        if (!field_from_text(field, value, text))
            return false;
        if (field.kind != FieldKind::entity)
            return true;
        auto* target = reinterpret_cast<Entity*>(static_cast<char*>(value) + field.offset);
        if (target->is_null())
            return true;
        if (missing_.count(target->bits()) > 0)
            return false;
        const auto [known, is_new] = entities_.try_emplace(target->bits());
        if (is_new)
            known->second = document_.create();
        *target = known->second;
        return true;
    }

    Document& document_;
    std::unordered_map<EntityBits, Entity> entities_;
    std::unordered_set<EntityBits> missing_; // which the base has, and the document has not
    std::unordered_map<std::uint32_t, std::uint32_t> meshes_;
};

} // namespace

JournalBase JournalBase::of(ecs::Registry& registry) {
    JournalBase base;
    registry.view<scene::Name>().each([&](Entity entity, const scene::Name& name) {
        const auto* instance = registry.try_get<scene::MeshInstance>(entity);
        base.entities[name.name] = {entity.bits(), instance != nullptr ? std::int64_t(instance->mesh) : -1};
    });
    return base;
}

std::string JournalBase::text() const {
    Json json = {{"epoch", epoch}, {"revision", revision}, {"entities", Json::object()}};
    for (const auto& [name, known] : entities)
        json["entities"][name] = {known.handle, known.mesh};
    return line_of(json) + "\n";
}

Result<JournalBase> JournalBase::from_text(const std::string& text) {
    const Json json = Json::parse(text, nullptr, false);
    JournalBase base;
    try {
        base.epoch = json.at("epoch").get<std::uint64_t>();
        base.revision = json.at("revision").get<std::uint64_t>();
        for (const auto& [name, known] : json.at("entities").items())
            base.entities[name] = {known.at(0).get<EntityBits>(), known.at(1).get<std::int64_t>()};
    } catch (const Json::exception&) {
        return Error{"the names that a journal of edits goes on from are damaged"};
    }
    return base;
}

JournalWriter::~JournalWriter() {
    if (file_ >= 0)
        ::close(file_);
}

Status JournalWriter::create(const std::filesystem::path& path) {
    file_ = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_APPEND | O_CLOEXEC | O_NOFOLLOW, 0600);
    path_ = path;
    bytes_ = 0;
    has_remains_ = false;
    return file_ >= 0 ? Status() : Status(Error{"cannot write '" + path.string() + "': " + std::strerror(errno)});
}

void JournalWriter::start_over(const gi::Settings& settings, std::uint32_t meshes) {
    updates_.clear();
    places_.clear();
    settings_.clear();
    meshes_.clear();
    known_settings_ = settings;
    mesh_count_ = meshes;
    complete_ = true;
}

void JournalWriter::note(std::span<const Update> updates, const std::optional<gi::Settings>& settings,
                         std::span<const scene::Mesh> meshes) {
    for (const Update& update : updates) {
        const auto [place, is_new] = places_.try_emplace({update.entity, update.pool->type_index}, updates_.size());
        if (is_new)
            updates_.push_back(update);
        else
            updates_[place->second] = update;
    }
    for (const scene::Mesh& mesh : meshes)
        meshes_.emplace_back(mesh_count_++, mesh);
    if (!settings)
        return;
    for (const std::string_view name : gi::Settings::names())
        if (!known_settings_ || known_settings_->get(name) != settings->get(name))
            settings_[std::string(name)] = settings->get(name);
    known_settings_ = settings;
}

Status JournalWriter::append(std::uint64_t epoch, std::uint64_t revision, const std::string& name) {
    Json json = {{"epoch", epoch},        {"revision", revision},    {"name", name},         {"set", Json::array()},
                 {"settings", settings_}, {"meshes", Json::array()}, {"complete", complete_}};
    std::unordered_set<Entity> gone;
    for (const Update& update : updates_)
        if (update.value == nullptr && update.pool->description() == &scene::Name::description())
            gone.insert(update.entity);
    for (const Update& update : updates_) {
        if (update.pool->description() == nullptr) {
            if (gone.count(update.entity) == 0)
                json["complete"] = false;
            continue;
        }
        json["set"].push_back({update.entity.bits(), std::string(update.pool->description()->name),
                               update.value == nullptr ? Json() : json_of(*update.pool, update.value.get())});
    }
    for (const auto& [index, mesh] : meshes_)
        json["meshes"].push_back({index, json_of(mesh)});
    start_over(known_settings_.value_or(gi::Settings()), mesh_count_);
    const std::string line = line_of(json) + "\n";
    if (file_ < 0)
        return {};
    // A crash leaves all of it or a part without its end, which readers leave out. What an edit says is not flushed to
    // disk, which may take as long as a frame: should the machine itself stop, the edits since the last copy are lost.
    Status written = cut_off_remains();
    if (written)
        written = write_all(file_, line, path_);
    if (written) {
        bytes_ += off_t(line.size());
        return {};
    }
    // This edit is missing then: readers have to stop here.
    complete_ = false;
    has_remains_ = true;
    static_cast<void>(cut_off_remains()); // else before the next edit
    return Error{"an edit could not be kept for a crash: " + written.error().message};
}

Status JournalWriter::cut_off_remains() {
    if (!has_remains_)
        return {};
    if (::ftruncate(file_, bytes_) != 0)
        return Error{"cannot write '" + path_.string() + "': " + std::strerror(errno)};
    has_remains_ = false;
    return {};
}

Replayed edits_of_journal(const std::string& text, const JournalBase& base) {
    Replayed result;
    result.complete = for_each_edit(text, base, [&](const Json& edit) {
        const bool complete = edit.value("complete", false);
        if (complete)
            result.names.push_back(edit.value("name", std::string()));
        return complete;
    });
    return result;
}

Replayed replay(Document& document, const std::string& text, const JournalBase& base) {
    Replayed result;
    Player player(document, base);
    result.complete = for_each_edit(text, base, [&](const Json& edit) {
        try {
            if (!edit.at("complete").get<bool>() || !player.play(edit))
                return false;
            result.names.push_back(edit.at("name").get<std::string>());
            return true;
        } catch (const Json::exception&) {
            document.cancel();
            return false;
        }
    });
    document.select({});
    return result;
}

} // namespace sunfleck::editor
