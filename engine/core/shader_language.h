// Lets one header be both GLSL and C++. A shared header includes this first and puts everything between
// SHARED_BEGIN and SHARED_END; inside, vec3 and the like mean the same in both languages.
#ifndef SUNFLECK_ENGINE_CORE_SHADER_LANGUAGE_H
#define SUNFLECK_ENGINE_CORE_SHADER_LANGUAGE_H

#ifdef __cplusplus
#include "engine/core/maths.h"
#include <cstdint>
#define SHARED_BEGIN                                                                                                   \
    namespace sunfleck::shared {                                                                                       \
    using namespace glm;                                                                                               \
    using uint = std::uint32_t;
#define SHARED_END }
#define SHARED_FUNCTION inline
#define SHARED_CONSTANT inline constexpr
#else
#define SHARED_BEGIN
#define SHARED_END
#define SHARED_FUNCTION
#define SHARED_CONSTANT const
#endif

#endif
