#include "tests/bench/smoothness/picture_errors.h"

#include <algorithm>
#include <cstdio>

namespace sunfleck::bench {

void PictureErrors::add(const std::string& side, const nlohmann::json& file) {
    const std::string room = file.value("room", std::string());
    const double flip = file.value("flip", 1.0);
    samples_ = std::max(samples_, file.value("spp", 0u));
    if (side == "reference")
        noise_[room] = flip;
    else
        views_[room + ", " + file.value("moment", std::string())].flip[side] = flip;
}

bool PictureErrors::has(const std::string& side) const {
    return std::any_of(views_.begin(), views_.end(), [&](const auto& view) { return view.second.flip.count(side); });
}

bool PictureErrors::View::held() const {
    const auto before = flip.find("before"), after = flip.find("after");
    return before != flip.end() && after != flip.end() && after->second <= most * before->second;
}

bool PictureErrors::held() const {
    return !views_.empty() &&
           std::all_of(views_.begin(), views_.end(), [](const auto& view) { return view.second.held(); });
}

std::string PictureErrors::table() const {
    char line[160];
    std::snprintf(line, sizeof line, "FLIP against the path tracer, %u samples per pixel\n", samples_);
    std::string table = line;
    std::snprintf(line, sizeof line, "    %-24s %8s %8s %8s  (at most %.2f)\n", "", "before", "after", "ratio", most);
    table += line;
    for (const auto& [name, view] : views_) {
        const auto before = view.flip.find("before"), after = view.flip.find("after");
        if (before == view.flip.end() || after == view.flip.end())
            std::snprintf(line, sizeof line, "    %-24s not measured %s  MISSED\n", name.c_str(),
                          before == view.flip.end() ? "before" : "after");
        else
            std::snprintf(line, sizeof line, "    %-24s %8.4f %8.4f %8.2f%s\n", name.c_str(), before->second,
                          after->second, after->second / before->second, view.held() ? "" : "  MISSED");
        table += line;
    }
    for (const auto& [room, flip] : noise_) {
        std::snprintf(line, sizeof line, "    two references of other random numbers, %s: %.4f\n", room.c_str(), flip);
        table += line;
    }
    return table;
}

} // namespace sunfleck::bench
