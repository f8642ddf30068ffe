#include "game_demo/game/saved_game.h"

#include "engine/core/hash.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <unordered_map>

namespace sunfleck::demo {
namespace {

using Json = nlohmann::json;
using Names = std::unordered_map<std::string, ecs::Entity>;

constexpr int version = 2; // 1 did not say what the level held

Json of(vec3 v) {
    return Json::array({v.x, v.y, v.z});
}
vec3 vector_in(const Json& json) {
    return {json.at(0).get<float>(), json.at(1).get<float>(), json.at(2).get<float>()};
}

Json of(const quat& q) {
    return Json::array({q.x, q.y, q.z, q.w});
}
quat rotation_in(const Json& q) {
    return {q.at(3).get<float>(), q.at(0).get<float>(), q.at(1).get<float>(), q.at(2).get<float>()};
}

// Names of files may have bytes that JSON cannot hold.
std::string text_of(const Json& json, int indent = -1) {
    return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

std::string checksum(const std::string& text) {
    return hash_text(hash_bytes(hash_start, text.data(), text.size()));
}

std::string name_of(const ecs::Registry& registry, ecs::Entity entity) {
    const auto* name = entity.is_null() ? nullptr : registry.try_get<scene::Name>(entity);
    return name != nullptr ? name->name : std::string();
}

Json of(const simulation::CharacterState& s) {
    return {{"foot", of(s.foot)}, {"velocity", of(s.velocity)}, {"safe", of(s.safe)},   {"height", s.height},
            {"yaw", s.yaw},       {"pitch", s.pitch},           {"falling", s.falling}, {"eye_lag", s.eye_lag},
            {"falls", s.falls},   {"grounded", s.grounded}};
}

simulation::CharacterState person_in(const Json& json) {
    simulation::CharacterState s;
    s.foot = vector_in(json.at("foot"));
    s.velocity = vector_in(json.at("velocity"));
    s.safe = vector_in(json.at("safe"));
    s.height = json.at("height").get<float>();
    s.yaw = json.at("yaw").get<float>();
    s.pitch = json.at("pitch").get<float>();
    s.falling = json.at("falling").get<float>();
    s.eye_lag = json.at("eye_lag").get<float>();
    s.falls = json.at("falls").get<std::uint32_t>();
    s.grounded = json.at("grounded").get<bool>();
    return s;
}

// What of an entity a game may change; null if nothing is.
Json of(const ecs::Registry& registry, ecs::Entity entity) {
    Json json;
    if (registry.has<scene::Mover>(entity) && registry.has<scene::Transform>(entity)) {
        const auto& t = registry.get<scene::Transform>(entity);
        json["position"] = of(t.position);
        json["rotation"] = of(t.rotation);
    }
    if (const auto* state = registry.try_get<scene::MoverState>(entity))
        json["progress"] = {{"at", state->progress}, {"open", state->open}};
    if (const auto* lamps = registry.try_get<scene::LightSwitch>(entity))
        json["on"] = lamps->on;
    if (const auto* reading = registry.try_get<scene::SensorReading>(entity))
        json["reading"] = {{"light", of(reading->irradiance)}, {"share", reading->share}, {"open", reading->open}};
    return json;
}

// Throws where the level's entity is not what it was.
template <typename T>
void expect(const ecs::Registry& registry, ecs::Entity entity) {
    if (!registry.has<T>(entity))
        throw std::runtime_error("'" + name_of(registry, entity) + "' has no " + std::string(T::description().name));
}

void apply(ecs::Registry& registry, ecs::Entity entity, const Json& json) {
    if (json.contains("position") || json.contains("progress"))
        expect<scene::Mover>(registry, entity);
    if (json.contains("position")) {
        expect<scene::Transform>(registry, entity);
        scene::Transform t = registry.get<scene::Transform>(entity);
        t.position = vector_in(json.at("position"));
        t.rotation = rotation_in(json.at("rotation"));
        registry.update<scene::Transform>(entity, t);
    }
    if (json.contains("progress"))
        registry.emplace_or_replace<scene::MoverState>(
            entity, {json["progress"].at("at").get<float>(), json["progress"].at("open").get<bool>()});
    if (json.contains("on")) {
        expect<scene::LightSwitch>(registry, entity);
        registry.patch<scene::LightSwitch>(entity, [&](scene::LightSwitch& s) { s.on = json["on"].get<bool>(); });
    }
    if (json.contains("reading")) {
        expect<scene::LightSensor>(registry, entity);
        registry.emplace_or_replace<scene::SensorReading>(entity, {vector_in(json["reading"].at("light")),
                                                                   json["reading"].at("share").get<float>(),
                                                                   json["reading"].at("open").get<bool>()});
    }
    if (auto* lantern = registry.try_get<scene::Lantern>(entity); lantern != nullptr && lantern->carried)
        registry.patch<scene::Lantern>(entity, [](scene::Lantern& state) { state.carried = false; });
}

Names names_of(const ecs::Registry& registry) {
    Names names;
    for (const ecs::Entity entity : registry.entities())
        if (const std::string name = name_of(registry, entity); !name.empty())
            names.emplace(name, entity);
    return names;
}

ecs::Entity found(const Names& names, const Json& name) {
    const auto place = names.find(name.get<std::string>());
    return place != names.end() ? place->second : ecs::null_entity;
}

// The world's part of a text that is whole and of this level.
Result<Json> checked(const GameWorld& world, const std::string& level, const std::string& text) {
    const Json json = Json::parse(text, nullptr, false);
    if (!json.is_object() || !json.contains("sunfleck_game") || !json["sunfleck_game"].is_number_integer())
        return Error{"it is not a saved game"};
    if (json["sunfleck_game"].get<int>() > version)
        return Error{"it was saved by a later version of the game"};
    if (json["sunfleck_game"].get<int>() < version)
        return Error{"it was saved by an earlier version of the game"};
    if (!json.contains("world") || json.value("checksum", Json()) != Json(checksum(json["world"].dump())))
        return Error{"it is damaged: its checksum is wrong"};
    if (text_of(json.value("level", Json())) != text_of(level))
        return Error{"it is of another level than '" + level + "'"};
    if (json.value("contents", Json()) != Json(world.contents()))
        return Error{"the level has been changed since"};
    return json["world"];
}

// Throws Json::exception where a field is missing or of another kind.
void apply_world(GameWorld& world, const Names& names, const Json& json) {
    ecs::Registry& registry = world.registry();
    for (const auto& [name, entity] : json.at("entities").items())
        apply(registry, names.at(name), entity);
    simulation::SimulationState state;
    state.steps = json.at("steps").get<std::uint64_t>();
    state.held_buttons = json.at("buttons").get<std::uint32_t>();
    state.person = person_in(json.at("person"));
    state.carried = found(names, json.at("carried"));
    for (const Json& lantern : json.at("standing"))
        state.standing.push_back({found(names, lantern.at("lantern")), found(names, lantern.at("on")),
                                  vector_in(lantern.at("place")), rotation_in(lantern.at("rotation"))});
    if (!state.carried.is_null()) {
        expect<scene::Lantern>(registry, state.carried);
        registry.patch<scene::Lantern>(state.carried, [](scene::Lantern& lantern) { lantern.carried = true; });
    }
    world.simulation().restore(registry, state);
    GameWorld::Progress progress{
        found(names, json.at("area")), json.at("finished").get<bool>(), {}, found(names, json.at("lantern"))};
    for (const Json& sensor : json.at("opened"))
        progress.opened.push_back(found(names, sensor));
    world.restore(progress);
}

} // namespace

std::function<std::string()> keep_game(const GameWorld& world, const std::string& level) {
    const ecs::Registry& registry = world.registry();
    const simulation::SimulationState state = world.simulation().state();
    const GameWorld::Progress progress = world.progress();
    Json json = {{"steps", state.steps},
                 {"buttons", state.held_buttons},
                 {"person", of(state.person)},
                 {"carried", name_of(registry, state.carried)},
                 {"lantern", name_of(registry, progress.lantern)},
                 {"area", name_of(registry, progress.area)},
                 {"finished", progress.finished},
                 {"opened", Json::array()},
                 {"standing", Json::array()},
                 {"entities", Json::object()}};
    for (const ecs::Entity sensor : progress.opened)
        json["opened"].push_back(name_of(registry, sensor));
    for (const simulation::Standing& standing : state.standing)
        json["standing"].push_back({{"lantern", name_of(registry, standing.lantern)},
                                    {"on", name_of(registry, standing.ground)},
                                    {"place", of(standing.place)},
                                    {"rotation", of(standing.rotation)}});
    for (const auto& [name, entity] : names_of(registry))
        if (Json content = of(registry, entity); !content.is_null())
            json["entities"][name] = std::move(content);
    return [json = std::move(json), level, contents = world.contents()] {
        const Json file = {{"sunfleck_game", version},
                           {"level", level},
                           {"contents", contents},
                           {"checksum", checksum(json.dump())},
                           {"world", json}};
        return text_of(file, 1) + "\n";
    };
}

std::string save_game(const GameWorld& world, const std::string& level) {
    return keep_game(world, level)();
}

std::string on_one_line(std::string saved) {
    std::replace(saved.begin(), saved.end(), '\n', ' ');
    return saved;
}

Status load_game(GameWorld& world, const std::string& level, const std::string& text) {
    SUNFLECK_ASSIGN(const Json json, checked(world, level, text));
    const Names names = names_of(world.registry());
    if (json.contains("entities"))
        for (const auto& [name, content] : json["entities"].items())
            if (names.find(name) == names.end())
                return Error{"the level has no '" + name + "' any more"};
    try {
        apply_world(world, names, json);
    } catch (const std::exception& error) {
        return Error{std::string("it cannot be read: ") + error.what()};
    }
    return {};
}

} // namespace sunfleck::demo
