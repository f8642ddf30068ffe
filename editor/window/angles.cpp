#include "editor/window/angles.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <deque>
#include <map>

namespace sunfleck::editor {
namespace {

constexpr std::size_t most_remembered = 4096;
// Degrees: what the rounding of a rotation's four floats makes of a zero; the more, the steeper it looks.
constexpr double nothing = 2e-5;

struct Remembered {
    using Key = std::array<std::uint32_t, 4>;
    std::map<Key, Angles> angles;
    std::deque<Key> order; // the oldest first

    static Key key(const quat& rotation) {
        return {std::bit_cast<std::uint32_t>(rotation.x), std::bit_cast<std::uint32_t>(rotation.y),
                std::bit_cast<std::uint32_t>(rotation.z), std::bit_cast<std::uint32_t>(rotation.w)};
    }
};

Remembered& remembered() {
    static Remembered only;
    return only;
}

} // namespace

Angles angles_of(const quat& rotation) {
    const glm::dmat3 turn = glm::mat3_cast(glm::normalize(glm::dquat(rotation)));
    const double level = std::hypot(turn[2][0], turn[2][2]); // cosine of x
    Angles angles(std::atan2(-turn[2][1], level), std::atan2(turn[2][0], turn[2][2]),
                  std::atan2(turn[0][1], turn[1][1]));
    if (level < 1e-6) // straight up or down y and z turn about the same axis
        angles = {angles.x, std::atan2(-turn[0][2], turn[0][0]), 0.0};
    angles = glm::degrees(angles);
    for (int axis = 0; axis < 3; ++axis)
        if (std::abs(angles[axis]) < nothing / (axis == 0 ? 1.0 : std::max(level, 1e-6)))
            angles[axis] = 0.0;
    return angles;
}

quat rotation_of(const Angles& angles) {
    const glm::dvec3 radians = glm::radians(angles);
    const glm::dquat turn = glm::angleAxis(radians.y, glm::dvec3(0.0, 1.0, 0.0)) *
                            glm::angleAxis(radians.x, glm::dvec3(1.0, 0.0, 0.0)) *
                            glm::angleAxis(radians.z, glm::dvec3(0.0, 0.0, 1.0));
    return quat(glm::normalize(turn));
}

void remember_angles(const quat& rotation, const Angles& angles) {
    Remembered& known = remembered();
    const Remembered::Key key = Remembered::key(rotation);
    if (known.angles.insert_or_assign(key, angles).second)
        known.order.push_back(key);
    if (known.order.size() > most_remembered) {
        known.angles.erase(known.order.front());
        known.order.pop_front();
    }
}

Angles shown_angles(const quat& rotation) {
    const auto found = remembered().angles.find(Remembered::key(rotation));
    return found != remembered().angles.end() ? found->second : angles_of(rotation);
}

} // namespace sunfleck::editor
