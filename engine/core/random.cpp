#include "engine/core/random.h"

#include <array>

namespace sunfleck {
namespace {

using Directions = std::array<std::uint32_t, 32>;

// Direction numbers v_j from a primitive polynomial of the given degree and coefficients and its initial values, as in
// S. Joe, F. Y. Kuo, "Constructing Sobol sequences with better two-dimensional projections", 2008.
constexpr Directions directions(std::uint32_t degree, std::uint32_t coefficients,
                                std::array<std::uint32_t, 3> initial) {
    Directions v{};
    for (std::uint32_t j = 0; j < 32; ++j) {
        if (degree == 0) {
            v[j] = 1u << (31 - j);
        } else if (j < degree) {
            v[j] = initial[j] << (31 - j);
        } else {
            v[j] = v[j - degree] ^ (v[j - degree] >> degree);
            for (std::uint32_t k = 1; k < degree; ++k)
                if ((coefficients >> (degree - 1 - k)) & 1u)
                    v[j] ^= v[j - k];
        }
    }
    return v;
}

constexpr std::array<Directions, 4> sobol_directions = {
    directions(0, 0, {}),
    directions(1, 0, {1}),
    directions(2, 1, {1, 3}),
    directions(3, 1, {1, 3, 1}),
};

constexpr std::uint32_t reverse_bits(std::uint32_t x) {
    x = ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
    x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
    x = ((x >> 4) & 0x0f0f0f0fu) | ((x & 0x0f0f0f0fu) << 4);
    x = ((x >> 8) & 0x00ff00ffu) | ((x & 0x00ff00ffu) << 8);
    return (x >> 16) | (x << 16);
}

// Each step only carries information from lower to higher bits, so on bit-reversed input it is a random flip of every
// node of the binary tree: an Owen scramble. Constants by N. Vegdahl, 2021 (improved on Laine and Karras 2011).
constexpr std::uint32_t laine_karras_permutation(std::uint32_t x, std::uint32_t seed) {
    x ^= x * 0x3d20adeau;
    x += seed;
    x *= (seed >> 16) | 1u;
    x ^= x * 0x05526c56u;
    x ^= x * 0x53a22864u;
    return x;
}

constexpr std::uint32_t owen_scramble(std::uint32_t x, std::uint32_t seed) {
    return reverse_bits(laine_karras_permutation(reverse_bits(x), seed));
}

// XOR of the direction numbers of the index's set bits, a byte at a time.
using ByteTables = std::array<std::array<std::array<std::uint32_t, 256>, 4>, 4>;

constexpr ByteTables make_byte_tables() {
    ByteTables tables{};
    for (std::size_t dimension = 0; dimension < 4; ++dimension)
        for (std::size_t byte = 0; byte < 4; ++byte)
            for (std::size_t value = 0; value < 256; ++value)
                for (std::size_t bit = 0; bit < 8; ++bit)
                    if ((value >> bit) & 1u)
                        tables[dimension][byte][value] ^= sobol_directions[dimension][byte * 8 + bit];
    return tables;
}

std::uint32_t sobol_bits(std::uint32_t index, std::uint32_t dimension) {
    static const ByteTables tables = make_byte_tables();
    const auto& table = tables[dimension];
    return table[0][index & 255u] ^ table[1][(index >> 8) & 255u] ^ table[2][(index >> 16) & 255u] ^
           table[3][index >> 24];
}

} // namespace

SobolGroup::SobolGroup(std::uint32_t seed, std::uint32_t index, std::uint32_t group)
    : seed_(hash_combine(seed, group)), shuffled_(owen_scramble(index, pcg_hash(seed_))) {}

std::uint32_t SobolGroup::bits(std::uint32_t member) const {
    return owen_scramble(sobol_bits(shuffled_, member), pcg_hash(seed_ + 0x9e3779b9u * (member + 1)));
}

float RandomSequence::at(std::uint32_t dimension) const {
    if (kind_ == SequenceKind::pseudo_random)
        return to_unit_float(hash_combine(hash_combine(hash_combine(seed_, 0x51ed270bu), index_), dimension));
    if (dimension / 4 != group_number_) {
        group_number_ = dimension / 4;
        group_ = SobolGroup(seed_, index_, group_number_);
    }
    return to_unit_float(group_.bits(dimension % 4));
}

} // namespace sunfleck
