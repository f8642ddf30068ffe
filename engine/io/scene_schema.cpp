// The JSON schema of scene files.
#include "engine/io/scene_components.h"
#include "engine/io/scene_file.h"

#include <nlohmann/json.hpp>

namespace sunfleck::io {
namespace {

using nlohmann::json;

json field_schema(const Field& field) {
    json schema = {
        {"description", std::string(field.tooltip) + (field.unit.empty() ? "" : ", " + std::string(field.unit))}};
    const json number = {{"type", "number"}, {"minimum", field.minimum}, {"maximum", field.maximum}};
    const auto list_of = [&](int count) {
        return json{{"type", "array"}, {"items", number}, {"minItems", count}, {"maxItems", count}};
    };
    switch (field.kind) {
    case FieldKind::boolean:
        schema["type"] = "boolean";
        break;
    case FieldKind::text:
        schema["type"] = "string";
        break;
    case FieldKind::choice:
        schema["enum"] = field.choices;
        break;
    case FieldKind::vector3:
        schema.update(list_of(3));
        break;
    case FieldKind::quaternion:
        schema.update(list_of(4));
        break;
    case FieldKind::integer:
    case FieldKind::unsigned_integer:
        schema.update(number);
        schema["type"] = "integer";
        break;
    default:
        schema.update(number);
    }
    return schema;
}

// Of an entity: its components and their fields.
json entity_schema() {
    json entity = {{"type", "object"}, {"additionalProperties", false}, {"properties", json::object()}};
    for (const auto* list : {&saved_components(), &overridden_components()})
        for (const ComponentAccess& access : *list) {
            json component = {{"type", {"object", "null"}}, // null: it has none, whatever the glTF file says
                              {"description", access.type.tooltip},
                              {"additionalProperties", false},
                              {"properties", json::object()}};
            for (const Field& field : access.type.fields)
                component["properties"][std::string(field.name)] = field_schema(field);
            entity["properties"][std::string(access.type.name)] = component;
        }
    return entity;
}

} // namespace

std::string scene_file_schema() {
    const json schema = {
        {"$schema", "https://json-schema.org/draft/2020-12/schema"},
        {"title", "Sunfleck scene file"},
        {"type", "object"},
        {"required", {"sunfleck_scene", "gltf"}},
        {"properties",
         {{"sunfleck_scene",
           {{"description", "Version"}, {"type", "integer"}, {"minimum", 1}, {"maximum", scene_file_version}}},
          {"gltf", {{"description", "glTF file, relative to this one"}, {"type", "string"}}},
          {"gltf_checksum",
           {{"description", "FNV-1a of that file; omit it if the file may change"}, {"type", "string"}}},
          {"checksum",
           {{"description", "FNV-1a of this file without this line; omit it when editing by hand"},
            {"type", "string"}}},
          {"default_light",
           {{"description", "Whether a sky and a sun are added where the scene has no lights; usually true"},
            {"type", "boolean"}}},
          {"source",
           {{"description", "What the editor remembers of the glTF file that the scene came from, to take over what is "
                            "new in it when it has been exported again"},
            {"type", "object"}}},
          {"settings", {{"description", "Lighting settings by name, as sunfleck info lists them"}, {"type", "object"}}},
          {"entities",
           {{"description",
             "Components by entity name; a name that is not a node of the glTF file creates a new entity"},
            {"type", "object"},
            {"additionalProperties", entity_schema()}}}}}};
    return schema.dump(2) + "\n";
}

} // namespace sunfleck::io
