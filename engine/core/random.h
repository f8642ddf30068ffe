// Random numbers as pure functions of (seed, index, dimension): no state, no clock, the same on every machine.
#pragma once

#include <cstdint>

namespace sunfleck {

// PCG output permutation used as a hash. M. Jarzynski, M. Olano, "Hash Functions for GPU Rendering", JCGT 2020.
constexpr std::uint32_t pcg_hash(std::uint32_t value) {
    const std::uint32_t state = value * 747796405u + 2891336453u;
    const std::uint32_t word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return (word >> 22u) ^ word;
}

constexpr std::uint32_t hash_combine(std::uint32_t a, std::uint32_t b) {
    return pcg_hash(a ^ (pcg_hash(b) + 0x9e3779b9u));
}

// The 24 highest bits as a float in [0, 1).
constexpr float to_unit_float(std::uint32_t bits) {
    return float(bits >> 8) * 0x1p-24f;
}

// Four dimensions of the Owen-scrambled Sobol point `index`. Higher dimensions are padded: each group of four reuses
// the first four Sobol dimensions with the index shuffled by a nested uniform scramble, so that each group stays a
// digital net by itself. B. Burley, "Practical Hash-based Owen Scrambling", JCGT 2020.
class SobolGroup {
public:
    SobolGroup() = default;
    SobolGroup(std::uint32_t seed, std::uint32_t index, std::uint32_t group);
    std::uint32_t bits(std::uint32_t member) const;

private:
    std::uint32_t seed_ = 0;
    std::uint32_t shuffled_ = 0;
};

enum class SequenceKind { pseudo_random, sobol };

// The coordinates of point `index` of the sequence, one dimension after another.
class RandomSequence {
public:
    RandomSequence(SequenceKind kind, std::uint32_t seed, std::uint32_t index)
        : kind_(kind), seed_(seed), index_(index) {}

    float next() { return at(dimension_++); }
    float at(std::uint32_t dimension) const;
    // Jumps to a dimension, so that a path's bounce always uses the same dimensions, whatever came before.
    void seek(std::uint32_t dimension) { dimension_ = dimension; }

private:
    SequenceKind kind_;
    std::uint32_t seed_;
    std::uint32_t index_;
    std::uint32_t dimension_ = 0;
    // The group of four dimensions that was requested last; its four share one shuffle.
    mutable std::uint32_t group_number_ = 0xffffffffu;
    mutable SobolGroup group_;
};

} // namespace sunfleck
