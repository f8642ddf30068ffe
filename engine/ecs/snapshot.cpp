#include "engine/ecs/snapshot.h"

#include "engine/core/random.h"

#include <cstring>

namespace sunfleck::ecs {
namespace {

constexpr std::uint32_t magic = 0x31534653; // "SFS1"

std::uint32_t checksum(std::string_view bytes) {
    std::uint32_t hash = 0x811c9dc5u;
    for (const char byte : bytes)
        hash = (hash ^ std::uint8_t(byte)) * 0x01000193u;
    return hash;
}

class Writer {
public:
    void number(std::uint64_t value) { bytes.append(reinterpret_cast<const char*>(&value), sizeof value); }
    void text(std::string_view value) {
        number(value.size());
        bytes.append(value);
    }
    std::string bytes;
};

class Reader {
public:
    explicit Reader(std::string_view bytes) : bytes_(bytes) {}
    bool good() const { return good_; }
    bool at_end() const { return bytes_.empty(); }
    std::uint64_t number() {
        std::uint64_t value = 0;
        if (bytes_.size() < sizeof value) {
            good_ = false;
            return 0;
        }
        std::memcpy(&value, bytes_.data(), sizeof value);
        bytes_.remove_prefix(sizeof value);
        return value;
    }
    std::string_view text() {
        const std::uint64_t size = number();
        if (!good_ || bytes_.size() < size) {
            good_ = false;
            return {};
        }
        const std::string_view value = bytes_.substr(0, size);
        bytes_.remove_prefix(size);
        return value;
    }

private:
    std::string_view bytes_;
    bool good_ = true;
};

std::size_t field_size(FieldKind kind) {
    switch (kind) {
    case FieldKind::boolean:
        return sizeof(bool);
    case FieldKind::vector3:
        return sizeof(vec3);
    case FieldKind::quaternion:
        return sizeof(quat);
    case FieldKind::entity:
        return sizeof(EntityBits);
    case FieldKind::text:
        return 0;
    default:
        return 4;
    }
}

void save_field(Writer& writer, const Field& field, const void* object) {
    const char* address = static_cast<const char*>(object) + field.offset;
    if (field.kind == FieldKind::text)
        writer.text(*reinterpret_cast<const std::string*>(address));
    else
        writer.text({address, field_size(field.kind)});
}

bool load_field(const Field& field, void* object, std::string_view stored, const EntityMap& map) {
    char* address = static_cast<char*>(object) + field.offset;
    if (field.kind == FieldKind::text) {
        *reinterpret_cast<std::string*>(address) = std::string(stored);
        return true;
    }
    if (stored.size() != field_size(field.kind))
        return false;
    std::memcpy(address, stored.data(), stored.size());
    if (field.kind == FieldKind::entity) {
        Entity& entity = *reinterpret_cast<Entity*>(address);
        const auto found = map.find(entity.bits());
        entity = found == map.end() ? null_entity : found->second;
    }
    return true;
}

PoolBase* find_described(Registry& registry, std::string_view name) {
    for (PoolBase* pool : registry.described_pools())
        if (pool->description()->name == name)
            return pool;
    return nullptr;
}

Status restore_pool(Registry& registry, Reader& reader, const EntityMap& map) {
    const std::string_view name = reader.text();
    PoolBase* pool = find_described(registry, name);
    if (pool == nullptr)
        return Error{"snapshot: unknown component '" + std::string(name) + "'"};
    const TypeDescription& type = *pool->description();
    if (reader.number() != type.version)
        return Error{"snapshot: '" + std::string(name) + "' was saved by another version of this component"};
    std::vector<const Field*> fields;
    for (std::uint64_t left = reader.number(); left > 0 && reader.good(); --left) {
        const std::string_view field_name = reader.text();
        fields.push_back(type.find(field_name));
        if (fields.back() == nullptr)
            return Error{"snapshot: '" + std::string(name) + "' has no field '" + std::string(field_name) + "'"};
    }
    for (std::uint64_t left = reader.number(); left > 0 && reader.good(); --left) {
        const auto found = map.find(reader.number());
        if (found == map.end() || pool->contains(found->second))
            return Error{"snapshot: damaged (component of an unknown entity)"};
        void* object = registry.emplace_default(*pool, found->second);
        for (const Field* field : fields)
            if (!load_field(*field, object, reader.text(), map))
                return Error{"snapshot: damaged (field '" + std::string(field->name) + "')"};
        registry.finish_default(*pool, found->second);
    }
    return reader.good() ? Status() : Status(Error{"snapshot: ends too early"});
}

} // namespace

std::string save_snapshot(Registry& registry) {
    Writer writer;
    const std::vector<Entity> entities = registry.entities();
    writer.number(entities.size());
    for (const Entity entity : entities)
        writer.number(entity.bits());
    const std::vector<PoolBase*> pools = registry.described_pools();
    writer.number(pools.size());
    for (const PoolBase* pool : pools) {
        const TypeDescription& type = *pool->description();
        writer.text(type.name);
        writer.number(type.version);
        writer.number(type.fields.size());
        for (const Field& field : type.fields)
            writer.text(field.name);
        writer.number(pool->size());
        for (std::size_t i = 0; i < pool->size(); ++i) {
            writer.number(pool->entities()[i].bits());
            for (const Field& field : type.fields)
                save_field(writer, field, pool->address(i));
        }
    }
    Writer head;
    head.number((std::uint64_t(checksum(writer.bytes)) << 32) | magic);
    return head.bytes + writer.bytes;
}

Result<EntityMap> restore_snapshot(Registry& registry, std::string_view bytes) {
    Reader reader(bytes);
    const std::uint64_t head = reader.number();
    if (!reader.good() || std::uint32_t(head) != magic || std::uint32_t(head >> 32) != checksum(bytes.substr(8)))
        return Error{"snapshot: not a snapshot, or damaged"};
    EntityMap map;
    std::vector<Entity> created;
    for (std::uint64_t left = reader.number(); left > 0 && reader.good(); --left) {
        created.push_back(registry.create());
        map.emplace(reader.number(), created.back());
    }
    Status status;
    for (std::uint64_t left = reader.number(); left > 0 && reader.good() && status; --left)
        status = restore_pool(registry, reader, map);
    if (status && (!reader.good() || !reader.at_end()))
        status = Error{"snapshot: ends too early"};
    if (!status) {
        for (const Entity entity : created)
            registry.destroy(entity);
        return status.error();
    }
    return map;
}

} // namespace sunfleck::ecs
