#include "editor/document/source_link.h"

#include "editor/document/content_hash.h"
#include "engine/io/file_access.h"

#include <cstring>
#include <nlohmann/json.hpp>

namespace sunfleck::editor {
namespace {

using LinkJson = nlohmann::json;
constexpr const char *mesh_key = "mesh", *textures_key = "textures", *name_key = "entity";

template <typename T>
std::uint64_t hash_list(std::uint64_t hash, const std::vector<T>& values) {
    const std::uint64_t size = values.size();
    return hash_words(hash_words(hash, &size, sizeof size), values.data(), values.size() * sizeof(T));
}

std::string hash_of(const scene::Mesh& mesh) {
    std::uint64_t hash = hash_list(hash_start, mesh.positions);
    hash = hash_list(hash_list(hash, mesh.normals), mesh.indices);
    return hash_text(hash_list(hash_list(hash_list(hash, mesh.texture_coordinates), mesh.tangents), mesh.colours));
}

std::string hash_of(const scene::Texture& texture) {
    const std::uint32_t kind[] = {texture.width,
                                  texture.height,
                                  texture.srgb ? 1u : 0u,
                                  std::uint32_t(texture.wrap_u),
                                  std::uint32_t(texture.wrap_v),
                                  texture.nearest ? 1u : 0u};
    return hash_text(hash_list(hash_bytes(hash_start, kind, sizeof kind), texture.pixels));
}

// The hash of each element of a store, worked out when it is asked for.
template <typename Store>
class StoreHashes {
public:
    // `known`: those that were worked out before.
    StoreHashes(const Store& store, std::vector<std::string>& known) : store_(store), hashes_(known) {
        hashes_.resize(store.size());
    }

    const std::string& operator[](std::uint32_t index) {
        if (hashes_[index].empty())
            hashes_[index] = hash_of(store_[index]);
        return hashes_[index];
    }
    bool has(std::uint32_t index) const { return index < hashes_.size(); }
    // The element of that hash, `preferred` if it is one; -1: there is none.
    std::int64_t find(const std::string& hash, std::int64_t preferred) {
        if (preferred >= 0 && has(std::uint32_t(preferred)) && (*this)[std::uint32_t(preferred)] == hash)
            return preferred;
        for (std::uint32_t i = 0; i < hashes_.size(); ++i)
            if ((*this)[i] == hash)
                return i;
        return -1;
    }

private:
    const Store& store_;
    std::vector<std::string>& hashes_;
};

constexpr scene::TextureUse scene::MaterialTextures::*texture_uses[] = {
    &scene::MaterialTextures::base_colour, &scene::MaterialTextures::metallic_roughness,
    &scene::MaterialTextures::normal, &scene::MaterialTextures::emission, &scene::MaterialTextures::transmission};

bool is_textures(const ecs::PoolBase& pool) {
    return dynamic_cast<const ecs::Pool<scene::MaterialTextures>*>(&pool) != nullptr;
}

// --- Writing --------------------------------------------------------------------------------------------------------

class LinkWriter {
public:
    LinkWriter(const FileContent& content, Document& document, ContentHashes& hashes)
        : document_(document), meshes_(document.meshes(), hashes.meshes),
          textures_(document.textures(), hashes.textures) {
        for (const auto& [name, node] : content.nodes())
            names_[node.entity] = name;
    }

    LinkJson node(const FileContent::Node& node) {
        LinkJson json = LinkJson::object();
        if (document_.exists(node.entity))
            json[name_key] = document_.name(node.entity);
        for (const auto& [pool, value] : node.components) {
            if (pool->description() != nullptr)
                json[std::string(pool->description()->name)] = component(*pool, value.get());
            else if (is_textures(*pool))
                json[textures_key] = textures(*static_cast<const scene::MaterialTextures*>(value.get()));
            if (pool == &pool_of<scene::MeshInstance>(document_))
                if (const auto mesh = static_cast<const scene::MeshInstance*>(value.get())->mesh; meshes_.has(mesh))
                    json[mesh_key] = meshes_[mesh];
        }
        return json;
    }

private:
    LinkJson component(const ecs::PoolBase& pool, const void* value) {
        LinkJson json = LinkJson::object();
        for (const Field& field : pool.description()->fields) {
            LinkJson& text = json[std::string(field.name)];
            if (field.kind != FieldKind::entity) {
                text = field_to_text(field, value);
                continue;
            }
            const auto found =
                names_.find(*reinterpret_cast<const Entity*>(static_cast<const char*>(value) + field.offset));
            text = found != names_.end() ? found->second : std::string();
        }
        return json;
    }
    LinkJson textures(const scene::MaterialTextures& all) {
        LinkJson json = {all.normal_scale, all.emission_average.x, all.emission_average.y, all.emission_average.z};
        for (const auto use : texture_uses) {
            const scene::TextureUse& one = all.*use;
            const bool there = one.texture >= 0 && textures_.has(std::uint32_t(one.texture));
            json.push_back({there ? textures_[std::uint32_t(one.texture)] : std::string(), one.set, one.offset.x,
                            one.offset.y, one.scale.x, one.scale.y, one.rotation});
        }
        return json;
    }

    Document& document_;
    StoreHashes<scene::MeshStore> meshes_;
    StoreHashes<scene::TextureStore> textures_;
    std::unordered_map<Entity, std::string> names_; // of nodes
};

// --- Reading --------------------------------------------------------------------------------------------------------

// Throws where the text is not one that LinkWriter has written.
class LinkReader {
public:
    LinkReader(Document& document, const LinkJson& nodes, ContentHashes& hashes)
        : document_(document), nodes_(nodes), meshes_(document.meshes(), hashes.meshes),
          textures_(document.textures(), hashes.textures) {
        for (const auto& [name, node] : nodes.items())
            if (node.contains(name_key))
                entities_[name] = document.find(node.at(name_key).get<std::string>());
    }

    FileContent content() {
        FileContent result;
        for (const auto& [name, json] : nodes_.items()) {
            FileContent::Node& node = result.nodes()[name];
            node.entity = entity(name);
            for (ecs::PoolBase* pool : document_.registry().all_pools())
                if (!pool->is_derived() && pool->is_copyable())
                    if (ecs::Value value = component(*pool, node.entity, json))
                        node.components.emplace_back(pool, std::move(value));
        }
        return result;
    }

private:
    // Null: it was deleted here.
    Entity entity(const std::string& node) const {
        const auto found = entities_.find(node);
        return found != entities_.end() ? found->second : ecs::null_entity;
    }
    template <typename T>
    const T* own(Entity entity) {
        return document_.exists(entity) ? document_.registry().try_get<T>(entity) : nullptr;
    }

    ecs::Value component(ecs::PoolBase& pool, Entity entity, const LinkJson& json) {
        if (pool.description() == nullptr) {
            if (!is_textures(pool)) // nobody edits these
                return document_.exists(entity) && pool.contains(entity) ? document_.registry().value(pool, entity)
                                                                         : nullptr;
            return json.contains(textures_key) ? textures(json.at(textures_key), entity) : nullptr;
        }
        const auto found = json.find(std::string(pool.description()->name));
        if (found == json.end())
            return nullptr;
        if (!found->is_object())
            throw std::runtime_error("a component is no object");
        std::shared_ptr<void> value = pool.default_value();
        for (const Field& field : pool.description()->fields) // one that came later is as it usually is
            if (const std::string name(field.name); found->contains(name))
                read(field, value.get(), found->at(name).get<std::string>());
        if (&pool == &pool_of<scene::MeshInstance>(document_) &&
            !find_mesh(json, own<scene::MeshInstance>(entity), *static_cast<scene::MeshInstance*>(value.get())))
            return nullptr;
        return value;
    }
    // False: geometry of the file that is no longer in the document, where there is other geometry now. A component
    // that the file did not have counts as an edit there, too.
    bool find_mesh(const LinkJson& json, const scene::MeshInstance* now, scene::MeshInstance& instance) {
        const std::int64_t found = json.contains(mesh_key) ? meshes_.find(json.at(mesh_key).get<std::string>(),
                                                                          now != nullptr ? std::int64_t(now->mesh) : -1)
                                                           : -1;
        instance.mesh = found >= 0 ? std::uint32_t(found) : 0;
        return found >= 0 || (now == nullptr && meshes_.has(0));
    }
    void read(const Field& field, void* value, const std::string& text) {
        if (field.kind == FieldKind::entity)
            *reinterpret_cast<Entity*>(static_cast<char*>(value) + field.offset) = entity(text);
        else if (const Status status = field_from_text(field, value, text); !status)
            throw std::runtime_error(status.error().message);
    }
    ecs::Value textures(const LinkJson& json, Entity entity) {
        auto value = std::make_shared<scene::MaterialTextures>();
        value->normal_scale = json.at(0).get<float>();
        for (int c = 0; c < 3; ++c)
            value->emission_average[c] = json.at(std::size_t(c) + 1).get<float>();
        const auto* now = own<scene::MaterialTextures>(entity);
        for (std::size_t i = 0; i < std::size(texture_uses); ++i) {
            const LinkJson& from = json.at(i + 4);
            scene::TextureUse& use = (*value).*texture_uses[i];
            const auto hash = from.at(0).get<std::string>();
            if (!hash.empty()) {
                const std::int64_t found = textures_.find(hash, now != nullptr ? (now->*texture_uses[i]).texture : -1);
                use.texture = found >= 0 ? std::int32_t(found) : std::numeric_limits<std::int32_t>::max(); // another
            }
            use.set = from.at(1).get<std::uint32_t>();
            use.offset = {from.at(2).get<float>(), from.at(3).get<float>()};
            use.scale = {from.at(4).get<float>(), from.at(5).get<float>()};
            use.rotation = from.at(6).get<float>();
        }
        return value;
    }

    Document& document_;
    const LinkJson& nodes_;
    StoreHashes<scene::MeshStore> meshes_;
    StoreHashes<scene::TextureStore> textures_;
    std::unordered_map<std::string, Entity> entities_; // by node
};

} // namespace

std::string text_of(const SourceLink& link, Document& document, const std::filesystem::path& folder,
                    ContentHashes& hashes) {
    const auto dump = [](const LinkJson& json) {
        return json.dump(-1, ' ', false, LinkJson::error_handler_t::replace);
    };
    LinkWriter writer(link.content, document, hashes);
    LinkJson nodes = LinkJson::object();
    for (const auto& [name, node] : link.content.nodes())
        nodes[name] = writer.node(node);
    std::error_code code;
    const std::filesystem::path from = std::filesystem::absolute(folder.empty() ? "." : folder, code);
    const std::filesystem::path file = std::filesystem::absolute(link.file, code);
    const std::filesystem::path relative = std::filesystem::proximate(file, from, code);
    LinkJson json = {{"file", (code || relative.empty() ? file : relative).generic_string()},
                     {"checksum", link.content.checksum()},
                     {"content", dump(nodes)}}; // as one line: there are as many as nodes
    if (link.stamp)
        json["stamp"] = {link.stamp->written.time_since_epoch().count(), link.stamp->bytes};
    return dump(json);
}

Result<SourceLink> source_link_of(Document& document, const std::string& text, const std::filesystem::path& folder,
                                  ContentHashes& hashes) {
    SourceLink link;
    try {
        const LinkJson json = LinkJson::parse(text);
        link.file = (folder / json.at("file").get<std::string>()).lexically_normal();
        const LinkJson nodes = LinkJson::parse(json.at("content").get<std::string>());
        if (!nodes.is_object())
            return Error{"what the scene says of the file that it came from is damaged"};
        link.content = LinkReader(document, nodes, hashes).content();
        link.content.set_checksum(json.at("checksum").get<std::string>());
        link.content.set_settings(viewer::usual_lighting()); // glTF says nothing of them
        if (const auto stamp = json.find("stamp"); stamp != json.end()) {
            using Time = std::filesystem::file_time_type;
            const Time::duration written(stamp->at(0).get<Time::duration::rep>());
            link.stamp = FileStamp{Time(written), stamp->at(1).get<std::uintmax_t>()};
        }
    } catch (const std::exception& problem) {
        return Error{std::string("what the scene says of the file that it came from is damaged: ") + problem.what()};
    }
    return link;
}

bool is_newer(const SourceLink& link, const std::filesystem::path& folder, bool trusted) {
    const std::optional<FileStamp> now = FileStamp::of(link.file);
    if (!now || now == link.stamp)
        return false;
    const io::FileAccess access{io::real_folder(folder / "scene"), trusted};
    std::error_code code;
    if (!access.check(link.file) || !std::filesystem::is_regular_file(link.file, code))
        return link.stamp.has_value();
    const std::string checksum = checksum_of_file(link.file);
    return !checksum.empty() && checksum != link.content.checksum();
}

} // namespace sunfleck::editor
