#include "tests/bench/smoothness/views.h"

#include "editor/command_line/picture_measures.h"
#include "engine/core/file.h"
#include "engine/ecs/world_copy.h"
#include "engine/io/scene_file.h"
#include "engine/simulation/input_recording.h"
#include "game_demo/game/solution.h"
#include "game_demo/game/world_hashes.h"
#include "viewer/exposure.h"
#include "viewer/quality.h"

#include <cstdio>
#include <set>

namespace sunfleck::bench {
namespace {

namespace fs = std::filesystem;
using simulation::StepInput;

constexpr unsigned steps_of_spacing = view_steps_per_frame * view_spacing;
constexpr unsigned light_steps = 1200, settling_steps = 600; // until all light is there at first; in each room
constexpr unsigned turning_steps = 20;                       // to one side, and as many back
constexpr std::int32_t turn = 200;                           // look_unit a step: 69 degrees a second

struct World {
    ecs::Registry registry;
    scene::MeshStore meshes;
    scene::TextureStore textures;
    std::unique_ptr<demo::GameWorld> game;
};

// Whether what is in the area, or was, is where it was. Lifts elsewhere go on all the time.
bool same_places(const demo::GameWorld& game, ecs::Registry& now, ecs::Registry& before) {
    constexpr float least = 1e-3f; // m, and of the axes' length
    bool same = true;
    now.view<scene::WorldTransform>().each([&](ecs::Entity entity, const scene::WorldTransform& transform) {
        const auto* other = before.try_get<scene::WorldTransform>(entity);
        const mat4 a = transform.matrix, b = other != nullptr ? other->matrix : mat4(0.0f);
        const auto inside = [&](const mat4& matrix) { return game.is_in(game.area_entity(), vec3(matrix[3])); };
        for (int column = 0; column < 4; ++column)
            if (glm::length(a[column] - b[column]) > least && (inside(a) || inside(b)))
                same = false;
    });
    return same;
}

class ViewWriter {
public:
    ViewWriter(World& world, fs::path folder) : world_(world), folder_(std::move(folder)) {}

    Status play(const std::function<Status(const std::string&)>& in_room) {
        demo::Solution solution(*world_.game);
        std::set<std::string> seen;
        while (!solution.ended()) {
            if (const std::string room = room_now(); !room.empty() && seen.insert(room).second)
                SUNFLECK_TRY(in_room(room));
            SUNFLECK_TRY(step(solution.next()));
        }
        return solution.problem().empty() ? Status() : Status(Error{solution.problem()});
    }

    Status look_at(const std::string& room) {
        SUNFLECK_TRY(rest(steps_.size() < light_steps ? light_steps : settling_steps));
        while (steps_.size() % steps_of_spacing != view_steps_per_frame)
            SUNFLECK_TRY(step({}));
        SUNFLECK_TRY(add(room, "settled"));
        SUNFLECK_TRY(rest(steps_of_spacing - 2 * turning_steps));
        for (unsigned i = 0; i < 2 * turning_steps; ++i)
            SUNFLECK_TRY(step({0, 0, i < turning_steps ? turn : -turn, 0, 0}));
        return add(room, "turning");
    }

    // Up to the last view.
    Status write() const {
        const std::vector<StepInput> steps(steps_.begin(), steps_.begin() + std::ptrdiff_t(steps_of_views_));
        SUNFLECK_TRY(simulation::write_recording(folder_ / "views.walk", steps));
        char exposure[32];
        std::snprintf(exposure, sizeof exposure, "%g",
                      double(viewer::scene_exposure(world_.registry).value_or(viewer::default_exposure)));
        SUNFLECK_TRY(write_file(folder_ / "world.txt", exposure + std::string("\n") + hash_of_views_ + "\n"));
        return write_file(folder_ / "views.txt", lines_);
    }

private:
    std::string room_now() const {
        const ecs::Entity area = world_.game->area_entity();
        return area.is_null() ? "" : world_.registry.get<scene::Name>(area).name.substr(std::string("area ").size());
    }
    Status step(const StepInput& input) {
        steps_.push_back(input);
        SUNFLECK_TRY(world_.game->step(input));
        hashes_.add(world_.game->simulation(), world_.registry);
        return {};
    }
    Status rest(unsigned steps) {
        for (unsigned i = 0; i < steps; ++i)
            SUNFLECK_TRY(step({}));
        return {};
    }

    Status add(const std::string& room, const std::string& moment) {
        steps_of_views_ = steps_.size();
        hash_of_views_ = hashes_.of_world();
        SUNFLECK_TRY(keep_scene(room, moment));
        const simulation::Character& person = world_.game->simulation().player();
        const vec3 eye = person.eye(), target = eye + person.forward();
        char line[400];
        std::snprintf(line, sizeof line, "%s\t%s\t%zu\t%.7g,%.7g,%.7g,%.7g,%.7g,%.7g,%g\t%s\n", room.c_str(),
                      moment.c_str(), steps_.size() / view_steps_per_frame - 1, double(eye.x), double(eye.y),
                      double(eye.z), double(target.x), double(target.y), double(target.z),
                      double(viewer::usual_field_of_view), scene_.c_str());
        lines_ += line;
        return {};
    }

    // The same scene serves where nothing has moved since the view before: one reference is enough then.
    Status keep_scene(const std::string& room, const std::string& moment) {
        ecs::Registry now;
        ecs::copy_world(world_.registry, now);
        if (moment != "settled" && same_places(*world_.game, now, before_))
            return {};
        ecs::copy_world(now, before_);
        std::vector<ecs::Entity> movers;
        now.view<scene::Mover>().each([&](ecs::Entity entity, const scene::Mover&) { movers.push_back(entity); });
        for (const ecs::Entity entity : movers)
            now.remove<scene::Mover>(entity); // the path tracer would put them where they begin
        scene_ = room + "-" + moment + ".scene.json";
        io::SaveOptions options;
        options.gltf_reference = "level.glb";
        return io::save_scene(folder_ / scene_, now, world_.meshes, world_.textures, options);
    }

    World& world_;
    fs::path folder_;
    ecs::Registry before_;
    std::vector<StepInput> steps_;
    std::size_t steps_of_views_ = 0;
    demo::WorldHashes hashes_;
    std::string scene_, lines_, hash_of_views_;
};

} // namespace

Status write_views(const fs::path& level, const fs::path& folder) {
    World world;
    scene::register_components(world.registry);
    SUNFLECK_TRY(io::load_scene(level, world.registry, world.meshes, world.textures));
    SUNFLECK_ASSIGN(world.game, demo::GameWorld::create(world.registry, world.meshes, &world.textures));
    std::error_code code;
    fs::create_directories(folder, code);
    fs::path geometry = level;
    geometry.replace_extension().replace_extension(".glb");
    fs::copy_file(geometry, folder / "level.glb", fs::copy_options::overwrite_existing, code);
    if (code)
        return Error{"cannot copy '" + geometry.string() + "' to '" + folder.string() + "': " + code.message()};
    ViewWriter views(world, folder);
    SUNFLECK_TRY(views.play([&](const std::string& room) { return views.look_at(room); }));
    return views.write();
}

Status halve_picture(const fs::path& from, const fs::path& to) {
    SUNFLECK_ASSIGN(const io::Picture picture, io::read_picture(from));
    return io::write_picture(to, command_line::box_filtered(picture, 2));
}

} // namespace sunfleck::bench
