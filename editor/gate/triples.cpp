#include "editor/gate/triples.h"

#include "engine/core/file.h"
#include "engine/core/random.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace sunfleck::gate {
namespace {

using Json = nlohmann::ordered_json;

// Counters are compared elsewhere, and would make up most of the file.
Json frames_json(const std::vector<Frame>& frames) {
    Json json = Json::array();
    for (Frame frame : frames) {
        frame.counters.clear();
        json.push_back(Json::parse(frame_line(frame)));
    }
    return json;
}

Result<std::vector<Frame>> frames_of(const Json& json) {
    std::vector<Frame> frames;
    if (!json.is_array())
        return Error{"frames are missing"};
    for (const Json& element : json) {
        SUNFLECK_ASSIGN(Frame frame, parse_frame(element.dump()));
        frames.push_back(std::move(frame));
    }
    return frames;
}

std::string triple_line(const Triple& triple) {
    const Json json = {{"triple", triple.number},          {"rebuild", triple.rebuild},
                       {"slowed", triple.slowed},          {"hello", Json::parse(hello_line(triple.hello))},
                       {"base", frames_json(triple.base)}, {"same", frames_json(triple.same)},
                       {"slow", frames_json(triple.slow)}};
    return json.dump() + "\n";
}

Result<Triple> parse_triple(const std::string& line) {
    const Json json = Json::parse(line, nullptr, false);
    if (!json.is_object() || !json.contains("hello"))
        return Error{"not a triple"};
    Triple triple;
    triple.number = json.value("triple", 0u);
    triple.rebuild = json.value("rebuild", "");
    triple.slowed = json.value("slowed", "");
    SUNFLECK_ASSIGN(triple.hello, parse_hello(json["hello"].dump()));
    SUNFLECK_ASSIGN(triple.base, frames_of(json.value("base", Json())));
    SUNFLECK_ASSIGN(triple.same, frames_of(json.value("same", Json())));
    SUNFLECK_ASSIGN(triple.slow, frames_of(json.value("slow", Json())));
    if (triple.base.size() != triple.same.size() || triple.base.size() != triple.slow.size())
        return Error{"its three programs drew different numbers of frames"};
    return triple;
}

// All whole lines; what follows the last line's end was cut off.
Result<std::string> whole_lines(const std::filesystem::path& path) {
    std::error_code code;
    if (!std::filesystem::exists(path, code))
        return std::string();
    SUNFLECK_ASSIGN(std::string text, read_file(path));
    text.erase(text.rfind('\n') + 1);
    return text;
}

} // namespace

Result<Triple> run_triple(const TriplePrograms& programs, const PairOptions& options, std::uint32_t number,
                          const Patience& patience) {
    SUNFLECK_ASSIGN(const auto links, TemporaryFolder::make());
    struct Side {
        const std::vector<std::string>* command;
        const char* name;
        std::vector<Frame> Triple::*frames;
        std::unique_ptr<Program> program;
    };
    Side sides[3] = {{&programs.base, "base", &Triple::base, {}},
                     {&programs.same, "same", &Triple::same, {}},
                     {&programs.slow, "slow", &Triple::slow, {}}};
    // One of the six orders, as the pair's number says.
    const std::uint32_t order = pcg_hash(options.seed * 7919u + number);
    std::rotate(sides, sides + order % 3, sides + 3);
    if (order / 3 % 2 == 1)
        std::swap(sides[1], sides[2]);
    for (Side& side : sides) {
        SUNFLECK_ASSIGN(side.program, Program::start(links->path(), *side.command, side.name, patience));
    }
    for (Side& side : sides)
        SUNFLECK_TRY(side.program->read_hello());
    Triple triple;
    triple.number = number;
    triple.hello = sides[0].program->hello();
    for (const Side& side : sides)
        SUNFLECK_TRY(check_alike(triple.hello, side.program->hello()));
    SUNFLECK_ASSIGN(const PairPlan plan, make_plan(options, triple.hello.frames, number));
    for (const Turn& turn : plan.turns) {
        for (Side& side : sides) {
            SUNFLECK_ASSIGN(const std::vector<Frame> frames, side.program->draw(turn.frames));
            (triple.*side.frames).insert((triple.*side.frames).end(), frames.begin() + turn.warm_up, frames.end());
        }
        std::reverse(sides, sides + 3);
    }
    for (Side& side : sides)
        SUNFLECK_TRY(side.program->finish());
    return triple;
}

Status append_triple(const std::filesystem::path& path, const Triple& triple) {
    SUNFLECK_ASSIGN(const std::string text, whole_lines(path));
    return write_file(path, text + triple_line(triple));
}

Result<std::vector<Triple>> read_triples(const std::filesystem::path& path) {
    SUNFLECK_ASSIGN(const std::string text, whole_lines(path));
    std::vector<Triple> triples;
    for (std::size_t start = 0; start < text.size();) {
        const std::size_t end = text.find('\n', start);
        Result<Triple> triple = parse_triple(text.substr(start, end - start));
        if (!triple)
            return Error{"'" + path.string() + "', line " + std::to_string(triples.size() + 1) + ": " +
                         triple.error().message};
        triples.push_back(std::move(*triple));
        start = end + 1;
    }
    return triples;
}

PairRun pair_of(const Triple& triple, const std::vector<Frame>& head) {
    PairRun run{triple.hello, triple.hello, {}};
    for (std::size_t i = 0; i < triple.base.size(); ++i)
        run.frames.push_back({triple.base[i], head[i], true});
    return run;
}

} // namespace sunfleck::gate
