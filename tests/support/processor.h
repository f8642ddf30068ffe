// What tests expect of one kind of processor alone.
#pragma once

namespace sunfleck::tests {

// With AVX-512, Embree rounds rays as it did where limits were measured; without, other paths represent their clusters.
inline bool has_avx512() {
#if defined(__x86_64__)
    return __builtin_cpu_supports("avx512f") != 0;
#else
    return false;
#endif
}

} // namespace sunfleck::tests
