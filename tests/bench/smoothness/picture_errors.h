// How far pictures of two commits are from the path tracer's.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>

namespace sunfleck::bench {

class PictureErrors {
public:
    // `side`: before, after, or reference for what two references of other random numbers differ by. `file` has room,
    // moment, spp and flip.
    void add(const std::string& side, const nlohmann::json& file);
    bool has(const std::string& side) const;
    // A line for each view, with after / before beside the target.
    std::string table() const;
    // Every view was measured on both sides, and none is beyond the target.
    bool held() const;

    static constexpr double most = 1.1; // after / before

private:
    struct View {
        std::map<std::string, double> flip; // by side
        bool held() const;
    };
    std::map<std::string, View> views_;
    std::map<std::string, double> noise_; // by room
    unsigned samples_ = 0;
};

} // namespace sunfleck::bench
