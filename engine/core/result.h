// A value or an error message. Recoverable failures (bad files, missing features, out of memory) are returned as
// Result; misuse asserts.
#pragma once

#include <cassert>
#include <optional>
#include <string>
#include <utility>
#include <variant>

namespace sunfleck {

// For programs that act on a failure; people read the message.
enum class ErrorCode {
    other,
    argument,    // what was asked for makes no sense, or is out of range; nothing has changed
    memory,      // the CPU's or the GPU's is used up
    device_lost, // the GPU stopped answering: nothing goes on without a new device
    unsupported, // the driver, or how instance and device were created, lacks what is needed
    stopped,     // by who asked for it
};

// One sentence that says what failed, where, and what the reader can do about it.
struct Error {
    std::string message;
    ErrorCode code = ErrorCode::other;
};

template <typename T>
class [[nodiscard]] Result {
public:
    Result(T value) : state_(std::move(value)) {}
    Result(Error error) : state_(std::move(error)) {}

    bool has_value() const { return state_.index() == 0; }
    explicit operator bool() const { return has_value(); }

    T& value() & {
        assert(has_value());
        return std::get<0>(state_);
    }
    const T& value() const& {
        assert(has_value());
        return std::get<0>(state_);
    }
    T&& value() && {
        assert(has_value());
        return std::get<0>(std::move(state_));
    }
    T& operator*() & { return value(); }
    const T& operator*() const& { return value(); }
    T* operator->() { return &value(); }
    const T* operator->() const { return &value(); }

    const Error& error() const {
        assert(!has_value());
        return std::get<1>(state_);
    }

private:
    std::variant<T, Error> state_;
};

template <>
class [[nodiscard]] Result<void> {
public:
    Result() = default;
    Result(Error error) : error_(std::move(error)) {}

    bool has_value() const { return !error_.has_value(); }
    explicit operator bool() const { return has_value(); }
    const Error& error() const {
        assert(error_.has_value());
        return *error_;
    }

private:
    std::optional<Error> error_;
};

using Status = Result<void>;

} // namespace sunfleck

#define SUNFLECK_JOIN_INNER(a, b) a##b
#define SUNFLECK_JOIN(a, b) SUNFLECK_JOIN_INNER(a, b)
// Returns the error of `expression` from the enclosing function, if it has one.
#define SUNFLECK_TRY(expression)                                                                                       \
    do {                                                                                                               \
        if (auto SUNFLECK_JOIN(sunfleck_status_, __LINE__) = (expression); !SUNFLECK_JOIN(sunfleck_status_, __LINE__)) \
            return SUNFLECK_JOIN(sunfleck_status_, __LINE__).error();                                                  \
    } while (false)
// Declares `target` from the value of `expression`, or returns its error.
#define SUNFLECK_ASSIGN(target, expression)                                                                            \
    auto SUNFLECK_JOIN(sunfleck_result_, __LINE__) = (expression);                                                     \
    if (!SUNFLECK_JOIN(sunfleck_result_, __LINE__))                                                                    \
        return SUNFLECK_JOIN(sunfleck_result_, __LINE__).error();                                                      \
    target = std::move(SUNFLECK_JOIN(sunfleck_result_, __LINE__)).value()
