// Numbers that make no sense, one at a time, in each numeric field of glTF and of scene files: each file is refused
// with a message, or gives finite light (traced_files.h).
#include "engine/io/uri.h"
#include "gi_module/settings.h"
#include "tests/support/test_size.h"
#include "tests/support/traced_files.h"

#include <regex>
#include <set>

namespace sunfleck::tests {
namespace {

const std::vector<std::string> odd_numbers = {"NaN",   "Infinity", "-1e999", "1e39", "1e38", "-1e38",           "1e20",
                                              "-1e20", "1e-38",    "1e-320", "-0",   "-0.0", "9007199254740992"};
const std::vector<float> odd_floats = {NAN,    INFINITY, -INFINITY, 1e38f, -1e38f,  1e20f,
                                       -1e20f, 1e-38f,   1e-44f,    -0.0f, 0x1p53f, -0x1p53f};

// Which of a test's cases are tried. The short size tries each number with some of the values, each value at some of
// the numbers; of bench.sh's seeds, N stands for case N.
class Cases {
public:
    bool is_next_due(std::size_t number, std::size_t value) {
        ++at_;
        if (seeds_.given)
            return at_ >= seeds_.first && at_ <= seeds_.last;
        return long_size() || (number + value) % (sanitized() ? 12 : 3) == 0;
    }
    // All have a seed, and files whose numbers are all refused would test little.
    void judge(const FileCounts& counts, int right_share) const {
        EXPECT_LE(at_, 20000u);
        EXPECT_TRUE(counts.right * right_share > counts.tried || seeds_.given) << counts.right << " right";
        EXPECT_LT(FileCounts::most_megabytes(), 2000);
    }

private:
    Seeds seeds_ = seeds_to_try(0);
    std::size_t at_ = 0;
};

// "/nodes/3/scale/0" as "nodes[].scale[]"
std::string path_of(const std::string& pointer) {
    static const std::regex element("/[0-9]+"), step("/");
    return std::regex_replace(std::regex_replace(pointer, element, "[]"), step, ".").substr(1);
}

// The JSON's text, with `number` in place of what the pointer names.
std::string with_number(json file, const std::string& pointer, const std::string& number) {
    file[json::json_pointer(pointer)] = "@number@";
    std::string text = file.dump();
    return text.replace(text.find("\"@number@\""), 10, number);
}

// Calls visit(what, text) with the JSON in which one number after the other is one of the odd ones, as far as it is
// due. Only numbers below `part`, a JSON pointer. Returns the paths of all of them.
std::set<std::string>
replace_each_number(const json& file, const std::string& part, Cases& cases,
                    const std::function<void(const std::string& what, const std::string&)>& visit) {
    std::set<std::string> paths;
    std::size_t number = 0;
    const json flat = file.flatten();
    for (const auto& [pointer, value] : flat.items()) {
        if (!value.is_number() || pointer.compare(0, part.size(), part) != 0)
            continue;
        paths.insert(path_of(pointer));
        ++number;
        for (std::size_t i = 0; i < odd_numbers.size(); ++i)
            if (cases.is_next_due(number, i))
                visit(std::string(pointer).append(" = ").append(odd_numbers[i]),
                      with_number(file, pointer, odd_numbers[i]));
    }
    return paths;
}

json corpus_file(const std::string& name) {
    return json::parse(read_file(SUNFLECK_SOURCE_DIR "/tests/corpus/gltf/" + name).value());
}

TEST(RobustDamagedFiles, OddNumbersThatWereWrongOnce) {
    FileCounts counts;
    for (const auto& [pointer, number] :
         {std::pair("/cameras/1/orthographic/ymag", "1e38"), std::pair("/nodes/0/scale/2", "-1e38")})
        judge_bytes(counts, pointer, with_number(corpus_file("numbers.gltf"), pointer, number));
}

TEST(RobustDamagedFiles, OddNumbersInEachFieldOfGltf) {
    FileCounts counts;
    Cases cases;
    for (const std::string name : {"all.gltf", "square.gltf", "numbers.gltf"}) {
        const json file = corpus_file(name);
        ASSERT_TRUE(World().import(file.dump())) << name;
        replace_each_number(file, "", cases, [&](const std::string& what, const std::string& text) {
            judge_bytes(counts, name + " " + what, text);
        });
    }
    cases.judge(counts, 10);
}

// numbers.gltf, with its one buffer as the binary chunk.
GltfBuilder numbers_as_binary() {
    GltfBuilder result;
    result.file = corpus_file("numbers.gltf");
    const io::FileAccess nothing;
    result.binary = io::read_uri(result.file["buffers"][0]["uri"].get<std::string>(), {}, nothing).value();
    return result;
}

// Where values of floats lie: of accessors, and of what sparse ones put in their place. Compressed ones are left out:
// their bytes are no floats.
std::vector<std::size_t> first_floats(const json& file) {
    std::vector<std::size_t> places;
    const auto add = [&](const json& part) {
        const json& view = file["bufferViews"][part["bufferView"].get<std::size_t>()];
        if (!view.contains("extensions"))
            places.push_back(view.value("byteOffset", std::size_t(0)) + part.value("byteOffset", std::size_t(0)));
    };
    for (const json& accessor : file["accessors"]) {
        if (accessor["componentType"] != 5126)
            continue;
        if (accessor.contains("bufferView"))
            add(accessor);
        if (accessor.contains("sparse"))
            add(accessor["sparse"]["values"]);
    }
    return places;
}

TEST(RobustDamagedFiles, OddNumbersInEachAccessor) {
    FileCounts counts;
    Cases cases;
    const GltfBuilder file = numbers_as_binary();
    const std::vector<std::size_t> places = first_floats(file.file);
    EXPECT_GE(places.size(), 15u) << "of vertices, morph targets, weights, skins, animations and instances";
    for (std::size_t i = 0; i < places.size(); ++i)
        for (std::size_t component = 0; component < 2; ++component) // none of them is a single float
            for (std::size_t value = 0; value < odd_floats.size(); ++value) {
                if (!cases.is_next_due(i, value))
                    continue;
                GltfBuilder changed = file;
                const std::size_t at = places[i] + component * sizeof(float);
                std::memcpy(changed.binary.data() + at, &odd_floats[value], sizeof(float));
                judge_bytes(counts, "byte " + std::to_string(at) + " = " + std::to_string(odd_floats[value]),
                            changed.glb());
            }
    cases.judge(counts, 4);
}

// The importer's sources.
std::string importer() {
    std::string text;
    for (const auto& entry : std::filesystem::directory_iterator(SUNFLECK_SOURCE_DIR "/engine/io"))
        if (const std::string name = entry.path().filename().string();
            name.compare(0, 5, "gltf_") == 0 && name != "gltf_export.cpp")
            text += read_file(entry.path()).value();
    return text;
}

// The names of numbers that the importer's sources have as text: of extensions, of those whose type is checked, and of
// indices.
std::set<std::string> names_in_importer() {
    const std::string text = importer();
    std::set<std::string> names;
    for (const char* pattern : {R"re((?:number_of|pair_of)\([^"()]*"(\w+)")re", R"re(number\("(\w+)")re",
                                R"re(Get\("(\w+)"\)\.(?:IsNumber|GetNumber))re", R"re("(\w+)"\},\s*'[na]'\})re",
                                R"re("(\w+)"(?:, "\[\]")*\},\s*"\w+"\})re", R"re(read\("([A-Z]+)", TINYGLTF)re"}) {
        const std::regex one(pattern);
        for (std::sregex_iterator at(text.begin(), text.end(), one), end; at != end; ++at)
            names.insert((*at)[1]);
    }
    return names;
}

// What tinygltf reads of glTF for the importer, whose sources have these as members.
const std::vector<std::string> read_by_parser = {
    "scene",
    "scenes[].nodes[]",
    "accessors[].max[]",
    "accessors[].min[]",
    "accessors[].sparse.count",
    "accessors[].sparse.indices.byteOffset",
    "accessors[].sparse.indices.componentType",
    "accessors[].sparse.values.byteOffset",
    "animations[].channels[].sampler",
    "buffers[].byteLength",
    "cameras[].orthographic.xmag",
    "cameras[].orthographic.ymag",
    "cameras[].orthographic.zfar",
    "cameras[].orthographic.znear",
    "cameras[].perspective.aspectRatio",
    "cameras[].perspective.yfov",
    "cameras[].perspective.zfar",
    "cameras[].perspective.znear",
    "extensions.KHR_lights_punctual.lights[].color[]",
    "extensions.KHR_lights_punctual.lights[].intensity",
    "extensions.KHR_lights_punctual.lights[].range",
    "extensions.KHR_lights_punctual.lights[].spot.innerConeAngle",
    "extensions.KHR_lights_punctual.lights[].spot.outerConeAngle",
    "materials[].emissiveTexture.texCoord",
    "materials[].normalTexture.texCoord",
    "materials[].occlusionTexture.strength",
    "materials[].occlusionTexture.texCoord",
    "materials[].pbrMetallicRoughness.metallicRoughnessTexture.texCoord",
    "meshes[].primitives[].attributes.COLOR_0",
    "meshes[].primitives[].attributes.JOINTS_0",
    "meshes[].primitives[].attributes.NORMAL",
    "meshes[].primitives[].attributes.POSITION",
    "meshes[].primitives[].attributes.TANGENT",
    "meshes[].primitives[].attributes.TEXCOORD_0",
    "meshes[].primitives[].attributes.TEXCOORD_1",
    "meshes[].primitives[].attributes.WEIGHTS_0",
    "meshes[].primitives[].extensions.KHR_draco_mesh_compression.attributes.NORMAL",
    "meshes[].primitives[].extensions.KHR_draco_mesh_compression.attributes.POSITION",
    "meshes[].primitives[].targets[].NORMAL",
    "meshes[].primitives[].targets[].POSITION",
    "samplers[].magFilter",
    "samplers[].minFilter"};

TEST(RobustDamagedFiles, NumbersHasEachNumberThatTheImporterReads) {
    Cases cases;
    const std::set<std::string> paths = replace_each_number(corpus_file("numbers.gltf"), "", cases, [](auto&&...) {});
    std::set<std::string> names;
    const std::regex word("\\w+");
    for (const std::string& path : paths)
        for (std::sregex_iterator at(path.begin(), path.end(), word), end; at != end; ++at)
            names.insert(at->str());
    const std::set<std::string> wanted = names_in_importer();
    EXPECT_GE(wanted.size(), 40u) << "the sources are written in another way than the test looks for";
    for (const std::string& name : wanted)
        EXPECT_EQ(names.count(name), 1u) << name << " is no number of numbers.gltf";
    for (const std::string& path : read_by_parser)
        EXPECT_EQ(paths.count(path), 1u) << path << " is not in numbers.gltf";
    std::printf("%zu numeric fields\n", paths.size());
}

// Of each component that a scene file may have, as its schema describes it.
json components_schema() {
    return json::parse(io::scene_file_schema())["properties"]["entities"]["additionalProperties"]["properties"];
}

bool is_numeric(const json& field) {
    return field["type"] == "number" || field["type"] == "integer" || field["type"] == "array";
}

// In the range, and usual.
json value_of(const std::string& name, const json& field) {
    static const std::map<std::string, std::string> texts = {
        {"file", "summer_sky"}, {"lamps", "lamp"}, {"opens", "door"}, {"shows", "door"}};
    if (field.contains("enum"))
        return field["enum"][0];
    if (field["type"] == "boolean")
        return false;
    if (field["type"] == "string")
        return texts.count(name) > 0 ? texts.at(name) : name;
    if (field["type"] == "array" && field["minItems"] == 4)
        return {0, 0, 0, 1};
    const json& number = field["type"] == "array" ? field["items"] : field;
    const double usual = std::clamp(field["type"] == "integer" ? 3.0 : 0.6, number["minimum"].get<double>(),
                                    number["maximum"].get<double>());
    const json value = field["type"] == "integer" ? json(int(usual)) : json(usual);
    return field["type"] == "array" ? json{value, value, value} : value;
}

// The component with all of its fields; then, for each choice and for each switch, once more with that: they decide
// which of the numbers matter.
std::vector<json> variants_of(const json& component) {
    json usual = json::object();
    for (const auto& [name, field] : component["properties"].items())
        usual[name] = value_of(name, field);
    std::vector<json> variants = {usual};
    for (const auto& [name, field] : component["properties"].items()) {
        json changed = usual;
        for (std::size_t i = 1; field.contains("enum") && i < field["enum"].size(); ++i) {
            changed[name] = field["enum"][i];
            variants.push_back(changed);
        }
        if (field.value("type", json()) == "boolean") {
            changed[name] = true;
            variants.push_back(changed);
        }
    }
    return variants;
}

// A floor, a thing, a door and, in the scene file, a lamp. Beside its component the thing has what that is of use with.
json scene_with(const std::string& component, const json& fields) {
    static const std::map<std::string, json> companions = {
        {"SplinePath", {{"Mover", {{"path", "spline"}}}}},
        {"Mover", {{"SplinePath", {{"point_2", {1, 0, 0}}}}}},
        {"RigidBody", {{"Mover", {{"path", "none"}}}}},
        {"EnvironmentMap", {{"Environment", {{"radiance", {1, 1, 1}}}}}}};
    json thing = companions.count(component) > 0 ? companions.at(component) : json::object();
    thing[component] = fields;
    return {{"sunfleck_scene", 2},
            {"gltf", "room.glb"},
            {"entities",
             {{"thing", thing},
              {"door", {{"Mover", {{"path", "line"}, {"activation", "sensor"}}}}},
              {"lamp", {{"Transform", {{"position", {0, 2, 0}}}}, {"PointLight", {{"intensity", {5, 5, 5}}}}}}}}};
}

class RobustSceneNumbers : public testing::Test {
protected:
    void SetUp() override {
        GltfBuilder room;
        room.add_square();
        room.file["nodes"] = {{{"name", "floor"},
                               {"mesh", 0},
                               {"translation", {-2, 0, 2}},
                               {"rotation", {-0.7071068, 0, 0, 0.7071068}},
                               {"scale", {4, 4, 4}}},
                              {{"name", "thing"}, {"mesh", 0}, {"translation", {0, 0.5, 0}}},
                              {{"name", "door"}, {"mesh", 0}, {"translation", {-1, 0, -1}}},
                              {{"name", "view"}, {"camera", 0}, {"translation", {0.5, 1, 3}}}};
        room.file["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 0.9}, {"znear", 0.1}}}}};
        room.file["scenes"] = {{{"nodes", {0, 1, 2, 3}}}};
        ASSERT_TRUE(write_file(folder.path / "room.glb", room.glb()));
    }
    void judge_scene(FileCounts& counts, const std::string& what, const std::string& text) const {
        const std::filesystem::path path = folder.path / "scene.scene.json";
        ASSERT_TRUE(write_file(path, text));
        judge(counts, what, [&](World& world) {
            const auto report = io::load_scene(path, world.registry, world.meshes, world.textures);
            return report ? Status() : Status(report.error());
        });
    }
    const Folder folder{"sunfleck_scene_numbers"};
};

TEST_F(RobustSceneNumbers, OddOnesInEachField) {
    FileCounts counts;
    Cases cases;
    std::set<std::string> paths, described;
    const json components = components_schema();
    for (const auto& [component, schema] : components.items()) {
        for (const auto& [name, field] : schema["properties"].items())
            if (field.contains("type") && is_numeric(field))
                described.insert("entities.thing." + component + "." + name + (field["type"] == "array" ? "[]" : ""));
        for (const json& fields : variants_of(schema)) {
            const json file = scene_with(component, fields);
            const int right = counts.right;
            judge_scene(counts, component + " " + fields.dump(), file.dump());
            EXPECT_EQ(counts.right, right + 1) << component << " " << fields << " is meant to be right";
            paths.merge(replace_each_number(file, "/entities/thing/" + component + "/", cases,
                                            [&, &name = component](const std::string& what, const std::string& text) {
                                                judge_scene(counts, name + " " + fields.dump() + " " + what, text);
                                            }));
        }
    }
    EXPECT_EQ(paths, described) << "the schema's numeric fields";
    EXPECT_GE(described.size(), 50u);
    cases.judge(counts, 10);
}

// The version, and settings, which whoever draws the scene applies.
TEST_F(RobustSceneNumbers, OddOnesInEachSetting) {
    FileCounts counts;
    Cases cases;
    const gi::Settings usual;
    json file = scene_with("Exposure", json::object());
    std::size_t numbers = 0;
    for (const std::string_view name : gi::Settings::names()) {
        const json value = json::parse(usual.get(name), nullptr, false);
        file["settings"][std::string(name)] = value.is_number() ? value : json(usual.get(name));
        numbers += value.is_number();
    }
    const std::filesystem::path path = folder.path / "settings.scene.json";
    const std::set<std::string> paths =
        replace_each_number(file, "", cases, [&](const std::string& what, const std::string& text) {
            if (what.compare(0, 9, "/entities") == 0)
                return;
            ++counts.tried;
            World world;
            gi::Settings settings;
            ASSERT_TRUE(write_file(path, text));
            const auto report = io::load_scene(path, world.registry, world.meshes, world.textures);
            Status status = report ? Status() : Status(report.error());
            EXPECT_TRUE(report || world.registry.entity_count() == 0) << what;
            if (report)
                for (const auto& [name, value] : report->settings)
                    if (status)
                        status = settings.set(name, value);
            EXPECT_TRUE(settings.validate()) << what;
            (status ? counts.right : counts.refused) += 1;
        });
    EXPECT_EQ(
        std::count_if(paths.begin(), paths.end(), [](const std::string& p) { return p.rfind("settings.", 0) == 0; }),
        std::ptrdiff_t(numbers));
    EXPECT_GE(numbers, 20u);
    EXPECT_EQ(paths.count("sunfleck_scene"), 1u);
}

} // namespace
} // namespace sunfleck::tests
